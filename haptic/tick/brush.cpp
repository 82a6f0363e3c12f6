#include "haptic/tick/brush.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <memory>
#include <span>
#include <utility>

#include <glm/geometric.hpp>
#include <glm/vec2.hpp>

#include "engine/filter/limit_change.h"
#include "haptic/effects/effect.h"

namespace fettle::haptic {

namespace {

constexpr double kBinomial[3][3] = {{1, 2, 1}, {2, 4, 2}, {1, 2, 1}};

// The sums of blend() where not all of the window counts, as around holes: no weight, the rest is renormalised.
struct WindowSums {
  double gauss = 0.0, gauss_weight = 0.0;
  double box = 0.0, box_weight = 0.0;
};

// Which of a window's samples count, by row, then column: bit 3 (r + 1) + c + 1.
using WindowMask = unsigned;
constexpr WindowMask kWholeWindow = 0x1FF;

WindowSums sumsOf(const float* centre, std::ptrdiff_t stride, WindowMask mask) noexcept {
  WindowSums sums;
  for (int r = -1; r <= 1; ++r)
    for (int c = -1; c <= 1; ++c) {
      const auto z = static_cast<double>(centre[r * stride + c]);
      if (std::isnan(z) || (mask >> (3 * (r + 1) + c + 1) & 1U) == 0) continue;
      const double w = kBinomial[r + 1][c + 1];
      sums.gauss += w * z;
      sums.gauss_weight += w;
      sums.box += z;
      sums.box_weight += 1.0;
    }
  return sums;
}

// The samples of a window that no line parts from its middle; `cut` holds the links that are cut, as LineCut::links.
WindowMask connected(const std::uint8_t* cut, std::ptrdiff_t stride) noexcept {
  using engine::LineCut;
  // Whether the link from (c, r) to the next column, to the next row, is whole.
  const auto right = [&](int c, int r) { return (cut[r * stride + c] & LineCut::kRight) == 0; };
  const auto up = [&](int c, int r) { return (cut[r * stride + c] & LineCut::kUp) == 0; };
  WindowMask mask = 1U << 4;
  for (const int c : {-1, 1})
    if (right(std::min(c, 0), 0)) mask |= 1U << (4 + c);
  for (const int r : {-1, 1})
    if (up(0, std::min(r, 0))) mask |= 1U << (4 + 3 * r);
  for (const int r : {-1, 1})
    for (const int c : {-1, 1}) {
      const bool row_first = right(std::min(c, 0), 0) && up(c, std::min(r, 0));
      const bool column_first = up(0, std::min(r, 0)) && right(std::min(c, 0), r);
      if (row_first || column_first) mask |= 1U << (4 + 3 * r + c);
    }
  return mask;
}

// The blend over the samples that count of one 3 x 3 window around `centre` (stride in elements); the centre is no
// hole and counts.
double blend(const float* centre, std::ptrdiff_t stride, double strength,
             WindowMask mask = kWholeWindow) noexcept {
  WindowSums sums{0.0, 16.0, 0.0, 9.0};
  for (int r = -1; r <= 1; ++r)
    for (int c = -1; c <= 1; ++c) {
      const auto z = static_cast<double>(centre[r * stride + c]);
      sums.gauss += kBinomial[r + 1][c + 1] * z;
      sums.box += z;
    }
  // Nine floats cannot overflow a double: a NaN among them, and nothing else, makes the sum NaN.
  if (std::isnan(sums.box) || mask != kWholeWindow) [[unlikely]]
    sums = sumsOf(centre, stride, mask);
  const double gauss = sums.gauss / sums.gauss_weight;
  const double box = sums.box / sums.box_weight;
  // In this form a flat window stays exactly flat.
  return gauss + strength * (box - gauss);
}

// heightAt multiplies by the sign, which turns a denormal into zero on the haptic thread.
float exactHeight(const engine::FieldReader& reader, std::int32_t column, std::int32_t row) noexcept {
  using engine::kTileShift;
  using engine::kTileSide;
  const engine::Tile& tile = reader.tile(column >> kTileShift, row >> kTileShift);
  const float height = tile.samples[static_cast<std::size_t>((row & (kTileSide - 1)) * kTileSide +
                                                             (column & (kTileSide - 1)))];
  return reader.sign() < 0.0F ? -height : height;
}

// By its bits: on the haptic thread it compares equal to zero.
bool isDenormal(float height) noexcept {
  const auto size = std::bit_cast<std::uint32_t>(height) & 0x7fffffffU;
  return size != 0 && size < 0x00800000U;
}

}  // namespace

Brush::Brush(double radius, std::optional<double> max_change, const engine::Version& original,
             Falloff falloff)
    : disc_(radius), max_change_(max_change) {
  if (max_change_) original_ = original;
  if (falloff != Falloff::kFlat && disc_.reach > 0)
    for (std::int32_t dr = -disc_.reach; dr <= disc_.reach; ++dr)
      for (std::int32_t dc = -disc_.reach; dc <= disc_.reach; ++dc) {
        const double way = std::sqrt(static_cast<double>(dr * dr + dc * dc)) / (radius + 1.0);
        weights_.push_back(way < 1.0 ? rowOf(falloff).weight(way) : 0.0);  // beyond: the square's corners
      }
  const auto side = static_cast<std::size_t>(2 * disc_.reach + 1);
  before_.resize((side + 2) * (side + 2));
  after_.resize(side * side);
  marked_.resize(side * side);
  cut_.resize(before_.size());
}

bool Brush::findCuts(const engine::LineCuts* cuts, std::int32_t column, std::int32_t row,
                     std::int32_t side) noexcept {
  if (cuts == nullptr) return false;
  bool any = false;
  for (std::int32_t r = 0; r < side; ++r) {
    const std::span<const engine::LineCut> all = cuts->row(row + r);
    auto cut = std::ranges::lower_bound(all, column, {}, &engine::LineCut::column);
    if (cut == all.end() || cut->column >= column + side) continue;
    if (!any) std::ranges::fill(cut_, std::uint8_t{0});
    any = true;
    for (; cut != all.end() && cut->column < column + side; ++cut)
      cut_[static_cast<std::size_t>(r * side + cut->column - column)] = cut->links;
  }
  return any;
}

float Brush::limited(double height, float old, std::int32_t column, std::int32_t row) const noexcept {
  if (!max_change_) return static_cast<float>(height);
  const float origin = exactHeight(original_.reader(), column, row);
  // A denormal is zero on the haptic thread, which cannot measure the distance of a height from it.
  if (std::isnan(origin) || isDenormal(origin)) return old;
  return engine::limitedChange(static_cast<float>(height), origin, *max_change_);
}

// The paper's brush of one sample, whose window is mostly within one tile: read in place.
bool Brush::applyToOne(engine::LiveField& field, std::int32_t column, std::int32_t row,
                       double strength) noexcept {
  using engine::kTileShift;
  using engine::kTileSide;
  const engine::FieldReader reader = field.reader();
  const int c = column & (kTileSide - 1);
  const int r = row & (kTileSide - 1);
  const engine::Tile& tile = reader.tile(column >> kTileShift, row >> kTileShift);
  if (tile.marked(c, r)) return true;
  const float* centre = tile.samples.data() + r * kTileSide + c;
  std::ptrdiff_t stride = kTileSide;
  const bool within = c > 0 && c < kTileSide - 1 && r > 0 && r < kTileSide - 1;
  if (!within || reader.sign() < 0.0F) {
    stride = 3;
    reader.readHeights(column - 1, row - 1, 3, 3, before_.data(), stride);
    centre = before_.data() + stride + 1;
  }
  const float old = *centre;
  if (std::isnan(old)) return true;
  const WindowMask mask =
      findCuts(field.lineCuts(), column - 1, row - 1, 3) ? connected(cut_.data() + 4, 3) : kWholeWindow;
  return field.setHeight(column, row, limited(blend(centre, stride, strength, mask), old, column, row));
}

template <bool kFades>
void Brush::smoothRows(const engine::LineCuts* cuts, std::int32_t column, std::int32_t row,
                       double strength) noexcept {
  const std::int32_t reach = disc_.reach;
  const std::int32_t side = 2 * reach + 1;
  const std::int32_t stride = side + 2;
  const bool cut = findCuts(cuts, column - reach - 1, row - reach - 1, stride);
  for (std::int32_t dr = 0; dr < side; ++dr) {
    const std::uint8_t* links = cut_.data() + (dr + 1) * stride + 1;
    const float* before = before_.data() + (dr + 1) * stride + 1;
    float* after = after_.data() + dr * side;
    std::copy_n(before, side, after);
    const std::int32_t half = disc_.half_width[static_cast<std::size_t>(dr)];
    for (std::int32_t dc = reach - half; dc <= reach + half; ++dc) {
      if (std::isnan(before[dc]) || marked_[static_cast<std::size_t>(dr * side + dc)] != 0) continue;
      const WindowMask mask = cut ? connected(links + dc, stride) : kWholeWindow;
      double height = blend(before + dc, stride, strength, mask);
      if constexpr (kFades) {
        const auto old = static_cast<double>(before[dc]);
        height = old + weights_[static_cast<std::size_t>(dr * side + dc)] * (height - old);
      }
      after[dc] = limited(height, before[dc], column - reach + dc, row - reach + dr);
    }
  }
}

bool Brush::apply(engine::LiveField& field, std::int32_t column, std::int32_t row, double strength) noexcept {
  if (disc_.reach == 0 && field.grid().contains(column, row)) return applyToOne(field, column, row, strength);
  const engine::FieldReader reader = field.reader();
  const std::int32_t reach = disc_.reach;
  const std::int32_t side = 2 * reach + 1;
  const std::int32_t stride = side + 2;
  reader.readHeights(column - reach - 1, row - reach - 1, stride, stride, before_.data(), stride);
  reader.readMarks(column - reach, row - reach, side, side, marked_.data(), side);
  if (weights_.empty())
    smoothRows<false>(field.lineCuts(), column, row, strength);
  else
    smoothRows<true>(field.lineCuts(), column, row, strength);
  // Only samples of the field can be written.
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

// A brush that acts again only when the tip has moved on.
struct SpacedBrush {
  Brush brush;
  double spacing_mm;  // > 0, along the field
  glm::dvec2 acted_mm{0.0};
  bool acted = false;  // in this contact
};

void runSpaced(void* data, TickState& state) noexcept {
  SpacedBrush& spaced = *static_cast<SpacedBrush*>(data);
  const glm::dvec2 here_mm(state.contact.proxy.position_mm);
  const glm::dvec2 moved_mm = here_mm - spaced.acted_mm;
  if (spaced.acted && glm::dot(moved_mm, moved_mm) < spaced.spacing_mm * spaced.spacing_mm) return;
  spaced.acted = true;
  spaced.acted_mm = here_mm;
  runSmoothing(&spaced.brush, state);
}

void resetSpaced(void* data, ResetCause /*why*/) noexcept {
  static_cast<SpacedBrush*>(data)->acted = false;
}

}  // namespace

void addSmoothing(EffectList& list, const EffectSource& from) {
  const Scene& scene = from.scene;
  const auto tool = static_cast<std::size_t>(Tool::kSmooth);
  Brush brush(scene.brush_radius_samples, scene.max_change, from.original, scene.brush_falloff);
  const std::size_t held = brush.bytesHeld();
  if (scene.brush_spacing == 0.0) {
    Brush& made = addData(list, EffectKind::kSmoothing, std::make_shared<Brush>(std::move(brush)), held);
    list.tools[tool] = {&runSmoothing, &made};
    return;
  }
  const engine::Grid& grid = from.now.grid();
  const double radius_mm =
      std::max(scene.brush_radius_samples, 0.5) * std::max(grid.spacingXMm(), grid.spacingYMm());
  SpacedBrush spaced{.brush = std::move(brush), .spacing_mm = scene.brush_spacing * radius_mm};
  SpacedBrush& made =
      addData(list, EffectKind::kSmoothing, std::make_shared<SpacedBrush>(std::move(spaced)), held);
  list.tools[tool] = {&runSpaced, &made};
  list.resets.push_back({&resetSpaced, &made});
}

}  // namespace fettle::haptic
