#include "app/work/stroke_path.h"

#include <cmath>

#include <glm/geometric.hpp>

namespace fettle::app {

constexpr double kLeastApart = 0.25, kGap = 4.0;  // [samples]

void StrokePath::add(std::uint64_t tick, const haptic::TickRecord& record) {
  const haptic::StrokeSample& input = record.input;
  if (!record.contact || !haptic::isMarkTool(input.tool) || !(spacing_mm_.x > 0.0) ||
      !std::isfinite(input.tip_mm.x) || !std::isfinite(input.tip_mm.y)) {
    interrupted_ = true;
    return;
  }
  // As engine::locateEdgeLines() wants them: to 2^-20 samples.
  const auto rounded = [](double at) { return std::round(at * 0x1p20) * 0x1p-20; };
  const glm::dvec2 at{rounded(input.tip_mm.x / spacing_mm_.x), rounded(input.tip_mm.y / spacing_mm_.y)};
  const bool same = !points_.empty() && points_.back().tool == input.tool;
  const double step = same ? glm::distance(points_.back().at, at) : kGap;
  // A tip that bounces stays on its way; over a hole, or beside the field, it is another one.
  const bool begins = !same || (interrupted_ && step > kGap);
  interrupted_ = false;
  if (begins || step >= kLeastApart) points_.push_back({tick, begins, input.tool, at});
}

std::vector<StrokePath::Ended> StrokePath::endAt(std::uint64_t tick) {
  std::vector<Ended> ended;
  for (; !points_.empty() && points_.front().tick < tick; points_.pop_front()) {
    const Point& point = points_.front();
    const bool other_tool = ended.empty() || ended.back().tool != point.tool;
    if (other_tool) ended.push_back({point.tool, {}});
    StrokePieces& pieces = ended.back().pieces;
    if (other_tool || point.begins) pieces.emplace_back();
    pieces.back().push_back(point.at);
  }
  return ended;
}

void StrokePath::dropBefore(std::uint64_t tick) {
  while (!points_.empty() && points_.front().tick < tick) points_.pop_front();
}

}  // namespace fettle::app
