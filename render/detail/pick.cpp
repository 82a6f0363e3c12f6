#include "render/detail/pick.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace fettle::render {
namespace {

constexpr double kNoHit = std::numeric_limits<double>::infinity();

struct Corners {
  double a, b, c, d;  // height = a + b u + c v + d u v [mm]
  bool whole;
};

Corners cornersOf(const engine::FieldReader& reader, std::int32_t column, std::int32_t row) noexcept {
  const double unit = reader.grid().height_unit.mm;
  const auto z = [&](int dc, int dr) { return unit * double{reader.heightAt(column + dc, row + dr)}; };
  const double z00 = z(0, 0), z10 = z(1, 0), z01 = z(0, 1), z11 = z(1, 1);
  const Corners p{z00, z10 - z00, z01 - z00, (z11 - z01) - (z10 - z00), true};
  return {p.a, p.b, p.c, p.d, !std::isnan(p.d)};
}

// First t in [enter, leave] at which z(t) - height(t) is zero, given the line in cell units from the cell's
// corner. `above`: in, that difference where the line left the previous cell, 0 if there was none; out, where
// it leaves this cell. By rounding, the line may leave one cell above the shared edge and enter the next one
// below it: that counts as a hit, too.
std::optional<double> meetPatch(const Corners& p, const glm::dvec3& from, const glm::dvec3& dir, double enter,
                                double leave, double& above) noexcept {
  // Counted from `enter`, so that the coefficients are as small as the cell and lose no digits far along the
  // line.
  const double u = from.x + enter * dir.x, v = from.y + enter * dir.y, z = from.z + enter * dir.z;
  const double c0 = z - (p.a + p.b * u + (p.c + p.d * u) * v);
  const double c1 = dir.z - (p.b * dir.x + p.c * dir.y + p.d * (u * dir.y + v * dir.x));
  const double c2 = -p.d * dir.x * dir.y;
  const double run = leave - enter;
  double first = kNoHit;
  const auto offer = [&](double t) {
    if (t >= 0.0 && t <= run) first = std::min(first, t);
  };
  const double before = above;
  above = c0 + run * (c1 + run * c2);
  if (c0 == 0.0 || (before != 0.0 && std::signbit(before) != std::signbit(c0))) return enter;
  const double square = c1 * c1 - 4.0 * c2 * c0;
  if (c2 == 0.0) {
    offer(-c0 / c1);  // infinite where the line runs along the patch
  } else if (square >= 0.0) {
    // Stable both for nearly flat and for strongly twisted patches (Press et al. 2007, 5.6).
    const double q = -0.5 * (c1 + std::copysign(std::sqrt(square), c1));
    offer(q / c2);
    if (q != 0.0) offer(c0 / q);
  }
  // Signs that differ at the two ends have a zero between them, regardless of rounding.
  if (first == kNoHit && std::signbit(c0) != std::signbit(above))
    first = above == c0 ? 0.0 : run * c0 / (c0 - above);
  if (first == kNoHit) return std::nullopt;
  return enter + std::clamp(first, 0.0, run);
}

}  // namespace

std::optional<double> surfaceHeight(const engine::FieldReader& reader, double x_mm, double y_mm) noexcept {
  const double x = x_mm / reader.grid().spacingXMm(), y = y_mm / reader.grid().spacingYMm();
  const std::int32_t columns = reader.width() - 1, rows = reader.height() - 1;
  if (columns < 1 || rows < 1 || !(x >= 0.0 && y >= 0.0 && x <= columns && y <= rows)) return std::nullopt;
  const std::int32_t c = std::min(static_cast<std::int32_t>(x), columns - 1);
  const std::int32_t r = std::min(static_cast<std::int32_t>(y), rows - 1);
  const Corners p = cornersOf(reader, c, r);
  if (!p.whole) return std::nullopt;
  const double u = x - c, v = y - r;
  return p.a + p.b * u + (p.c + p.d * u) * v;
}

std::optional<SurfaceHit> meetSurface(const engine::FieldReader& reader, const glm::dvec3& from,
                                      const glm::dvec3& direction) noexcept {
  const std::int32_t columns = reader.width() - 1, rows = reader.height() - 1;
  if (columns < 1 || rows < 1) return std::nullopt;
  const double sx = reader.grid().spacingXMm(), sy = reader.grid().spacingYMm();
  const double unit = reader.grid().height_unit.mm;
  const glm::dvec3 o{from.x / sx, from.y / sy, from.z};
  const glm::dvec3 d{direction.x / sx, direction.y / sy, direction.z};

  // The part of the line within the box of the field.
  const engine::HeightBounds all = reader.bounds();
  if (all.empty()) return std::nullopt;
  double t = 0.0, end = kNoHit;
  const auto cut = [&](double at, double along, double low, double high) {
    if (along == 0.0) {
      if (at < low || at > high) end = -1.0;
      return;
    }
    const double a = (low - at) / along, b = (high - at) / along;
    t = std::max(t, std::min(a, b));
    end = std::min(end, std::max(a, b));
  };
  const double thick = 1e-9 * (1.0 + unit * std::max(std::abs(double{all.min}), std::abs(double{all.max})));
  cut(o.x, d.x, 0.0, columns);
  cut(o.y, d.y, 0.0, rows);
  cut(o.z, d.z, unit * double{all.min} - thick, unit * double{all.max} + thick);
  if (!(t <= end)) return std::nullopt;

  const auto cellAt = [](double at, std::int32_t last) {
    // Clamped as a double: for a distant start, the position along the line may be off by more than an int
    // holds.
    return static_cast<std::int32_t>(std::clamp(std::floor(at), 0.0, static_cast<double>(last)));
  };
  std::int32_t c = cellAt(o.x + t * d.x, columns - 1), r = cellAt(o.y + t * d.y, rows - 1);
  const auto exit = [](double at, double along, std::int32_t low, std::int32_t high) {
    return along > 0.0 ? (high - at) / along : along < 0.0 ? (low - at) / along : kNoHit;
  };
  double above = 0.0;  // see meetPatch
  while (t <= end) {
    // The largest square that the line passes above or below: starting at the block of the cell, upwards.
    int shift = 0;
    for (int level = 0; level <= reader.topLevel(); ++level) {
      const int s = 3 * (level + 1);
      const std::int32_t x = c >> s, y = r >> s;
      const double out =
          std::min({end, exit(o.x, d.x, x << s, (x + 1) << s), exit(o.y, d.y, y << s, (y + 1) << s)});
      double low = kNoHit, high = -kNoHit;
      // Cells on the upper edges use samples of the next squares.
      for (int k = 0; k < 4; ++k) {
        const engine::HeightBounds b = reader.bounds(level, x + (k & 1), y + (k >> 1));
        if (b.empty()) continue;
        low = std::min(low, unit * double{b.min});
        high = std::max(high, unit * double{b.max});
      }
      const double z0 = o.z + t * d.z, z1 = o.z + out * d.z;
      const bool clear = low > high || std::min(z0, z1) > high + thick || std::max(z0, z1) < low - thick;
      if (!clear) break;
      shift = s;
    }
    if (shift != 0) {
      above = 0.0;  // outside of both: the line is not that near
    } else {
      const double leave = std::min({end, exit(o.x, d.x, c, c + 1), exit(o.y, d.y, r, r + 1)});
      const Corners p = cornersOf(reader, c, r);
      if (!p.whole) {
        above = 0.0;
      } else {
        const std::optional<double> at =
            meetPatch(p, {o.x - c, o.y - r, o.z}, d, t, std::max(t, leave), above);
        if (at) return SurfaceHit{from + *at * direction, c, r, *at};
      }
    }
    // Into the next cell, by the side that is crossed, so that rounding cannot stop the traversal.
    const std::int32_t x0 = (c >> shift) << shift, y0 = (r >> shift) << shift, side = 1 << shift;
    const double ex = exit(o.x, d.x, x0, x0 + side), ey = exit(o.y, d.y, y0, y0 + side);
    if (std::min(ex, ey) >= end) return std::nullopt;
    t = std::max(t, std::min(ex, ey));
    const bool over_x = ex <= ey, over_y = ey <= ex;
    c = over_x ? (d.x > 0.0 ? x0 + side : x0 - 1)
               : std::clamp(cellAt(o.x + t * d.x, columns - 1), x0, x0 + side - 1);
    r = over_y ? (d.y > 0.0 ? y0 + side : y0 - 1)
               : std::clamp(cellAt(o.y + t * d.y, rows - 1), y0, y0 + side - 1);
    if (c < 0 || r < 0 || c >= columns || r >= rows) return std::nullopt;
  }
  return std::nullopt;
}

}  // namespace fettle::render
