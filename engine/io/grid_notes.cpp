#include "engine/io/grid_notes.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <map>

#include <fmt/format.h>

namespace fettle::engine {

namespace {

std::optional<double> numberOf(const std::string& text) {
  double value = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size() || !std::isfinite(value)) return std::nullopt;
  return value;
}

std::map<std::string, std::string> valuesOf(const std::string& text) {
  std::map<std::string, std::string> values;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = std::min(text.find('\n', at), text.size());
    const std::size_t equals = text.find(" = ", at);
    if (equals < end) values[text.substr(at, equals - at)] = text.substr(equals + 3, end - equals - 3);
    at = end + 1;
  }
  return values;
}

std::vector<std::string> linesOf(const std::string& text) {
  std::vector<std::string> lines;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = std::min(text.find('\n', at), text.size());
    lines.push_back(text.substr(at, end - at));
    at = end + 1;
  }
  return lines;
}

constexpr std::size_t kMostNotes = 4096;  // bytes

}  // namespace

std::string gridNotes(const Grid& grid) {
  // The name of a unit and a coordinate system may contain any text: one line each.
  const auto line = [](std::string text) {
    std::replace_if(
        text.begin(), text.end(), [](char c) { return c == '\n' || c == '\r'; }, ' ');
    return text;
  };
  return fmt::format(
      "lateral_unit = {}\nlateral_mm = {}\nheight_unit = {}\nheight_mm = {}\nspacing_x = {}\nspacing_y = {}\n"
      "origin_x = {}\norigin_y = {}\nheight_per_count = {}\ncrs = {}\n",
      line(grid.lateral_unit.name), grid.lateral_unit.mm, line(grid.height_unit.name), grid.height_unit.mm,
      grid.spacing_x, grid.spacing_y, grid.origin_x, grid.origin_y, grid.height_per_count,
      line(grid.crs_wkt));
}

std::optional<Grid> gridOfNotes(const std::string& text) {
  std::map<std::string, std::string> values = valuesOf(text);
  Grid grid;
  grid.lateral_unit.name = values["lateral_unit"];
  grid.height_unit.name = values["height_unit"];
  grid.crs_wkt = values["crs"];
  bool sound = !grid.lateral_unit.name.empty() && !grid.height_unit.name.empty();
  const auto take = [&](const char* key, double& out, double above) {
    const auto value = numberOf(values[key]);
    sound = sound && value && *value > above;
    if (sound) out = *value;
  };
  constexpr double kAny = -HUGE_VAL;
  take("lateral_mm", grid.lateral_unit.mm, 0.0);
  take("height_mm", grid.height_unit.mm, 0.0);
  take("spacing_x", grid.spacing_x, 0.0);
  take("spacing_y", grid.spacing_y, 0.0);
  take("origin_x", grid.origin_x, kAny);
  take("origin_y", grid.origin_y, kAny);
  take("height_per_count", grid.height_per_count, -0x1p-1000);
  if (!sound) return std::nullopt;
  return grid;
}

std::vector<std::string> rasterNotes(const Grid& grid) {
  std::vector<std::string> lines{fmt::format("columns = {}", grid.width),
                                 fmt::format("rows = {}", grid.height)};
  Grid without = grid;
  without.crs_wkt.clear();
  for (std::string& line : linesOf(gridNotes(without)))
    if (!line.starts_with("crs")) lines.push_back(std::move(line));
  return lines;
}

void RasterNotesReader::take(std::string_view comment) {
  while (!comment.empty() && (comment.front() == ' ' || comment.front() == '\t')) comment.remove_prefix(1);
  if (comment.find(" = ") == std::string_view::npos || text_.size() + comment.size() >= kMostNotes) return;
  text_ += comment;
  text_ += '\n';
}

std::optional<Grid> RasterNotesReader::raster() const {
  std::optional<Grid> grid = gridOfNotes(text_);
  if (!grid) return std::nullopt;
  std::map<std::string, std::string> values = valuesOf(text_);
  const auto side = [&](const char* key, std::int32_t& out) {
    const auto value = numberOf(values[key]);
    if (!value || *value < 1.0 || *value > Grid::kMaxSide || *value != std::floor(*value)) return false;
    out = static_cast<std::int32_t>(*value);
    return true;
  };
  if (!side("columns", grid->width) || !side("rows", grid->height)) return std::nullopt;
  return grid;
}

}  // namespace fettle::engine
