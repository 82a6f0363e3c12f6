#include "engine/measure/moved_onto.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

#include <tbb/parallel_for.h>
#include <glm/matrix.hpp>
#include <glm/vec3.hpp>

#include "engine/field/builder.h"
#include "engine/measure/height_map.h"

namespace fettle::engine {

MovedField::MovedField(const Version& field, const RigidMotion& motion, double start)
    : field_(field),
      motion_(motion),
      start_(start),
      from_(field_.reader()),
      along_(glm::transpose(motion.rotation)[2]),
      unit_(field.grid().height_unit.mm),
      spacing_x_(field.grid().spacingXMm()),
      spacing_y_(field.grid().spacingYMm()),
      width_(field.grid().width),
      height_(field.grid().height) {}

Result<MovedField> MovedField::create(const Version& field, const RigidMotion& motion, JobControl& job) {
  const auto middle = heightsAround(field, Region::kAll, job);
  if (!middle) return tl::unexpected(middle.error());
  return MovedField(field, motion, motion.moved({motion.centre.x, motion.centre.y, middle->middle}).z);
}

namespace {

// `t` in a cell as its end, where that is within `by`.
double atEnd(double t, double by) {
  return std::abs(t - std::round(t)) < by ? std::round(t) : t;
}

}  // namespace

// The bilinear patch at a place of the field.
MovedField::Patch MovedField::patchAt(double x, double y) const noexcept {
  const double u = x / spacing_x_, v = y / spacing_y_;
  if (!(u >= -kBeyond && v >= -kBeyond && u <= width_ - 1 + kBeyond && v <= height_ - 1 + kBeyond)) return {};
  const auto c = std::clamp(static_cast<std::int32_t>(u), 0, std::max(0, width_ - 2)),
             r = std::clamp(static_cast<std::int32_t>(v), 0, std::max(0, height_ - 2));
  // A sample on the border is one, whatever rounding makes of its place.
  constexpr double kRounding = 1e-9;
  const Patch patch = patchIn(c, r, atEnd(u - c, kRounding), atEnd(v - r, kRounding));
  return std::isnan(patch.z) ? patchIn(c, r, atEnd(u - c, kBeyond), atEnd(v - r, kBeyond)) : patch;
}

// Of the cell at (c, r), at (s, t) in it.
MovedField::Patch MovedField::patchIn(std::int32_t c, std::int32_t r, double s, double t) const noexcept {
  const std::int32_t right = std::min(c + 1, width_ - 1), above = std::min(r + 1, height_ - 1);
  const auto height = [&](std::int32_t column, std::int32_t row, double weight) {
    return weight == 0.0 ? 0.0 : double{from_.heightAt(column, row)} * unit_;
  };
  const double z00 = height(c, r, (1.0 - s) * (1.0 - t)), z10 = height(right, r, s * (1.0 - t)),
               z01 = height(c, above, (1.0 - s) * t), z11 = height(right, above, s * t);
  return {(1.0 - t) * ((1.0 - s) * z00 + s * z10) + t * ((1.0 - s) * z01 + s * z11),
          ((1.0 - t) * (z10 - z00) + t * (z11 - z01)) / spacing_x_,
          ((1.0 - s) * (z01 - z00) + s * (z11 - z10)) / spacing_y_};
}

MovedField::Place MovedField::at(double x, double y) const noexcept {
  const glm::dvec3 foot = motion_.movedBack({x, y, start_});
  // How far above `start_` the moved surface is: constant without a tilt, else by steps towards it, which come nearer as
  // long as the surface does not overhang.
  double above = 0.0;
  constexpr int kRounds = 60;
  for (int round = 0; round < kRounds; ++round) {
    const glm::dvec3 p = foot + above * along_;
    const Patch patch = patchAt(p.x, p.y);
    if (std::isnan(patch.z)) return {};
    const double slope = along_.z - patch.slope_x * along_.x - patch.slope_y * along_.y;
    const double step = (patch.z - p.z) / (slope > 0.05 && round < kRounds / 2 ? slope : along_.z);
    above += step;
    if (std::abs(step) > 1e-10 * (std::abs(start_) + std::abs(above)) && (along_.x != 0.0 || along_.y != 0.0))
      continue;
    if (slope > 0.0) return {start_ + above, p.x, p.y};
    return {};
  }
  return {};
}

Result<Version> movedOnto(const Version& second, const RigidMotion& motion, const Grid& grid,
                          JobControl& job) {
  Grid onto = grid;
  onto.height_per_count = 0.0;
  Result<FieldBuilder> builder = FieldBuilder::create(onto, "the aligned field");
  if (!builder) return tl::unexpected(builder.error());
  const Result<MovedField> moved = MovedField::create(second, motion, job);
  if (!moved) return tl::unexpected(moved.error());
  const std::int32_t tile_columns = (onto.width + kTileSide - 1) / kTileSide;
  const std::int64_t tiles = std::int64_t{tile_columns} * ((onto.height + kTileSide - 1) / kTileSide);
  job.begin("moving the field", static_cast<std::uint64_t>(tiles));
  tbb::parallel_for(std::int64_t{0}, tiles, [&](std::int64_t i) {
    if (job.cancelled()) return;
    const auto column = static_cast<std::int32_t>(i % tile_columns) * kTileSide,
               row = static_cast<std::int32_t>(i / tile_columns) * kTileSide;
    const std::int32_t columns = std::min(kTileSide, onto.width - column),
                       rows = std::min(kTileSide, onto.height - row);
    float out[kTileSamples];
    for (std::int32_t r = 0; r < rows; ++r)
      for (std::int32_t c = 0; c < columns; ++c)
        out[r * kTileSide + c] =
            static_cast<float>(moved->at((column + c) * onto.spacingXMm(), (row + r) * onto.spacingYMm()).z /
                               onto.height_unit.mm);
    builder->writeHeights(column, row, columns, rows, out, kTileSide);
    job.advance();
  });
  if (job.cancelled()) return cancelled();
  return std::move(*builder).build();
}

}  // namespace fettle::engine
