#include "app/work/lasso.h"

#include <algorithm>
#include <cmath>

#include <glm/geometric.hpp>

namespace fettle::app {

constexpr double kPiece_px = 8.0;     // of a straight side, between two points located on the surface
constexpr double kApart_px = 2.0;     // between corners of a line drawn by hand
constexpr double kSmallest_px = 3.0;  // across: less is a click

namespace {

// The height of the surface where it was seen nearest along a closed line; nothing where it was never seen.
std::optional<double> heightBeside(const std::vector<std::optional<glm::dvec3>>& seen, std::size_t at) {
  const std::size_t count = seen.size();
  for (std::size_t off = 1; 2 * off <= count; ++off)
    for (const std::size_t beside : {(at + off) % count, (at + count - off) % count})
      if (seen[beside]) return seen[beside]->z;
  return std::nullopt;
}

}  // namespace

void Lasso::begin(Shape shape, const glm::dvec2& cross) {
  active_ = true;
  shape_ = shape;
  cross_ = cross;
  corners_.clear();
}

bool Lasso::set() {
  if (!corners_.empty() && glm::distance(corners_.back(), cross_) < kApart_px) return false;
  corners_.push_back(cross_);
  return shape_ == Shape::kBox && corners_.size() == 2;
}

void Lasso::move(const glm::dvec2& cross, Drawing drawing) {
  cross_ = cross;
  if (drawing == Drawing::kYes && shape_ == Shape::kFree &&
      (corners_.empty() || glm::distance(corners_.back(), cross_) >= kApart_px))
    corners_.push_back(cross_);
}

bool Lasso::takeBack() {
  if (corners_.empty()) return false;
  corners_.pop_back();
  return true;
}

std::vector<glm::dvec2> Lasso::line() const {
  std::vector<glm::dvec2> line = corners_;
  if (line.empty()) return line;
  if (shape_ == Shape::kFree) {
    if (glm::distance(line.back(), cross_) >= kApart_px) line.push_back(cross_);
    return line;
  }
  const glm::dvec2 a = line.front(), b = line.size() > 1 ? line[1] : cross_;
  return {a, {b.x, a.y}, b, {a.x, b.y}};
}

bool Lasso::closes() const {
  const std::vector<glm::dvec2> points = line();
  if (points.size() < 3) return false;
  glm::dvec2 low = points.front(), high = low;
  for (const glm::dvec2& p : points) low = glm::min(low, p), high = glm::max(high, p);
  return high.x - low.x >= kSmallest_px && high.y - low.y >= kSmallest_px;
}

engine::Polygon Lasso::finish(const engine::Grid& grid, const Places& places) {
  const std::vector<glm::dvec2> corners = line();
  active_ = false;
  std::vector<glm::dvec2> pixels;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const glm::dvec2 from = corners[i], to = corners[(i + 1) % corners.size()];
    const int pieces = std::max(1, static_cast<int>(std::ceil(glm::distance(from, to) / kPiece_px)));
    for (int k = 0; k < pieces; ++k) pixels.push_back(from + (to - from) * (static_cast<double>(k) / pieces));
  }
  std::vector<std::optional<glm::dvec3>> seen;
  seen.reserve(pixels.size());
  for (const glm::dvec2& pixel : pixels) seen.push_back(places.on_surface(pixel));
  std::vector<glm::dvec2> samples;
  const glm::dvec2 spacing{grid.spacingXMm(), grid.spacingYMm()};
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    const std::optional<glm::dvec2> place =
        seen[i] ? std::optional(glm::dvec2(*seen[i])) : places.on_level(pixels[i], heightBeside(seen, i));
    if (place) samples.push_back(*place / spacing);
  }
  return engine::Polygon(samples);
}

}  // namespace fettle::app
