#include "app/commands/region_option.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <string_view>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <glm/vec2.hpp>

#include "app/commands/scan_files.h"
#include "app/terminal.h"
#include "app/work/memory_places.h"
#include "app/work/outputs.h"
#include "app/work/spelling.h"
#include "app/work/streams.h"
#include "app/work/typed_lengths.h"
#include "engine/fill/filled_samples.h"
#include "engine/io/files/input_file.h"
#include "engine/marks/chosen_marks.h"
#include "engine/marks/polygon.h"
#include "engine/measure/only_region.h"

namespace fettle::app {

namespace {

enum class RegionBy : std::uint8_t { kAll, kMarks, kMeasured, kRectangle, kPolygon };

struct RegionRow {
  const char* word;
  RegionBy by;
  engine::Region region;  // in the field of countedOf()
  bool world;             // coordinates of the world
  const char* text;
};
constexpr RegionRow kRegions[] = {
    {"all", RegionBy::kAll, engine::Region::kAll, false, "every sample that is no hole"},
    {"marked", RegionBy::kMarks, engine::Region::kMarked, false, "those that are marked"},
    {"unmarked", RegionBy::kMarks, engine::Region::kUnmarked, false, "those that are not"},
    {"measured", RegionBy::kMeasured, engine::Region::kAll, false, "those of a session that were not filled"},
    {"rectangle", RegionBy::kRectangle, engine::Region::kMarked, false,
     "\"rectangle X,Y,X,Y\", those between two corners, from the lower left sample in mm, or each with its "
     "unit, 12.5mm"},
    {"polygon", RegionBy::kPolygon, engine::Region::kMarked, false,
     "\"polygon X,Y X,Y X,Y\", those inside, corner after corner, three or more"},
    {"world-rectangle", RegionBy::kRectangle, engine::Region::kMarked, true,
     "the same in the coordinates of the scan's world, in its unit or another that is named"},
    {"world-polygon", RegionBy::kPolygon, engine::Region::kMarked, true, "likewise"},
};

std::string_view firstWordOf(std::string_view typed) {
  return typed.substr(0, typed.find(' '));
}

const RegionRow* regionRowOf(std::string_view typed) {
  const auto* row =
      std::ranges::find_if(kRegions, [&](const RegionRow& each) { return firstWordOf(typed) == each.word; });
  return row == std::end(kRegions) ? nullptr : row;
}

bool isShaped(const RegionRow& row) {
  return row.by == RegionBy::kRectangle || row.by == RegionBy::kPolygon;
}

// The corners of a shape as typed, in units of `plain_mm`, that of those without one; none where they are no lengths.
std::vector<glm::dvec2> shapeCorners(const RegionRow& row, std::string_view typed, double plain_mm) {
  typed.remove_prefix(firstWordOf(typed).size());
  std::vector<glm::dvec2> corners;
  while (true) {
    typed.remove_prefix(std::min(typed.find_first_not_of(' '), typed.size()));
    if (typed.empty()) return corners;
    const std::string_view word = firstWordOf(typed);
    typed.remove_prefix(word.size());
    const std::vector<double> numbers = lengthsOf(word, row.by == RegionBy::kRectangle ? 4 : 2, plain_mm);
    if (numbers.empty()) return {};
    for (std::size_t k = 0; k < numbers.size(); k += 2) corners.emplace_back(numbers[k], numbers[k + 1]);
  }
}

// Whether all corners lie on a line along x or along y; one between samples holds none of them either.
bool enclosesNothing(const std::vector<glm::dvec2>& corners) {
  const auto across = [&](auto of) {
    const auto [low, high] = std::ranges::minmax(corners, {}, of);
    return of(high) - of(low);
  };
  return across([](const glm::dvec2& p) { return p.x; }) == 0.0 ||
         across([](const glm::dvec2& p) { return p.y; }) == 0.0;
}

// What a shape holds, as marks. Corners in field coordinates [mm].
engine::Result<engine::Version> markedInside(const engine::Version& field, const RegionRow& row,
                                             const std::vector<glm::dvec2>& corners,
                                             const RegionArguments& arguments, engine::JobControl& job) {
  const engine::Grid& grid = field.grid();
  const glm::dvec2 spacing(grid.spacingXMm(), grid.spacingYMm());
  if (row.by == RegionBy::kRectangle) {
    const engine::SampleRect rect = engine::samplesBetween(grid, corners[0], corners[1]);
    return engine::onlyMarked(
        field, [&](std::int32_t tc, std::int32_t tr) { return engine::rowsInside(rect, tc, tr); }, job);
  }
  constexpr double kMostSamples = 1 << 20;
  std::vector<glm::dvec2> samples;
  samples.reserve(corners.size());
  for (const glm::dvec2& corner : corners) {
    samples.push_back(corner / spacing);
    if (std::max(std::abs(samples.back().x), std::abs(samples.back().y)) > kMostSamples)
      return engine::inputError(
          fmt::format("the corner {},{} mm lies more than {:.0f} samples away from the scan", corner.x,
                      corner.y, kMostSamples),
          arguments.option, "give corners nearer to it");
  }
  const engine::Polygon polygon(samples);
  return engine::onlyMarked(
      field, [&](std::int32_t tc, std::int32_t tr) { return polygon.inside(tc, tr); }, job);
}

tl::unexpected<engine::Error> noneInside(const engine::Grid& grid, const RegionRow& row,
                                         const RegionArguments& arguments, const std::string& scan) {
  const glm::dvec2 size((grid.width - 1) * (row.world ? grid.spacing_x : grid.spacingXMm()),
                        (grid.height - 1) * (row.world ? grid.spacing_y : grid.spacingYMm()));
  const glm::dvec2 from = row.world ? glm::dvec2(grid.origin_x, grid.origin_y) : glm::dvec2(0.0);
  return engine::inputError(
      fmt::format("no sample of {} with a height lies in '{}'", shownInput(scan), arguments.region),
      arguments.option,
      fmt::format("the scan is from {:.12g},{:.12g} to {:.12g},{:.12g} {}", from.x, from.y, from.x + size.x,
                  from.y + size.y, row.world ? grid.lateral_unit.name : "mm"));
}

// Of a region that is chosen by marks. What to do depends on where the marks would come from.
tl::unexpected<engine::Error> noneChosen(engine::Region region, const RegionArguments& arguments,
                                         const std::string& scan) {
  const std::string where = fmt::format("{} {}", arguments.option, arguments.region);
  const std::string by = arguments.marks.empty() ? "" : fmt::format(" in {}", shownInput(arguments.marks));
  if (region == engine::Region::kUnmarked)
    return engine::inputError(
        fmt::format("every sample of {} with a height is marked{}", shownInput(scan), by), where,
        fmt::format("take {0} marked, or {0} all", arguments.option));
  return engine::inputError(
      fmt::format("no sample of {} with a height is marked{}", shownInput(scan), by), where,
      arguments.marks.empty()
          ? fmt::format("mark some with fettle mark and give the picture with {}, mark them in the window "
                        "and give the session, or take {} all",
                        arguments.marks_option, arguments.option)
          : fmt::format("paint what counts in any colour but black, or take {} all", arguments.option));
}

engine::Result<engine::Version> measuredOf(const engine::Version& field,
                                           const std::optional<engine::Version>& original,
                                           const std::string& scan, const RegionArguments& arguments,
                                           engine::JobControl& job) {
  if (!original)
    return engine::inputError("the file does not say which samples were filled", shownInput(scan),
                              fmt::format("give the session of fettle fill, or its --filled-out as {} with "
                                          "{} unmarked",
                                          arguments.marks_option, arguments.option));
  auto measured = engine::withoutFilled(field, *original, job);
  if (measured && measured->reader().bounds().empty() && !field.reader().bounds().empty())
    return engine::inputError(fmt::format("every height of {} was filled", shownInput(scan)),
                              fmt::format("{} {}", arguments.option, arguments.region),
                              fmt::format("take {} all", arguments.option));
  return measured;
}

}  // namespace

std::vector<Word> regionWords() {
  std::vector<Word> words;
  for (const RegionRow& row : kRegions) words.emplace_back(row.word, row.text);
  return words;
}

std::vector<Word> shapeWords() {
  std::vector<Word> words;
  for (const RegionRow& row : kRegions)
    if (isShaped(row)) words.emplace_back(row.word, row.text);
  return words;
}

std::string regionProblem(const std::string& typed, const std::vector<Word>& known) {
  const RegionRow* row = regionRowOf(typed);
  if (row == nullptr ||
      std::ranges::none_of(known, [&](const Word& each) { return each.word == row->word; })) {
    std::vector<std::string> words;
    for (const Word& each : known) words.push_back(each.word);
    const std::string meant = didYouMean(std::string(firstWordOf(typed)), words);
    return fmt::format("{} is not one of {}{}{}", typed, fmt::join(words, ", "), meant.empty() ? "" : "; ",
                       meant);
  }
  if (!isShaped(*row)) return typed == row->word ? "" : fmt::format("{} takes no coordinates", row->word);
  const std::vector<glm::dvec2> corners = shapeCorners(*row, typed, 1.0);
  if (row->by == RegionBy::kRectangle)
    return corners.size() == 2
               ? ""
               : fmt::format("'{}' is not two corners: give \"{} X,Y,X,Y\"", typed, row->word);
  if (corners.size() < 3)
    return fmt::format("'{}' is not three corners or more: give \"{} X,Y X,Y X,Y\"", typed, row->word);
  return enclosesNothing(corners) ? fmt::format("the corners of '{}' enclose no area", typed) : "";
}

Parameter regionRow(RegionArguments& arguments, const std::string& text, const std::string& otherwise,
                    std::vector<Word> words) {
  Parameter row{.name = arguments.option, .to = &arguments.region, .text = text, .kind = ValueKind::kText};
  row.words = words;
  row.shown = "REGION";
  row.otherwise = otherwise;
  row.problem = [known = std::move(words)](const std::string& typed) { return regionProblem(typed, known); };
  return row;
}

void addRegionOptions(Command command, RegionArguments& arguments, const std::string& text,
                      const std::string& group, const std::string& otherwise) {
  command.add(
      {regionRow(arguments, text, otherwise, regionWords()),
       {.name = arguments.marks_option,
        .to = &arguments.marks,
        .text = fmt::format("Picture of marks for {}, instead of the marks of a session", arguments.option),
        .kind = ValueKind::kMarks}},
      group);
}

engine::Status checkRegion(const RegionArguments& arguments) {
  if (arguments.marks.empty() || choosesByMarks(arguments.region)) return {};
  return engine::inputError("marks choose nothing in this region", arguments.marks_option,
                            fmt::format("add {0} marked or {0} unmarked", arguments.option));
}

bool choosesByMarks(const std::string& region) noexcept {
  const RegionRow* row = regionRowOf(region);
  return row != nullptr && row->by == RegionBy::kMarks;
}

bool isShape(const std::string& region) noexcept {
  const RegionRow* row = regionRowOf(region);
  return row != nullptr && isShaped(*row);
}

engine::Region regionOf(const std::string& region) noexcept {
  const RegionRow* row = regionRowOf(region);
  return row == nullptr ? engine::Region::kAll : row->region;
}

engine::Result<engine::Version> countedOf(const engine::Version& field,
                                          const std::optional<engine::Version>& original,
                                          const std::string& scan, const RegionArguments& arguments,
                                          engine::JobControl& job) {
  auto counted = countedOrNone(field, original, scan, arguments, job);
  if (!counted || !choosesByMarks(arguments.region) || counted->reader().bounds().empty()) return counted;
  const engine::Region region = regionOf(arguments.region);
  if (!engine::anyIn(counted->reader(), region)) return noneChosen(region, arguments, scan);
  return counted;
}

engine::Result<engine::Version> countedOrNone(const engine::Version& field,
                                              const std::optional<engine::Version>& original,
                                              const std::string& scan, const RegionArguments& arguments,
                                              engine::JobControl& job) {
  const RegionRow* row = regionRowOf(arguments.region);
  if (row == nullptr || row->by == RegionBy::kAll || row->by == RegionBy::kMarks)
    return withMarks(field, arguments.marks, job);
  if (row->by == RegionBy::kMeasured) return measuredOf(field, original, scan, arguments, job);
  std::vector<glm::dvec2> corners =
      shapeCorners(*row, arguments.region, row->world ? field.grid().lateral_unit.mm : 1.0);
  const engine::Grid& grid = field.grid();
  if (row->world)
    for (glm::dvec2& corner : corners)
      corner = (corner - glm::dvec2(grid.origin_x, grid.origin_y)) * grid.lateral_unit.mm;
  auto marked = markedInside(field, *row, corners, arguments, job);
  if (marked && marked->reader().root().marked_children == 0) return noneInside(grid, *row, arguments, scan);
  return marked;
}

engine::Result<engine::Version> chosenOf(const engine::Version& field,
                                         const std::optional<engine::Version>& original,
                                         const std::string& scan, const RegionArguments& arguments,
                                         engine::JobControl& job) {
  if (arguments.region == "all") return field;
  const auto counted = countedOf(field, original, scan, arguments, job);
  if (!counted) return tl::unexpected(counted.error());
  return engine::onlyRegion(field, *counted, regionOf(arguments.region), job);
}

void warnOfFilled(const engine::Version& counted, const std::optional<engine::Version>& original,
                  const std::string& scan) {
  const std::int64_t filled = original ? engine::countFilled(counted, *original) : 0;
  if (filled > 0)
    warn(fmt::format("{}: {} of its samples were filled, not measured: --region measured leaves them out",
                     shownInput(scan), filled));
}

void warnOfFilledLost(const engine::Version& field, const std::optional<engine::Version>& original,
                      const std::string& out, const std::string& to) {
  const std::string extension = isStream(out) ? withDot(to) : engine::extensionOf(out);
  if (!original || memoryPlace(out) != nullptr || extension == ".fettle") return;
  if (const std::int64_t filled = engine::countFilled(field, *original); filled > 0)
    warn(fmt::format(
        "{}: {} of its samples were filled, not measured, and the file does not say which: write a "
        "session, .fettle",
        shownOutput(out), filled));
}

engine::Result<engine::Version> chosenLike(const engine::Version& other, const engine::Version& chosen,
                                           const RegionArguments& arguments, engine::JobControl& job) {
  const engine::Grid &of = other.grid(), &by = chosen.grid();
  if (arguments.region == "all" || of.width != by.width || of.height != by.height) return other;
  return engine::onlyRegion(other, chosen, engine::Region::kAll, job);
}

}  // namespace fettle::app
