#include "haptic/contact/collision.h"

#include <algorithm>
#include <cmath>

namespace fettle::haptic {

namespace {

// Rounding of the ray's height, relative to its ends; far above the few 1e-16 that can occur.
constexpr double kSlack = 1e-13;

// Narrows [enter, leave] to where 0 <= g + t d <= size; false when nothing is left.
bool clip(double g, double d, double size, double& enter, double& leave) noexcept {
  if (d == 0.0) return g >= 0.0 && g <= size;
  const double a = (0.0 - g) / d;
  const double b = (size - g) / d;
  enter = std::max(enter, std::min(a, b));
  leave = std::min(leave, std::max(a, b));
  return enter <= leave;
}

}  // namespace

RayWalk::RayWalk(Surface& surface, const glm::dvec3& from, const glm::dvec3& to) noexcept
    : surface_(surface),
      gx_(from.x / surface.spacingX()),
      gy_(from.y / surface.spacingY()),
      dx_(to.x / surface.spacingX() - gx_),
      dy_(to.y / surface.spacingY() - gy_),
      z_(from.z),
      dz_(to.z - from.z),
      slack_(kSlack * (std::abs(from.z) + std::abs(to.z))) {
  if (surface.cellColumns() < 1 || surface.cellRows() < 1) return;
  double enter = 0.0;
  double leave = 1.0;
  // Endpoints 1e300 mm away overflow the direction: for such a ray no contact can be computed.
  if (!std::isfinite(dx_) || !std::isfinite(dy_) || !std::isfinite(dz_)) return;
  if (!clip(gx_, dx_, surface.cellColumns(), enter, leave) ||
      !clip(gy_, dy_, surface.cellRows(), enter, leave))
    return;
  at_ = enter;
  end_ = leave;
  cell_ = {static_cast<std::int32_t>(std::clamp(gx_ + enter * dx_, 0.0, surface.cellColumns() - 1.0)),
           static_cast<std::int32_t>(std::clamp(gy_ + enter * dy_, 0.0, surface.cellRows() - 1.0))};
  // On a grid line and going down or left, the ray is above the lower cell.
  if (dx_ < 0.0 && cell_.column > 0 && gx_ + enter * dx_ == cell_.column) --cell_.column;
  if (dy_ < 0.0 && cell_.row > 0 && gy_ + enter * dy_ == cell_.row) --cell_.row;
  done_ = false;
}

// Where the ray meets the sides of the square of 2^shift cells that holds the present cell, not clipped.
RayWalk::Exit RayWalk::exitOf(int shift) const noexcept {
  const double side = static_cast<double>(std::int64_t{1} << shift);
  Exit exit;
  if (dx_ != 0.0) {
    const double low = static_cast<double>((cell_.column >> shift) << shift);
    exit.x = ((dx_ > 0.0 ? low + side : low) - gx_) / dx_;
  }
  if (dy_ != 0.0) {
    const double low = static_cast<double>((cell_.row >> shift) << shift);
    exit.y = ((dy_ > 0.0 ? low + side : low) - gy_) / dy_;
  }
  return exit;
}

double RayWalk::leaveAt(const Exit& exit) const noexcept {
  return std::max(std::min(end_, std::min(exit.x, exit.y)), at_);
}

// Moves to the first cell beyond the square. The coordinate across that side moves by whole numbers; the
// other coordinate is computed, kept within the square and never moved backwards, so rounding cannot stall
// the walk.
void RayWalk::step(int shift, const Exit& exit, double leave) noexcept {
  if (std::min(exit.x, exit.y) >= end_) {
    done_ = true;
    return;
  }
  const auto cross = [&](std::int32_t index, double d) {
    const std::int32_t low = (index >> shift) << shift;
    return d > 0.0 ? low + (1 << shift) : low - 1;
  };
  const auto follow = [&](std::int32_t index, double g, double d) {
    const std::int32_t low = (index >> shift) << shift;
    const double here = std::clamp(std::floor(g + leave * d), static_cast<double>(low),
                                   static_cast<double>(low + (1 << shift) - 1));
    const auto next = static_cast<std::int32_t>(here);
    return d > 0.0 ? std::max(next, index) : (d < 0.0 ? std::min(next, index) : index);
  };
  if (exit.x <= exit.y)
    cell_ = {cross(cell_.column, dx_), follow(cell_.row, gy_, dy_)};
  else
    cell_ = {follow(cell_.column, gx_, dx_), cross(cell_.row, dy_)};
  at_ = leave;
  if (!surface_.hasCell(cell_)) done_ = true;
}

double RayWalk::lowest(double enter, double leave) const noexcept {
  return z_ + (dz_ < 0.0 ? leave : enter) * dz_ - slack_;
}

// Whether the ray is above everything in the pyramid's square around the present cell. Cells at the square's
// upper edges use samples of the next squares.
bool RayWalk::clears(int level, double ray_low) const noexcept {
  const engine::FieldReader& reader = surface_.reader();
  const int shift = 3 * (level + 1);
  const std::int32_t x = cell_.column >> shift;
  const std::int32_t y = cell_.row >> shift;
  for (int k = 0; k < 4; ++k) {
    const engine::HeightBounds b = reader.bounds(level, x + (k & 1), y + (k >> 1));
    if (!b.empty() && !(static_cast<double>(b.max) * surface_.heightUnit() < ray_low)) return false;
  }
  return true;
}

bool RayWalk::next(RayCell& out) noexcept {
  while (!done_ && steps_ < kMaxSteps) {
    ++steps_;
    // Larger squares are tried only after the ray left a smaller one: a short ray never reads the pyramid.
    if (level_ >= 0) {
      const int shift = 3 * (level_ + 1);
      const Exit exit = exitOf(shift);
      const double leave = leaveAt(exit);
      if (clears(level_, lowest(at_, leave))) {
        step(shift, exit, leave);
        level_ = std::min(level_ + 1, surface_.reader().topLevel());
      } else {
        --level_;
      }
      continue;
    }
    const Exit exit = exitOf(0);
    const double leave = leaveAt(exit);
    const RayCell here{cell_, at_, leave};
    Patch patch;
    const bool touched = surface_.patch(cell_, patch) && !(patch.highest() < lowest(at_, leave));
    step(0, exit, leave);
    if (touched) {
      out = here;
      return true;
    }
    level_ = 0;
  }
  return false;
}

bool entersPatch(const Patch& s, const glm::dvec3& from, const glm::dvec3& to, double enter,
                 double leave) noexcept {
  // Height above the patch at t = enter + w (leave - enter), as k0 + k1 w + k2 w^2.
  const auto at = [&](double t) { return from + t * (to - from); };
  const glm::dvec3 a = at(enter);
  const glm::dvec3 b = at(leave);
  const double u = (a.x - s.x0) / s.sx;
  const double v = (a.y - s.y0) / s.sy;
  const double du = (b.x - a.x) / s.sx;
  const double dv = (b.y - a.y) / s.sy;
  const double k0 = a.z - s.heightAt(u, v);
  const double k1 = (b.z - a.z) - (s.b * du + s.c * dv + s.d * (u * dv + v * du));
  const double k2 = -s.d * du * dv;
  if (k0 < 0.0) return false;  // was below already
  if (k0 + k1 + k2 < 0.0) return true;
  // In at one side and out at the other: a dip between the ends.
  if (!(k2 > 0.0)) return false;
  const double w = -k1 / (2.0 * k2);
  return w > 0.0 && w < 1.0 && k0 + w * (k1 + k2 * w) < 0.0;
}

}  // namespace fettle::haptic
