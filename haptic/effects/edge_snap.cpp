#include "haptic/effects/edge_snap.h"

#include <array>
#include <cmath>

namespace fettle::haptic {

namespace {

constexpr double kComingOn_s = 0.050;

// Weights of a uniform quadratic B-spline at u in [-0.5, 0.5] from the middle of three, and their slopes.
struct QuadraticWeights {
  std::array<double, 3> value, slope;

  explicit QuadraticWeights(double u) noexcept
      : value{0.5 * (0.5 - u) * (0.5 - u), 0.75 - u * u, 0.5 * (0.5 + u) * (0.5 + u)},
        slope{u - 0.5, -2.0 * u, u + 0.5} {}
};

}  // namespace

EdgeSnap::EdgeSnap(const EdgeSnapParams& params, const engine::FieldReader& reader,
                   const engine::LineCuts* lines)
    : distance_(reader, lines, params.reach_mm),
      sx_(reader.grid().spacingXMm()),
      sy_(reader.grid().spacingYMm()),
      width_(reader.width()),
      height_(reader.height()),
      deepest_mj_(2.0 / 3.0 * params.force_n * distance_.reachMm()) {}

EdgeSnap::Potential EdgeSnap::at(double x_mm, double y_mm) const noexcept {
  const double x = std::clamp(x_mm / sx_, 0.0, static_cast<double>(width_ - 1));
  const double y = std::clamp(y_mm / sy_, 0.0, static_cast<double>(height_ - 1));
  const auto column = static_cast<std::int32_t>(x + 0.5);
  const auto row = static_cast<std::int32_t>(y + 0.5);
  const QuadraticWeights wx(x - column);
  const QuadraticWeights wy(y - row);
  Potential sum;
  for (int j = 0; j < 3; ++j) {
    const std::int32_t r = std::clamp(row + j - 1, 0, height_ - 1);
    double along = 0.0, along_slope = 0.0;
    for (int i = 0; i < 3; ++i) {
      const std::int32_t c = std::clamp(column + i - 1, 0, width_ - 1);
      const double u = potentialOf(static_cast<double>(distance_.at(c, r)));
      along += wx.value[static_cast<std::size_t>(i)] * u;
      along_slope += wx.slope[static_cast<std::size_t>(i)] * u;
    }
    sum.mj += wy.value[static_cast<std::size_t>(j)] * along;
    sum.slope.x += wy.value[static_cast<std::size_t>(j)] * along_slope / sx_;
    sum.slope.y += wy.slope[static_cast<std::size_t>(j)] * along / sy_;
  }
  return sum;
}

void EdgeSnap::run(TickState& state) noexcept {
  if (!touching_) {
    touching_ = true;
    touched_s_ = state.t_s;
  }
  const double on = std::min((state.t_s - touched_s_) / kComingOn_s, 1.0);
  if (!(on > 0.0)) return;  // NaN included
  const Potential potential = at(state.endpoint_mm.x, state.endpoint_mm.y);
  state.force_n.x -= on * potential.slope.x;
  state.force_n.y -= on * potential.slope.y;
  state.stored_mj += on * (potential.mj + deepest_mj_);
}

void EdgeSnap::upkeep(TickState& state) noexcept {
  const engine::SampleRect& rect = state.marked;
  if (rect.columns > 0) distance_.markChanged(rect.column, rect.row, rect.columns, rect.rows);
  distance_.advance(state.field.reader(), state.field.lineCuts());
  state.counters.snap_tiles_refused = distance_.refused();
}

void EdgeSnap::reset(ResetCause why) noexcept {
  touching_ = false;
  if (why == ResetCause::kFieldChanged) distance_.rescan();
}

void addEdgeSnap(EffectList& list, const EffectSource& from) {
  auto made = std::make_shared<EdgeSnap>(from.scene.params.edge_snap, from.now.reader(), from.now.lineCuts());
  const std::size_t held = made->distance().bytesHeld();
  EdgeSnap& snap = addData(list, EffectKind::kEdgeSnap, std::move(made), held);
  list.in_contact.push_back(
      {[](void* data, TickState& state) noexcept { static_cast<EdgeSnap*>(data)->run(state); }, &snap});
  list.upkeep.push_back(
      {[](void* data, TickState& state) noexcept { static_cast<EdgeSnap*>(data)->upkeep(state); }, &snap});
  list.resets.push_back(
      {[](void* data, ResetCause why) noexcept { static_cast<EdgeSnap*>(data)->reset(why); }, &snap});
}

}  // namespace fettle::haptic
