#include "app/commands/stroke_lines.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include <fmt/format.h>

#include "app/work/edge_strokes.h"
#include "engine/edges/corners.h"
#include "engine/field/live_field.h"
#include "engine/inspect/noise.h"
#include "haptic/base/strokes.h"

namespace fettle::app {

namespace {

// Marks the samples within `radius` of `centre`, at least the nearest one. False when memory ran out.
bool markDisc(engine::LiveField& live, glm::dvec2 centre, double radius) {
  const engine::Grid& grid = live.grid();
  const auto mark = [&](std::int32_t column, std::int32_t row) {
    return !grid.contains(column, row) || std::isnan(live.reader().heightAt(column, row)) ||
           live.setMark(column, row, true);
  };
  // Lines may lead far out of the field.
  if (!(centre.x > -radius - 1.0 && centre.x < grid.width + radius && centre.y > -radius - 1.0 &&
        centre.y < grid.height + radius))
    return true;
  if (!mark(static_cast<std::int32_t>(std::lround(centre.x)),
            static_cast<std::int32_t>(std::lround(centre.y))))
    return false;
  const auto top = static_cast<std::int32_t>(std::floor(centre.y + radius));
  for (auto row = static_cast<std::int32_t>(std::ceil(centre.y - radius)); row <= top; ++row) {
    const double half = std::sqrt(std::max(0.0, radius * radius - (row - centre.y) * (row - centre.y)));
    const auto right = static_cast<std::int32_t>(std::floor(centre.x + half));
    for (auto column = static_cast<std::int32_t>(std::ceil(centre.x - half)); column <= right; ++column)
      if (!mark(column, row)) return false;
  }
  return true;
}

}  // namespace

engine::Result<std::vector<engine::EdgeStroke>> markedStrokes(const std::string& path,
                                                              const engine::Grid& grid) {
  const auto rows = haptic::readStrokes(path);
  if (!rows) return tl::unexpected(rows.error());
  std::vector<engine::EdgeStroke> strokes = edgeStrokesOf(*rows, grid);
  if (strokes.empty())
    return engine::inputError("the strokes have no stroke of the tool mark", path,
                              "draw along edges with it");
  return strokes;
}

engine::Result<std::vector<engine::EdgeLine>> locateLines(const engine::Version& field,
                                                          const std::vector<engine::EdgeStroke>& strokes,
                                                          const engine::LocateOptions& options,
                                                          engine::JobControl& job) {
  const auto noise = engine::estimateNoise(field, job);
  if (!noise) return tl::unexpected(noise.error());
  auto lines = engine::locateEdgeLines(field.reader(), noise->sigma, strokes, options, job);
  if (lines) engine::extendEnds(*lines, 0, field.grid().width, field.grid().height);
  return lines;
}

engine::Result<engine::Version> markLines(const engine::Version& field,
                                          const std::vector<engine::EdgeLine>& lines, double thickness,
                                          engine::JobControl& job) {
  if (!(thickness >= 0.0 && thickness <= 64.0))
    return engine::inputError(fmt::format("a thickness of {} samples cannot be used", thickness), "thickness",
                              "give 0 to 64");
  engine::LiveField live(field, engine::Growth::kAllowed);
  job.begin("drawing edges", static_cast<std::uint64_t>(engine::countPoints(lines)));
  for (const engine::EdgeLine& line : lines)
    for (const engine::EdgePoint& point : line.points) {
      if (job.cancelled()) return engine::cancelled();
      if (!markDisc(live, point.position, thickness))
        return engine::failure("there is not enough memory for the marks", "mark");
      job.advance();
    }
  return live.snapshot();
}

}  // namespace fettle::app
