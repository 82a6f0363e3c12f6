#include "app/commands/report_sections.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <string_view>
#include <tuple>
#include <utility>

#include <fmt/format.h>

#include "app/commands/section_options.h"
#include "app/plots/gnuplot.h"
#include "app/work/layer_over.h"
#include "app/work/read_units.h"
#include "app/work/section_files.h"
#include "app/work/section_noise.h"
#include "app/work/section_report.h"
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
    auto figures =
        engine::roughnessOf(sections[s], {0.0, sections[s].lengthMm()}, {.cutoff_mm = *wanted.cutoff_mm});
    if (!figures) {
      table.note = fmt::format("No roughness: {}.", figures.error().what);
      return table;
    }
    rough.push_back(*std::move(figures));
  }
  const ReadAs fine = readLengthAs(rough.front().ra, 1.0, "mm");
  for (const engine::RoughnessInfo& info : engine::roughnessInfos()) {
    using Unit = engine::RoughnessInfo::Unit;
    const ReadAs in = info.unit == Unit::kHeight  ? fine
                      : info.unit == Unit::kAlong ? along
                      : info.unit == Unit::kRatio ? ReadAs{"%", 0.01}
                                                  : ReadAs{"", 1.0};
    std::vector<std::string> cells = {std::string(info.symbol)};
    for (const engine::Roughness& r : rough) cells.push_back(shownIn(r.*info.figure, in));
    cells.push_back(in.name);
    table.rows.push_back(std::move(cells));
  }
  table.note = fmt::format("ISO 21920-2 over {} section lengths of {:.6g} mm.", rough.front().lengths,
                           *wanted.cutoff_mm);
  return table;
}

// A line's profiles of all states, and the units that suit them.
struct TakenProfiles {
  std::vector<engine::Section> sections;
  ReadAs along, height;
};

engine::Result<TakenProfiles> takenAlong(const std::vector<glm::dvec2>& points, double width_mm,
                                         const std::vector<ShownState>& states, engine::JobControl& job) {
  engine::SectionOptions of;
  of.width_mm = width_mm;
  TakenProfiles taken;
  HeightSpan span;
  for (const ShownState& state : states) {
    auto section = engine::sectionAlong(state.field, points, of, job);
    if (!section) return tl::unexpected(section.error());
    span.add(*section);
    taken.sections.push_back(*std::move(section));
  }
  taken.along = readLengthAs(taken.sections.front().lengthMm(), 1.0, "mm");
  taken.height = readLengthAs(span.high - span.low, 1.0, "mm");
  return taken;
}

// A heading and the profiles over each other.
engine::Status addDrawing(ReportPage& page, const std::string& name, const std::vector<glm::dvec2>& points,
                          const TakenProfiles& taken, const std::vector<ShownState>& states,
                          std::vector<SectionMark> marks) {
  const engine::Section& first = taken.sections.front();
  DrawnSection drawn{states.front().name, first, {}, "", std::move(marks)};
  if (taken.sections.size() > 1) {
    drawn.other = taken.sections.back();
    drawn.other_name = states.back().name;
  }
  const auto svg = drawnByGnuplot(sectionsPlot({drawn}, {}));
  if (!svg) return tl::unexpected(svg.error());
  page.parts.emplace_back(ReportPage::Heading{name});
  page.parts.emplace_back(ReportPage::Plot{
      fmt::format("Heights from {:.6g}, {:.6g} to {:.6g}, {:.6g} mm, {:.5g} {} long{}, {}", points.front().x,
                  points.front().y, points.back().x, points.back().y, first.lengthMm() / taken.along.size,
                  taken.along.name, first.lanes > 1 ? fmt::format(", means of {} lanes", first.lanes) : "",
                  takingText({engine::SectionOptions().interpolation, layerOver(states.back().field), {}})),
      *svg});
  return {};
}

// A figure of a section in all states.
struct FigureRow {
  std::string name, unit;
  std::vector<std::string> cells;
};

// "step_mm" as "step" and "mm".
std::pair<std::string, std::string> nameAndUnit(const std::string& key) {
  for (const std::string_view unit : {"mm", "deg"})
    if (key.ends_with(fmt::format("_{}", unit)))
      return {key.substr(0, key.size() - unit.size() - 1), std::string(unit)};
  return {key, ""};
}

// The figures of one report of sectionFigure, of the state `state` of so many: with its standard error a figure is one cell.
void addFigureRows(const std::string& key, const Report& figure, std::size_t state, std::size_t states,
                   std::vector<FigureRow>& rows) {
  for (const auto& [member, value] : figure.items()) {
    std::string name, unit;
    std::tie(name, unit) = nameAndUnit(member);
    if (!(value.is_number() || value.is_null()) || name.ends_with("_error")) continue;
    const auto number = [](const Report& of) {
      return of.is_number() ? fmt::format("{:.5g}", of.get<double>()) : "-";
    };
    std::string cell = number(value);
    const std::string error = unit.empty() ? name + "_error" : fmt::format("{}_error_{}", name, unit);
    if (const auto found = figure.find(error); found != figure.end() && found->is_number())
      cell += fmt::format(" +- {:.2g}", found->get<double>());
    std::ranges::replace(name, '_', ' ');
    name = name == key ? key : fmt::format("{}, {}", key, name);
    auto row =
        std::ranges::find_if(rows, [&](const FigureRow& r) { return r.name == name && r.unit == unit; });
    if (row == rows.end()) {
      rows.push_back({name, unit, std::vector<std::string>(states, "-")});
      row = rows.end() - 1;
    }
    row->cells[state] = std::move(cell);
  }
}

}  // namespace

void addSectionOptions(Command command, ReportSections& sections) {
  command.add({{.name = "--section",
                .to = &sections.lines,
                .text = "A polyline along which heights are shown; give it again for another",
                .unit = "mm",
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
  for (std::size_t i = 0; i < sections.lines.size(); ++i) {
    const auto points = polylineOf(sections.lines[i], "--section");
    if (!points) return tl::unexpected(points.error());
    const auto taken = takenAlong(*points, sections.width_mm, states, job);
    if (!taken) return tl::unexpected(taken.error());
    const std::string name = fmt::format("Section {}", i + 1);
    if (auto status = addDrawing(page, name, *points, *taken, states, {}); !status) return status;
    ReportPage::Table table = figuresOf(taken->sections, states, sections, taken->along, taken->height);
    table.title = name + ": figures";
    if (taken->sections.size() > 1) {
      const std::string rms =
          fmt::format("Root mean square of the change: {} {}.",
                      shownIn(rmsBetween(taken->sections.front(), taken->sections.back()), taken->height),
                      taken->height.name);
      table.note += table.note.empty() ? rms : " " + rms;
    }
    page.parts.emplace_back(std::move(table));
  }
  return {};
}

engine::Status addKeptSections(ReportPage& page, const std::vector<KeptSection>& kept,
                               const std::vector<ShownState>& states, engine::JobControl& job) {
  if (kept.empty()) return {};
  std::vector<engine::SectionNoise> noise;
  for (const ShownState& state : states) {
    const auto own = sectionNoiseOf(state.field, job);
    if (!own) return tl::unexpected(own.error());
    noise.push_back(noise.empty() ? *own : louderOf(noise.back(), *own));
  }
  for (std::size_t i = 0; i < kept.size(); ++i) {
    const std::vector<glm::dvec2> points{kept[i].from, kept[i].to};
    const auto taken = takenAlong(points, kept[i].width_mm, states, job);
    if (!taken) return tl::unexpected(taken.error());
    const SectionWants wants = wantsOf(kept[i]);
    std::vector<FigureRow> rows;
    std::vector<SectionMark> marks;
    std::string note;
    for (std::size_t s = 0; s < states.size(); ++s) {
      for (const std::string_view key : sectionFigureKeys()) {
        if (!wantsFigure(wants, key)) continue;
        std::vector<SectionMark> found;
        const auto figure = sectionFigure(key, wants, taken->sections[s], noise[s], found);
        if (!figure) {
          note +=
              fmt::format("{}{}, {}: {}.", note.empty() ? "" : " ", states[s].name, key, figure.error().what);
          continue;
        }
        if (s == 0) marks.insert(marks.end(), found.begin(), found.end());
        addFigureRows(std::string(key), *figure, s, states.size(), rows);
      }
    }
    const std::string name = fmt::format("Kept section {}", i + 1);
    if (auto status = addDrawing(page, name, points, *taken, states, std::move(marks)); !status)
      return status;
    ReportPage::Table table{name + ": figures", std::move(note), {"Figure"}, {}};
    for (const ShownState& state : states) table.heads.push_back(state.name);
    table.heads.emplace_back("Unit");
    for (FigureRow& row : rows) {
      row.cells.insert(row.cells.begin(), std::move(row.name));
      row.cells.push_back(std::move(row.unit));
      table.rows.push_back(std::move(row.cells));
    }
    page.parts.emplace_back(std::move(table));
  }
  return {};
}

}  // namespace fettle::app
