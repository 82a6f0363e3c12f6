#include "haptic/operator/operator_strokes.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <unordered_map>

#include "haptic/operator/hand_drift.h"

namespace fettle::haptic {

namespace {

constexpr double kAirSpeed = 80.0;  // [mm/s] mean speed of free moves
constexpr double kOverlapMm = 1.0;  // a closed edge is followed this far past its start

double length(glm::dvec2 v) noexcept {
  return std::hypot(v.x, v.y);
}

// The scan as it is felt: bilinear, and over a hole the last height.
class FeltSurface {
 public:
  explicit FeltSurface(const engine::Version& scan)
      : reader_(scan.reader()),
        sx_(scan.grid().spacingXMm()),
        sy_(scan.grid().spacingYMm()),
        sz_(scan.grid().height_unit.mm) {
    const engine::HeightBounds bounds = reader_.bounds();
    if (!bounds.empty()) {
      last_ = static_cast<double>(bounds.min) * sz_;
      highest_ = static_cast<double>(bounds.max) * sz_;
    }
  }

  [[nodiscard]] glm::dvec2 inside(glm::dvec2 p) const noexcept {
    return {std::clamp(p.x, 0.0, (reader_.width() - 1) * sx_),
            std::clamp(p.y, 0.0, (reader_.height() - 1) * sy_)};
  }
  [[nodiscard]] double highest() const noexcept { return highest_; }

  // p inside the field.
  [[nodiscard]] double at(glm::dvec2 p) noexcept {
    const double x = p.x / sx_;
    const double y = p.y / sy_;
    const auto c = std::clamp(static_cast<std::int32_t>(x), 0, std::max(reader_.width() - 2, 0));
    const auto r = std::clamp(static_cast<std::int32_t>(y), 0, std::max(reader_.height() - 2, 0));
    const double u = x - c;
    const double v = y - r;
    const auto height = [&](std::int32_t column, std::int32_t row) {
      return static_cast<double>(
          reader_.heightAt(std::min(column, reader_.width() - 1), std::min(row, reader_.height() - 1)));
    };
    const double z = (1.0 - v) * ((1.0 - u) * height(c, r) + u * height(c + 1, r)) +
                     v * ((1.0 - u) * height(c, r + 1) + u * height(c + 1, r + 1));
    if (!std::isnan(z)) last_ = z * sz_;
    return last_;
  }

  // The lowest height within `radius` of p, sampled in eight directions.
  [[nodiscard]] double lowest(glm::dvec2 p, double radius) noexcept {
    double z = at(p);
    if (radius <= 0.0) return z;
    constexpr double kDiagonal = 0.70710678118654752;
    constexpr glm::dvec2 kAround[] = {{1, 0},  {kDiagonal, kDiagonal},   {0, 1},  {-kDiagonal, kDiagonal},
                                      {-1, 0}, {-kDiagonal, -kDiagonal}, {0, -1}, {kDiagonal, -kDiagonal}};
    for (const glm::dvec2& d : kAround) z = std::min(z, at(inside(p + d * radius)));
    return z;
  }

 private:
  engine::FieldReader reader_;
  double sx_;
  double sy_;
  double sz_;
  double last_ = 0.0;
  double highest_ = 0.0;
};

// A line to follow at even speed: an edge, or its parallel at some distance to the left.
class Path {
 public:
  Path(const engine::Edge& edge, double left_mm) {
    points_ = edge.points_mm;
    if (edge.closed) points_.push_back(points_.front());
    const std::size_t n = points_.size();
    std::vector<glm::dvec2> shifted(n);
    for (std::size_t i = 0; i < n; ++i) {
      const bool ring = edge.closed;
      const glm::dvec2 before = i > 0 ? points_[i - 1] : (ring ? points_[n - 2] : points_[0]);
      const glm::dvec2 after = i + 1 < n ? points_[i + 1] : (ring ? points_[1] : points_[n - 1]);
      const glm::dvec2 run = after - before;
      const double l = length(run);
      const glm::dvec2 left = l > 0.0 ? glm::dvec2{-run.y / l, run.x / l} : glm::dvec2{0.0, 0.0};
      shifted[i] = points_[i] + left * left_mm;
    }
    points_ = std::move(shifted);
    at_.push_back(0.0);
    for (std::size_t i = 1; i < n; ++i) at_.push_back(at_.back() + length(points_[i] - points_[i - 1]));
    end_ = at_.back() + (edge.closed ? std::min(kOverlapMm, at_.back()) : 0.0);
  }

  [[nodiscard]] double end() const noexcept { return end_; }

  // The point at arc length s [mm], 0 .. end().
  [[nodiscard]] glm::dvec2 place(double s) const noexcept {
    const double round = at_.back();
    if (s > round) s -= round;
    const auto next = std::upper_bound(at_.begin(), at_.end(), s);
    if (next == at_.end()) return points_.back();
    const auto i = static_cast<std::size_t>(next - at_.begin());
    const double t = (s - at_[i - 1]) / (at_[i] - at_[i - 1]);
    return points_[i - 1] + (points_[i] - points_[i - 1]) * t;
  }

 private:
  std::vector<glm::dvec2> points_;
  std::vector<double> at_;  // distance along the line of each point
  double end_ = 0.0;
};

// Tests whether a point keeps a distance from every edge; a grid with cells of that distance holds the edges'
// points.
class Clearance {
 public:
  Clearance(std::span<const engine::Edge> edges, double distance) : distance_(distance) {
    if (distance_ <= 0.0) return;
    for (const engine::Edge& edge : edges)
      for (const glm::dvec2& p : edge.points_mm) cells_[key(cell(p.x), cell(p.y))].push_back(p);
  }

  [[nodiscard]] bool keeps(glm::dvec2 p) const {
    if (distance_ <= 0.0) return true;
    for (std::int32_t dy = -1; dy <= 1; ++dy)
      for (std::int32_t dx = -1; dx <= 1; ++dx) {
        const auto found = cells_.find(key(cell(p.x) + dx, cell(p.y) + dy));
        if (found == cells_.end()) continue;
        for (const glm::dvec2& q : found->second)
          if (length(q - p) < distance_) return false;
      }
    return true;
  }

 private:
  [[nodiscard]] std::int32_t cell(double x) const noexcept {
    return static_cast<std::int32_t>(std::floor(x / distance_));
  }
  static std::uint64_t key(std::int32_t x, std::int32_t y) noexcept {
    return (std::uint64_t{static_cast<std::uint32_t>(y)} << 32) | static_cast<std::uint32_t>(x);
  }

  double distance_;
  std::unordered_map<std::uint64_t, std::vector<glm::dvec2>> cells_;
};

double edgeLength(const engine::Edge& edge) noexcept {
  double sum = edge.closed ? length(edge.points_mm.front() - edge.points_mm.back()) : 0.0;
  for (std::size_t i = 1; i < edge.points_mm.size(); ++i)
    sum += length(edge.points_mm[i] - edge.points_mm[i - 1]);
  return sum;
}

class Hand {
 public:
  Hand(const engine::Version& scan, std::span<const engine::Edge> edges, const OperatorSpec& spec)
      : spec_(spec),
        surface_(scan),
        clearance_(edges, spec.smooth_clear_mm),
        tip_(0.0, 0.0, surface_.highest() + spec.lift_mm) {}

  // Follows `path`; near a step the tip stays at the lowest height within `guide` and comes down `approach`
  // away from the path's start.
  void trace(const Path& path, Tool tool, double guide, glm::dvec2 approach) {
    ++stroke_;
    const HandDrift drift(spec_.wander_mm, spec_.tremor_mm, spec_.seed, stroke_);
    const auto tipAt = [&](double s, double seconds) {
      const glm::dvec2 p = surface_.inside(path.place(s) + drift.at(seconds));
      return glm::dvec3{p.x, p.y, surface_.lowest(p, guide) - spec_.press_mm + drift.heightAt(seconds)};
    };
    const double free_height = surface_.highest() + spec_.lift_mm;
    const glm::dvec3 first = tipAt(0.0, 0.0);
    const glm::dvec2 down = surface_.inside(glm::dvec2{first.x, first.y} + approach);
    moveTo({down.x, down.y, free_height});
    moveTo({down.x, down.y, first.z});
    if (down.x != first.x || down.y != first.y) moveTo(first);
    const double step = spec_.speed_mm_s / spec_.rate_hz;
    double s = 0.0;
    for (std::int64_t i = 1; s < path.end(); ++i) {
      s = std::min(static_cast<double>(i) * step, path.end());
      // The motion's time starts with the stroke, so that the tip comes down where the tremor begins.
      const bool only_feel = tool == Tool::kSmooth && !clearance_.keeps(path.place(s));
      add(tipAt(s, static_cast<double>(i) / spec_.rate_hz), only_feel ? Tool::kFeel : tool);
    }
    moveTo({tip_.x, tip_.y, free_height});
  }

  [[nodiscard]] std::vector<StrokeSample> rows() && { return std::move(rows_); }

 private:
  [[nodiscard]] double now() const noexcept { return static_cast<double>(rows_.size()) / spec_.rate_hz; }

  void add(glm::dvec3 tip, Tool tool) {
    rows_.push_back({now(), tip, tool});
    tip_ = tip;
  }

  // A free move with the profile of least jerk: Flash and Hogan, The coordination of arm movements (1985).
  void moveTo(glm::dvec3 end) {
    const glm::dvec3 from = tip_;
    const glm::dvec3 way = end - from;
    const double distance = std::sqrt(way.x * way.x + way.y * way.y + way.z * way.z);
    const auto ticks =
        std::max<std::int64_t>(1, static_cast<std::int64_t>(std::ceil(distance / kAirSpeed * spec_.rate_hz)));
    for (std::int64_t i = 1; i <= ticks; ++i) {
      const double t = static_cast<double>(i) / static_cast<double>(ticks);
      // The last row is the end itself, not its rounded sum.
      add(i == ticks ? end : from + way * (t * t * t * (10.0 + t * (6.0 * t - 15.0))), Tool::kFeel);
    }
  }

  const OperatorSpec& spec_;
  FeltSurface surface_;
  Clearance clearance_;
  glm::dvec3 tip_;
  std::uint64_t stroke_ = 0;
  std::vector<StrokeSample> rows_;
};

}  // namespace

OperatorSpec offTheEdges(OperatorSpec spec, const engine::Grid& grid) {
  constexpr double kDeviations = 4.0;
  constexpr double kWindow = 2.0;   // [samples]
  constexpr double kLineMm = 0.05;  // of a parallel line between the points of the edge
  spec.smooth_clear_mm = kDeviations * std::hypot(spec.tremor_mm, spec.wander_mm) + spec.press_mm +
                         kWindow * std::max(grid.spacingXMm(), grid.spacingYMm());
  spec.smooth_offset_mm = spec.smooth_clear_mm + kLineMm;
  return spec;
}

std::vector<StrokeSample> operatorStrokes(const engine::Version& scan, std::span<const engine::Edge> edges,
                                          const OperatorSpec& spec) {
  assert(spec.rate_hz >= 100.0 && spec.rate_hz <= 10000.0 && spec.speed_mm_s > 0.0 && spec.lift_mm > 0.0);
  assert(spec.press_mm >= 0.0 && spec.tremor_mm >= 0.0 && spec.wander_mm >= 0.0);
  assert(spec.guide_mm >= 0.0 && spec.smooth_offset_mm >= 0.0 &&
         spec.smooth_clear_mm <= spec.smooth_offset_mm);
  assert(spec.smooth_passes >= 0 && spec.smooth_passes <= 16 && spec.mark_passes >= 0 &&
         spec.mark_passes <= 16);
  Hand hand(scan, edges, spec);
  for (const engine::Edge& edge : edges) {
    if (edge.points_mm.size() < 2 || edgeLength(edge) < spec.shortest_mm) continue;
    const bool step = edge.kind == engine::EdgeKind::kStep;
    const double to_high = edge.high_side_left ? 1.0 : -1.0;
    for (int k = 0; k < spec.smooth_passes; ++k)
      hand.trace(Path(edge, to_high * spec.smooth_offset_mm), Tool::kSmooth, 0.0, {0.0, 0.0});
    for (int k = 0; k < spec.mark_passes; ++k) {
      const double aside = spec.mark_offset_mm * (k - 0.5 * (spec.mark_passes - 1));
      const double guide = step ? spec.guide_mm : 0.0;
      const glm::dvec2 start = Path(edge, aside).place(0.0);
      const glm::dvec2 low = Path(edge, aside - to_high * guide).place(0.0);
      hand.trace(Path(edge, aside), Tool::kMark, guide, low - start);
    }
  }
  return std::move(hand).rows();
}

}  // namespace fettle::haptic
