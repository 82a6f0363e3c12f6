#include "engine/io/lines/line_frame.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>

#include <fmt/format.h>
#include <glm/geometric.hpp>

#include "engine/io/lines/lines.h"

namespace fettle::engine {

namespace {

double toPositionStep(double samples) {
  return std::nearbyint(samples * 0x1p20) * 0x1p-20;
}

}  // namespace

LineFrame LineFrame::field(const Grid& grid) {
  LineFrame frame;
  frame.unit_x = grid.spacingXMm();
  frame.unit_y = grid.spacingYMm();
  frame.sample_mm = std::sqrt(frame.unit_x * frame.unit_y);
  frame.height_mm = grid.height_unit.mm;
  return frame;
}

LineFrame LineFrame::world(const Grid& grid) {
  LineFrame frame = field(grid);
  const Real mm = grid.crs_wkt.empty() ? grid.lateral_unit.mm : 1.0;
  frame.unit_x = grid.spacing_x * mm;
  frame.unit_y = grid.spacing_y * mm;
  frame.origin_x = grid.origin_x * mm;
  frame.origin_y = grid.origin_y * mm;
  return frame;
}

glm::dvec2 LineFrame::position(Real x, Real y) const noexcept {
  return {toPositionStep(static_cast<double>((x - origin_x) / unit_x)),
          toPositionStep(static_cast<double>((y - origin_y) / unit_y))};
}

Status LineCollector::reserve(double more) {
  points_ += more;
  if (points_ <= static_cast<double>(kMostLinePoints)) return {};
  return inputError(
      fmt::format("the lines have more than {} points, inserted ones included", kMostLinePoints), path_,
      "divide the file, or leave lines out");
}

Status LineCollector::add(const EdgePoint& point, const std::string& where) {
  if (job_ != nullptr && job_->cancelled()) return cancelled();
  const glm::dvec2 p = point.position;
  for (const double number : {p.x, p.y, point.deviation, point.step, point.step_deviation, point.slope_change,
                              point.slope_deviation})
    if (!std::isfinite(number))
      return inputError(fmt::format("{}: a number is not finite", where), path_, "correct or remove it");
  if (point.deviation < 0.0 || point.step_deviation < 0.0 || point.slope_deviation < 0.0)
    return inputError(fmt::format("{}: a standard deviation is below 0", where), path_,
                      "correct or remove it");
  // Lines may lead out of a scan, but not so far.
  const double outside = std::max({-p.x, p.x - grid_.width, -p.y, p.y - grid_.height});
  constexpr double kSmallField = 1024.0;
  if (outside > std::max({static_cast<double>(grid_.width), static_cast<double>(grid_.height), kSmallField}))
    return inputError(fmt::format("{}: the point is {:.3g} samples outside the scan", where, outside), path_,
                      "give lines of this scan, in its coordinates and unit");
  EdgeLine& line = lines_.back();
  if (!line.points.empty())
    if (Status status = insertUpTo(line, point); !status) return status;
  if (Status status = reserve(1.0); !status) return status;
  line.points.push_back(point);
  return {};
}

Status LineCollector::insertUpTo(EdgeLine& line, const EdgePoint& next) {
  const EdgePoint from = line.points.back();
  // Nothing is between points of which one was not located: located ones may lie samples away from the hand.
  if (!from.located || !next.located) return {};
  const double apart = glm::distance(from.position, next.position);
  if (!(apart > EdgeLine::kMostApart)) return {};
  const double pieces = std::ceil(apart);
  if (Status status = reserve(pieces - 1.0); !status) return status;
  EdgePoint between = from;
  for (std::int64_t k = 1; k < static_cast<std::int64_t>(pieces); ++k) {
    const double along = static_cast<double>(k) / pieces;
    const glm::dvec2 p = from.position + (next.position - from.position) * along;
    between.position = {toPositionStep(p.x), toPositionStep(p.y)};
    line.points.push_back(between);
  }
  return {};
}

Result<std::vector<EdgeLine>> LineCollector::finish() {
  std::erase_if(lines_, [](const EdgeLine& line) { return line.points.empty(); });
  if (lines_.empty())
    return inputError("there is no line in the file", path_, "give a file with at least one line");
  const auto isInside = [this](const EdgePoint& p) {
    return p.position.x >= -1.0 && p.position.y >= -1.0 && p.position.x <= grid_.width &&
           p.position.y <= grid_.height;
  };
  if (std::ranges::none_of(
          lines_, [&](const EdgeLine& line) { return std::ranges::any_of(line.points, isInside); })) {
    const glm::dvec2 first = lines_.front().points.front().position;
    return inputError(fmt::format("no point lies in the scan, which has {} x {} samples; the first one is at "
                                  "column {:.1f}, row {:.1f}",
                                  grid_.width, grid_.height, first.x, first.y),
                      path_, "give the lines of this scan");
  }
  for (EdgeLine& line : lines_)
    if (line.closed && line.points.size() > 1)
      if (Status status = insertUpTo(line, EdgePoint(line.points.front())); !status)
        return tl::unexpected(status.error());
  return std::move(lines_);
}

}  // namespace fettle::engine
