#include "app/work/section_files.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <filesystem>
#include <iterator>
#include <limits>

#include <fmt/format.h>

#include "app/plots/gnuplot.h"
#include "app/work/interpolation_words.h"
#include "app/work/layer_over.h"
#include "app/work/outputs.h"
#include "app/work/read_units.h"
#include "engine/io/files/atomic_file.h"

namespace fettle::app {

namespace {

std::string cellOf(double value) {
  return std::isnan(value) ? "" : fmt::format("{:.9g}", value);
}

// Runs of places that have a height.
template <class Take>
void forEachRun(const engine::Section& section, Take&& take) {
  for (std::size_t i = 0; i < section.size();) {
    std::size_t end = i;
    while (end < section.size() && !std::isnan(section.height[end])) ++end;
    if (end > i) take(i, end);
    i = std::max(end, i) + 1;
  }
}

void addPolylines(const engine::Section& section, const std::string& layer, std::string& out) {
  forEachRun(section, [&](std::size_t from, std::size_t to) {
    out += fmt::format("0\nPOLYLINE\n8\n{}\n66\n1\n70\n0\n10\n0.0\n20\n0.0\n30\n0.0\n", layer);
    for (std::size_t i = from; i < to; ++i)
      fmt::format_to(std::back_inserter(out), "0\nVERTEX\n8\n{}\n10\n{:.9g}\n20\n{:.9g}\n30\n0.0\n", layer,
                     section.along(i), section.height[i]);
    out += fmt::format("0\nSEQEND\n8\n{}\n", layer);
  });
}

std::string plotRows(const engine::Section& section, double length_mm, double height_mm) {
  std::string rows;
  for (std::size_t i = 0; i < section.size(); ++i)
    rows += std::isnan(section.height[i])
                ? "\n"
                : fmt::format("{:.9g} {:.9g}\n", section.along(i) / length_mm, section.height[i] / height_mm);
  return rows;
}

struct HeightRange {
  double low = std::numeric_limits<double>::infinity(), high = -low;
  void add(const engine::Section& section) {
    for (const double z : section.height)
      if (!std::isnan(z)) {
        low = std::min(low, z);
        high = std::max(high, z);
      }
  }
};

}  // namespace

std::string takingText(const SectionTaking& taking) {
  std::string text = fmt::format("{} between samples", interpolationWord(taking.interpolation));
  for (const std::string& layer : {layerText(taking.layer), layerText(taking.other_layer, "the other scan")})
    if (!layer.empty()) text += ", " + layer;
  return text;
}

std::string sectionCsv(const std::vector<DrawnSection>& sections, const SectionTaking& taking) {
  const bool both = !sections.empty() && sections.front().other.size() > 0;
  const bool filled =
      std::ranges::any_of(sections, [](const DrawnSection& drawn) { return !drawn.filled.empty(); });
  std::string text = "section,along_mm,x_mm,y_mm,height_mm,share";
  if (filled) text += ",filled";
  if (both) text += ",other_mm";
  text += ",interpolation,layer";
  text += both ? ",other_layer\n" : "\n";
  const std::string ending = fmt::format(",{},{}{}{}\n", interpolationWord(taking.interpolation),
                                         taking.layer, both ? "," : "", both ? taking.other_layer : "");
  for (std::size_t s = 0; s < sections.size(); ++s) {
    const engine::Section& section = sections[s].section;
    for (std::size_t i = 0; i < section.size(); ++i) {
      fmt::format_to(std::back_inserter(text), "{},{:.9g},{:.9g},{:.9g},{},{:.4g}", s, section.along(i),
                     section.position[i].x, section.position[i].y, cellOf(section.height[i]),
                     section.share[i]);
      if (filled) text += !sections[s].filled.empty() && sections[s].filled[i] ? ",yes" : ",no";
      if (both) fmt::format_to(std::back_inserter(text), ",{}", cellOf(sections[s].other.height[i]));
      text += ending;
    }
  }
  return text;
}

std::string sectionDxf(const std::vector<DrawnSection>& sections) {
  std::string text = "0\nSECTION\n2\nHEADER\n9\n$ACADVER\n1\nAC1009\n0\nENDSEC\n0\nSECTION\n2\nENTITIES\n";
  for (std::size_t s = 0; s < sections.size(); ++s) {
    addPolylines(sections[s].section, fmt::format("SECTION_{}", s), text);
    addPolylines(sections[s].other, fmt::format("SECTION_{}_OTHER", s), text);
  }
  text += "0\nENDSEC\n0\nEOF\n";
  return text;
}

std::string sectionsPlot(const std::vector<DrawnSection>& sections, const std::string& caption) {
  HeightRange range;
  for (const DrawnSection& drawn : sections) {
    range.add(drawn.section);
    range.add(drawn.other);
  }
  double longest = 0.0;
  for (const DrawnSection& drawn : sections) longest = std::max(longest, drawn.section.lengthMm());
  const ReadAs height = readLengthAs(range.high - range.low, 1.0, "mm"),
               length = readLengthAs(longest, 1.0, "mm");
  std::string script = kPlotHead, curves;
  if (!caption.empty()) script += fmt::format("set title {}\n", quoted(caption));
  script += fmt::format("set xlabel 'length along the line [{}]'\n", length.name);
  script += fmt::format("set ylabel 'height [{}]'\nset format y '%.9g'\n", height.name);
  constexpr std::size_t kMostDrawn = 7;
  for (std::size_t s = 0; s < std::min(sections.size(), kMostDrawn); ++s) {
    const char* colour = kPlotColours[s % std::size(kPlotColours)];
    script +=
        fmt::format("$section{} << EOD\n{}EOD\n", s, plotRows(sections[s].section, length.size, height.size));
    curves += fmt::format("{}$section{} using 1:2 with lines lw 1.5 lc rgb '{}' title {}",
                          curves.empty() ? "plot " : ", ", s, colour, quoted(sections[s].name));
    for (const SectionMark& mark : sections[s].marks)
      script += fmt::format(
          "set arrow from {0:.9g}, graph 0 to {0:.9g}, graph 1 nohead dt 3 lc rgb '{1}'\n"
          "set label '{2} ' at {0:.9g}, graph 1 right rotate by 90 offset character -0.6, 0 tc rgb '{1}'\n",
          mark.along_mm / length.size, colour, mark.name);
    if (sections[s].other.size() == 0) continue;
    script +=
        fmt::format("$other{} << EOD\n{}EOD\n", s, plotRows(sections[s].other, length.size, height.size));
    curves += fmt::format(
        ", $other{} using 1:2 with lines lw 1.5 dt 2 lc rgb '{}' title {}", s,
        kPlotColours[(s + 1) % std::size(kPlotColours)],
        quoted(sections[s].other_name.empty() ? sections[s].name + ", other" : sections[s].other_name));
  }
  return script + curves + "\n";
}

engine::Status drawSections(const std::vector<DrawnSection>& sections, const SectionTaking& taking,
                            const std::string& path) {
  const std::string script = sectionsPlot(sections, takingText(taking));
  if (withDot(std::filesystem::path(path).extension().string()) == ".png") return drawnAsPng(script, path);
  const auto svg = drawnByGnuplot(script);
  if (!svg) return tl::unexpected(svg.error());
  return engine::writeFileAtomically(path, *svg);
}

}  // namespace fettle::app
