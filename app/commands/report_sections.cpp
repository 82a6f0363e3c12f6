#include "app/commands/report_sections.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <utility>

#include <fmt/format.h>

#include "app/commands/plots/gnuplot.h"
#include "app/commands/section_files.h"
#include "app/commands/section_options.h"
#include "app/work/read_units.h"
#include "engine/measure/roughness.h"
#include "engine/measure/section.h"

namespace fettle::app {

namespace {

constexpr const char* kSectionGroup = "Sections";

std::string shownIn(double mm, const ReadAs& unit) {
  return std::isnan(mm) ? "-" : fmt::format("{:.5g}", mm / unit.size);
}

// Lowest and highest height, and how many places have one [mm].
struct HeightSpan {
  double low = std::numeric_limits<double>::infinity(), high = -low;
  int places = 0;

  void add(const engine::Section& section) {
    for (const double z : section.height)
      if (!std::isnan(z)) {
        low = std::min(low, z);
        high = std::max(high, z);
        ++places;
      }
  }
};

// Root mean square of the difference where both have a height [mm]; NaN where none does.
double rmsBetween(const engine::Section& a, const engine::Section& b) {
  double squares = 0.0;
  int both = 0;
  for (std::size_t i = 0; i < std::min(a.size(), b.size()); ++i) {
    const double d = b.height[i] - a.height[i];
    if (std::isnan(d)) continue;
    squares += d * d;
    ++both;
  }
  return both > 0 ? std::sqrt(squares / both) : std::nan("");
}

ReportPage::Table figuresOf(const std::vector<engine::Section>& sections,
                            const std::vector<ShownState>& states, const ReportSections& wanted,
                            const ReadAs& along, const ReadAs& height) {
  ReportPage::Table table{"Section figures", "", {"Figure"}, {}};
  for (const ShownState& state : states) table.heads.push_back(state.name);
  table.heads.emplace_back("Unit");
  const auto row = [&](const char* name, const std::string& unit, const auto& of) {
    std::vector<std::string> cells = {name};
    for (const engine::Section& section : sections) cells.push_back(of(section));
    cells.push_back(unit);
    table.rows.push_back(std::move(cells));
  };
  row("Lowest", height.name, [&](const engine::Section& s) {
    HeightSpan span;
    span.add(s);
    return shownIn(span.low, height);
  });
  row("Highest", height.name, [&](const engine::Section& s) {
    HeightSpan span;
    span.add(s);
    return shownIn(span.high, height);
  });
  row("Places with a height", "", [](const engine::Section& s) {
    HeightSpan span;
    span.add(s);
    return fmt::format("{}", span.places);
  });
  if (!wanted.cutoff_mm) return table;
  std::vector<engine::Roughness> rough;
  for (std::size_t s = 0; s < sections.size(); ++s) {
    auto figures = engine::roughnessOf(sections[s], {0.0, sections[s].lengthMm()}, *wanted.cutoff_mm);
    if (!figures) {
      table.note = fmt::format("No roughness: {}.", figures.error().what);
      return table;
    }
    rough.push_back(*std::move(figures));
  }
  struct Kind {
    const char* name;
    double engine::Roughness::*figure;
    const ReadAs* unit;  // null: a number without one
  };
  const ReadAs fine = readLengthAs(rough.front().ra, 1.0, "mm");
  for (const Kind& kind : {Kind{"Ra", &engine::Roughness::ra, &fine},
                           {"Rq", &engine::Roughness::rq, &fine},
                           {"Rz", &engine::Roughness::rz, &fine},
                           {"Rsk", &engine::Roughness::rsk, nullptr},
                           {"Rku", &engine::Roughness::rku, nullptr},
                           {"RSm", &engine::Roughness::rsm, &along}}) {
    std::vector<std::string> cells = {kind.name};
    for (const engine::Roughness& r : rough)
      cells.push_back(shownIn(r.*kind.figure, kind.unit != nullptr ? *kind.unit : ReadAs{"", 1.0}));
    cells.push_back(kind.unit != nullptr ? kind.unit->name : "");
    table.rows.push_back(std::move(cells));
  }
  table.note = fmt::format("ISO 21920-2 over {} section lengths of {:.6g} mm.", rough.front().lengths,
                           *wanted.cutoff_mm);
  return table;
}

}  // namespace

void addSectionOptions(Command command, ReportSections& sections) {
  command.add({{.name = "--section",
                .to = &sections.lines,
                .text = "A polyline along which heights are shown, mm; give it again for another",
                .shown = "X,Y:X,Y[:...]",
                .group = kSectionGroup,
                .one_word = true},
               {.name = "--section-width",
                .to = &sections.width_mm,
                .text = "Heights are means across this width",
                .range = Range{0.0, std::numeric_limits<double>::max()},
                .unit = "mm",
                .otherwise = "of the line alone",
                .group = kSectionGroup},
               {.name = "--cutoff",
                .to = &sections.cutoff_mm,
                .text = "Roughness of the sections with this cut-off, ISO 21920-2",
                .range = Range{std::numeric_limits<double>::min(), std::numeric_limits<double>::max()},
                .unit = "mm",
                .otherwise = "no roughness",
                .group = kSectionGroup}});
}

engine::Status checkSections(const ReportSections& sections) {
  for (const std::string& line : sections.lines)
    if (const auto points = polylineOf(line, "--section"); !points) return tl::unexpected(points.error());
  if (!sections.lines.empty()) return plotsCanBeMade();
  for (const auto& [given, option] :
       {std::pair(sections.width_mm > 0.0, "--section-width"), {sections.cutoff_mm.has_value(), "--cutoff"}})
    if (given)
      return engine::inputError("an option would have no effect", option, "add --section, or leave it out");
  return {};
}

engine::Status addSections(ReportPage& page, const ReportSections& sections,
                           const std::vector<ShownState>& states, engine::JobControl& job) {
  engine::SectionOptions of;
  of.width_mm = sections.width_mm;
  for (std::size_t i = 0; i < sections.lines.size(); ++i) {
    const auto points = polylineOf(sections.lines[i], "--section");
    if (!points) return tl::unexpected(points.error());
    std::vector<engine::Section> taken;
    HeightSpan span;
    for (const ShownState& state : states) {
      auto section = engine::sectionAlong(state.field, *points, of, job);
      if (!section) return tl::unexpected(section.error());
      span.add(*section);
      taken.push_back(*std::move(section));
    }
    const ReadAs along = readLengthAs(taken.front().lengthMm(), 1.0, "mm");
    const ReadAs height = readLengthAs(span.high - span.low, 1.0, "mm");
    DrawnSection drawn{states.front().name, taken.front(), {}, "", {}};
    if (taken.size() > 1) {
      drawn.other = taken.back();
      drawn.other_name = states.back().name;
    }
    const auto svg = drawnByGnuplot(sectionsPlot({drawn}));
    if (!svg) return tl::unexpected(svg.error());
    page.parts.emplace_back(ReportPage::Heading{fmt::format("Section {}", i + 1)});
    page.parts.emplace_back(ReportPage::Plot{
        fmt::format("Heights from {:.6g}, {:.6g} to {:.6g}, {:.6g} mm, {:.5g} {} long{}", points->front().x,
                    points->front().y, points->back().x, points->back().y,
                    taken.front().lengthMm() / along.size, along.name,
                    taken.front().lanes > 1 ? fmt::format(", means of {} lanes", taken.front().lanes) : ""),
        *svg});
    ReportPage::Table table = figuresOf(taken, states, sections, along, height);
    table.title = fmt::format("Section {}: figures", i + 1);
    if (taken.size() > 1) {
      const std::string rms =
          fmt::format("Root mean square of the change: {} {}.",
                      shownIn(rmsBetween(taken.front(), taken.back()), height), height.name);
      table.note += table.note.empty() ? rms : " " + rms;
    }
    page.parts.emplace_back(std::move(table));
  }
  return {};
}

}  // namespace fettle::app
