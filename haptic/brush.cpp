#include "haptic/brush.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>

#include "haptic/effect.h"

namespace fettle::haptic {

namespace {

// The blend over one 3 x 3 window around `centre` (stride in elements); the centre is no hole.
double blend(const float* centre, std::ptrdiff_t stride, double strength) noexcept {
  static constexpr double kBinomial[3][3] = {{1, 2, 1}, {2, 4, 2}, {1, 2, 1}};
  double gauss = 0.0;
  double gauss_weight = 0.0;
  double box = 0.0;
  double box_weight = 0.0;
  for (int r = -1; r <= 1; ++r)
    for (int c = -1; c <= 1; ++c) {
      const auto z = static_cast<double>(centre[r * stride + c]);
      const bool hole = std::isnan(z);
      const double w = hole ? 0.0 : kBinomial[r + 1][c + 1];
      const double one = hole ? 0.0 : 1.0;
      const double value = hole ? 0.0 : z;
      gauss += w * value;
      gauss_weight += w;
      box += value;
      box_weight += one;
    }
  gauss /= gauss_weight;
  box /= box_weight;
  // In this form a flat window stays flat to the bit.
  return gauss + strength * (box - gauss);
}

}  // namespace

Brush::Brush(double radius, std::optional<double> max_change, const engine::Version& original)
    : disc_(radius), max_change_(max_change) {
  if (max_change_) original_ = original;
  const auto side = static_cast<std::size_t>(2 * disc_.reach + 1);
  before_.resize((side + 2) * (side + 2));
  after_.resize(side * side);
  marked_.resize(side * side);
}

float Brush::limited(double height, float old, std::int32_t column, std::int32_t row) const noexcept {
  if (!max_change_) return static_cast<float>(height);
  const float origin = original_.reader().heightAt(column, row);
  if (std::isnan(origin)) return old;
  const double low = static_cast<double>(origin) - *max_change_;
  const double high = static_cast<double>(origin) + *max_change_;
  float z = static_cast<float>(std::clamp(height, low, high));
  // Rounding to float may step over the limit by one. It cannot step over the origin, itself a float.
  constexpr float kInf = std::numeric_limits<float>::infinity();
  if (static_cast<double>(z) > high) z = std::nextafter(z, -kInf);
  if (static_cast<double>(z) < low) z = std::nextafter(z, kInf);
  return z;
}

bool Brush::apply(engine::LiveField& field, std::int32_t column, std::int32_t row, double strength) noexcept {
  const engine::FieldReader reader = field.reader();
  const std::int32_t reach = disc_.reach;
  const std::int32_t side = 2 * reach + 1;
  const std::int32_t stride = side + 2;
  reader.readHeights(column - reach - 1, row - reach - 1, stride, stride, before_.data(), stride);
  reader.readMarks(column - reach, row - reach, side, side, marked_.data(), side);
  for (std::int32_t dr = 0; dr < side; ++dr) {
    const float* before = before_.data() + (dr + 1) * stride + 1;
    float* after = after_.data() + dr * side;
    std::copy_n(before, side, after);
    const std::int32_t half = disc_.half_width[static_cast<std::size_t>(dr)];
    for (std::int32_t dc = reach - half; dc <= reach + half; ++dc) {
      if (std::isnan(before[dc]) || marked_[static_cast<std::size_t>(dr * side + dc)] != 0) continue;
      after[dc] =
          limited(blend(before + dc, stride, strength), before[dc], column - reach + dc, row - reach + dr);
    }
  }
  // Only what lies in the field can be written.
  const std::int32_t c0 = std::max(column - reach, 0);
  const std::int32_t r0 = std::max(row - reach, 0);
  const std::int32_t c1 = std::min(column + reach + 1, reader.width());
  const std::int32_t r1 = std::min(row + reach + 1, reader.height());
  return field.writeHeights(c0, r0, c1 - c0, r1 - r0,
                            after_.data() + (r0 - row + reach) * side + (c0 - column + reach), side);
}

namespace {

void runSmoothing(void* data, TickState& state) noexcept {
  const CellIndex centre = state.contact.proxy.cell;
  if (!static_cast<Brush*>(data)->apply(state.field, centre.column, centre.row, state.strength))
    ++state.counters.refused_edits;
  state.surface.refresh(state.field.reader());
}

}  // namespace

void addSmoothing(EffectList& list, const Scene& scene, const engine::Version& original) {
  auto brush = std::make_shared<Brush>(scene.brush_radius_samples, scene.max_change, original);
  list.tools[static_cast<std::size_t>(Tool::kSmooth)] = {&runSmoothing, brush.get()};
  list.data.push_back(std::move(brush));
}

}  // namespace fettle::haptic
