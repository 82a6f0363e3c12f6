#include "engine/io/mesh/surface_mesh.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace fettle::engine {

constexpr std::int64_t kBlock = SurfaceMesh::kBlock;
constexpr float kNever = std::numeric_limits<float>::infinity();

Result<SurfaceMesh> SurfaceMesh::create(const Version& field, std::optional<double> max_error,
                                        JobControl& job) {
  SurfaceMesh mesh;
  const Grid& grid = field.grid();
  mesh.width_ = grid.width;
  mesh.height_ = grid.height;
  mesh.max_error_ = max_error;
  mesh.heights_.resize(static_cast<std::size_t>(grid.samples()));
  field.reader().readHeights(0, 0, grid.width, grid.height, mesh.heights_.data(), grid.width);
  if (max_error) {
    if (Status status = mesh.measureAll(job); !status) return tl::unexpected(status.error());
    float largest = 0.0F;
    mesh.walk([](const Triangle&) {}, &largest);
    mesh.error_ = largest;
  }
  return mesh;
}

// Largest distance in height of the samples in a triangle from its plane; infinite where one is a hole or the
// triangle reaches past the field. a, b: ends of the longest side; it or the legs run along the axes.
float SurfaceMesh::deviation(Point a, Point b, Point apex) const {
  if (!inside(a) || !inside(b) || !inside(apex)) return kNever;
  const double za = heights_[at(a)], zb = heights_[at(b)], zc = heights_[at(apex)];
  const auto determinant = static_cast<double>((b.x - a.x) * (apex.y - a.y) - (apex.x - a.x) * (b.y - a.y));
  const double slope_x =
      ((zb - za) * static_cast<double>(apex.y - a.y) - (zc - za) * static_cast<double>(b.y - a.y)) /
      determinant;
  const double slope_y =
      ((zc - za) * static_cast<double>(b.x - a.x) - (zb - za) * static_cast<double>(apex.x - a.x)) /
      determinant;
  // Rows between the lowest and the highest corner; each side limits the columns.
  const std::int64_t low = std::min({a.y, b.y, apex.y}), high = std::max({a.y, b.y, apex.y});
  double worst = 0.0;
  for (std::int64_t y = low; y <= high; ++y) {
    std::int64_t left = std::numeric_limits<std::int64_t>::max(), right = -1;
    const std::array<std::pair<Point, Point>, 3> sides{{{a, b}, {b, apex}, {apex, a}}};
    for (const auto& [p, q] : sides) {
      if (y < std::min(p.y, q.y) || y > std::max(p.y, q.y)) continue;
      // Sides are horizontal, vertical or diagonal: columns are whole numbers.
      const std::int64_t from = p.y == q.y ? std::min(p.x, q.x) : p.x + (q.x - p.x) * (y - p.y) / (q.y - p.y);
      const std::int64_t to = p.y == q.y ? std::max(p.x, q.x) : from;
      left = std::min(left, from);
      right = std::max(right, to);
    }
    for (std::int64_t x = left; x <= right; ++x) {
      const double off = std::abs(heights_[at({x, y})] - (za + slope_x * static_cast<double>(x - a.x) +
                                                          slope_y * static_cast<double>(y - a.y)));
      if (!(off <= worst)) {
        if (std::isnan(off)) return kNever;
        worst = off;
      }
    }
  }
  // Rounded up, so that the float is still a bound.
  return std::nextafter(static_cast<float>(worst), worst == 0.0 ? 0.0F : kNever);
}

// The two triangles whose longest side runs from middle - (dx, dy) to middle + (dx, dy), with those below.
void SurfaceMesh::measure(Point m, std::int64_t dx, std::int64_t dy, std::int64_t child) {
  const Point a{m.x - dx, m.y - dy}, b{m.x + dx, m.y + dy};
  float worst = 0.0F;
  for (const int side : {-1, 1}) {
    const Point apex{m.x - side * dy, m.y + side * dx};
    // On the field's border the triangle beyond is completely outside: no samples to compare with.
    const bool beyond = (dx == 0 && (apex.x < 0 || apex.x >= width_) && (m.x == 0 || m.x == width_ - 1)) ||
                        (dy == 0 && (apex.y < 0 || apex.y >= height_) && (m.y == 0 || m.y == height_ - 1));
    if (beyond && inside(a) && inside(b)) continue;
    worst = std::max(worst, deviation(a, b, apex));
  }
  // Middles of the legs.
  const std::array<Point, 4> below = dx != 0 && dy != 0 ? std::array<Point, 4>{{{m.x - child, m.y},
                                                                                {m.x + child, m.y},
                                                                                {m.x, m.y - child},
                                                                                {m.x, m.y + child}}}
                                                        : std::array<Point, 4>{{{m.x - child, m.y - child},
                                                                                {m.x + child, m.y - child},
                                                                                {m.x - child, m.y + child},
                                                                                {m.x + child, m.y + child}}};
  if (child > 0)
    for (const Point p : below)
      if (inside(p)) worst = std::max(worst, errors_[at(p)]);
  errors_[at(m)] = worst;
}

Status SurfaceMesh::measureAll(JobControl& job) {
  errors_.assign(heights_.size(), 0.0F);
  job.begin("decimating", 16);
  for (std::int64_t s = 1; s < kBlock; s *= 2) {
    // Longest side along an axis: (odd, even) and (even, odd) in steps of s. The middles of its legs are half
    // a step away, none at s = 1.
    for (std::int64_t y = 0; y < height_; y += s) {
      const bool along_x = y / s % 2 == 0;
      for (std::int64_t x = along_x ? s : 0; x < width_; x += 2 * s)
        measure({x, y}, along_x ? s : 0, along_x ? 0 : s, s / 2);
      if (job.cancelled()) return cancelled();
    }
    job.advance();
    // Along a diagonal: (odd, odd). The diagonal joins the corners whose coordinates in steps of 2 s have an
    // even sum.
    for (std::int64_t y = s; y < height_; y += 2 * s) {
      for (std::int64_t x = s; x < width_; x += 2 * s)
        measure({x, y}, s, (x / s / 2 + y / s / 2) % 2 == 0 ? s : -s, s);
      if (job.cancelled()) return cancelled();
    }
    job.advance();
  }
  return {};
}

void SurfaceMesh::split(Point a, Point b, Point apex, const std::function<void(const Triangle&)>& use,
                        float* largest) const {
  const Point m{(a.x + b.x) / 2, (a.y + b.y) / 2};
  const bool smallest = std::abs(a.x - b.x) + std::abs(a.y - b.y) == 2 && a.x != b.x && a.y != b.y;
  if (!smallest) {
    // A triangle outside the field or across the border is divided further; its middle has no error of its
    // own.
    const float error = inside(m) ? errors_[at(m)] : kNever;
    const bool all = inside(a) && inside(b) && inside(apex);
    if (!all || !(error <= *max_error_)) {
      // Triangles completely outside are left out.
      if (std::min({a.x, b.x, apex.x}) >= width_ - 1 || std::min({a.y, b.y, apex.y}) >= height_ - 1) return;
      split(apex, a, m, use, largest);
      split(b, apex, m, use, largest);
      return;
    }
    if (largest != nullptr) *largest = std::max(*largest, error);
  } else {
    // Half a cell: the whole cell must be measured.
    const std::int64_t left = std::min(a.x, b.x), low = std::min(a.y, b.y);
    for (const Point corner :
         {Point{left, low}, Point{left + 1, low}, Point{left, low + 1}, Point{left + 1, low + 1}})
      if (!inside(corner) || std::isnan(heights_[at(corner)])) return;
  }
  use({at(a), at(b), at(apex)});
}

void SurfaceMesh::walk(const std::function<void(const Triangle&)>& use, float* largest) const {
  for (std::int64_t y = 0; y + 1 < height_; y += kBlock)
    for (std::int64_t x = 0; x + 1 < width_; x += kBlock) {
      const Point p{x, y}, q{x + kBlock, y}, r{x + kBlock, y + kBlock}, s{x, y + kBlock};
      if ((x / kBlock + y / kBlock) % 2 == 0) {
        split(r, p, q, use, largest);
        split(p, r, s, use, largest);
      } else {
        split(q, s, p, use, largest);
        split(s, q, r, use, largest);
      }
    }
}

void SurfaceMesh::forEach(const std::function<void(const Triangle&)>& use) const {
  if (max_error_) {
    walk(use, nullptr);
    return;
  }
  for (std::int64_t y = 0; y + 1 < height_; ++y)
    for (std::int64_t x = 0; x + 1 < width_; ++x) {
      const std::uint64_t p = at({x, y}), q = p + 1, s = p + static_cast<std::uint64_t>(width_), r = s + 1;
      if (std::isnan(heights_[p]) || std::isnan(heights_[q]) || std::isnan(heights_[r]) ||
          std::isnan(heights_[s]))
        continue;
      use({p, q, r});
      use({p, r, s});
    }
}

}  // namespace fettle::engine
