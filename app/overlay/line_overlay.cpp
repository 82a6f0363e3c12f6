#include "app/overlay/line_overlay.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

namespace fettle::app {

namespace {

// Of the highest of the samples around a position [mm]; nothing where none of them has a height.
std::optional<double> heightAbove(const engine::FieldReader& reader, glm::dvec2 at) {
  const engine::Grid& grid = reader.grid();
  const auto clamped = [](double v, std::int32_t side) {
    return static_cast<std::int32_t>(std::clamp(v, 0.0, side - 1.0));
  };
  double height = -std::numeric_limits<double>::infinity();
  for (const double dr : {-1.0, 0.0, 1.0, 2.0})
    for (const double dc : {-1.0, 0.0, 1.0, 2.0}) {
      const float z = reader.heightAt(clamped(std::floor(at.x + dc), grid.width),
                                      clamped(std::floor(at.y + dr), grid.height));
      if (z > height) height = static_cast<double>(z);
    }
  if (!std::isfinite(height)) return std::nullopt;
  return height * grid.height_unit.mm;
}

glm::dvec3 placeAt(const engine::Grid& grid, glm::dvec2 at, double height_mm) {
  return {at.x * grid.spacingXMm(), at.y * grid.spacingYMm(), height_mm};
}

}  // namespace

glm::dvec3 aboveSurface(const engine::FieldReader& reader, glm::dvec2 at) {
  return placeAt(reader.grid(), at, heightAbove(reader, at).value_or(0.0));
}

std::optional<glm::dvec3> aboveSamples(const engine::FieldReader& reader, glm::dvec2 at) {
  const std::optional<double> height_mm = heightAbove(reader, at);
  return height_mm ? std::optional(placeAt(reader.grid(), at, *height_mm)) : std::nullopt;
}

glm::dvec3 middleOnSurface(const engine::FieldReader& reader, glm::dvec2 low, glm::dvec2 high) {
  const glm::dvec2 middle = 0.5 * (low + high);
  if (const auto above = aboveSamples(reader, middle)) return *above;
  constexpr int kSteps = 32;
  const engine::Grid& grid = reader.grid();
  double nearest = std::numeric_limits<double>::infinity();
  const engine::HeightBounds bounds = reader.bounds();
  double height =
      bounds.empty() ? 0.0 : 0.5 * (static_cast<double>(bounds.min) + static_cast<double>(bounds.max));
  for (int r = 0; r <= kSteps; ++r)
    for (int c = 0; c <= kSteps; ++c) {
      const glm::dvec2 at = glm::mix(low, high, glm::dvec2(c, r) / static_cast<double>(kSteps));
      if (!(at.x >= 0.0 && at.y >= 0.0 && at.x < grid.width && at.y < grid.height)) continue;
      const float z = reader.heightAt(static_cast<std::int32_t>(at.x), static_cast<std::int32_t>(at.y));
      const glm::dvec2 off = (at - middle) * glm::dvec2(grid.spacingXMm(), grid.spacingYMm());
      const double distance = glm::dot(off, off);
      if (std::isnan(z) || distance >= nearest) continue;
      nearest = distance;
      height = static_cast<double>(z);
    }
  return placeAt(grid, middle, height * grid.height_unit.mm);
}

void addMeaning(const render::LineMeaning& meaning, std::vector<render::LineMeaning>& meanings) {
  if (std::ranges::find(meanings, meaning) == meanings.end()) meanings.push_back(meaning);
}

namespace {

using engine::EdgeLine;
using engine::EdgePoint;

constexpr double kPiece_px = 3.0;
constexpr double kBand = 2.0;  // standard deviations to either side
constexpr float kLine_px = 2.0F, kChosen_px = 4.0F;
constexpr float kWidest_px = 64.0F;
constexpr render::LineMeaning kStep{{1.0F, 0.35F, 0.02F}, "edge line: a step"},
    kCrease{{0.1F, 0.5F, 1.0F}, "a crease"}, kUnlocated{{0.35F, 0.35F, 0.35F}, "no edge found, as drawn"},
    kChosen{{1.0F, 1.0F, 0.25F}, "the chosen line"};

const render::LineMeaning& meaningOf(const EdgePoint& point, bool chosen) {
  return chosen                                    ? kChosen
         : !point.located                          ? kUnlocated
         : point.kind == engine::LineKind::kCrease ? kCrease
                                                   : kStep;
}

}  // namespace

void LineOverlay::append(const engine::Version& field, std::optional<std::int64_t> chosen,
                         double mm_per_pixel, render::Overlays& overlays) {
  if (field.lines() == nullptr) {
    of_ = {};
    return;
  }
  const engine::Grid& grid = field.grid();
  const double sample_mm = std::max(grid.spacingXMm(), grid.spacingYMm());
  const double across_mm = std::sqrt(grid.spacingXMm() * grid.spacingYMm());
  const int stride = static_cast<int>(std::clamp(kPiece_px * mm_per_pixel / sample_mm, 1.0, 1e6));
  const engine::FieldReader reader = field.reader();
  if (of_.empty() || !(field == of_) || chosen != chosen_ || stride != stride_ ||
      mm_per_pixel != mm_per_pixel_) {
    of_ = field;
    chosen_ = chosen;
    stride_ = stride;
    mm_per_pixel_ = mm_per_pixel;
    pieces_.clear();
    meanings_.clear();
    for (const EdgeLine& line : *field.lines()) {
      const std::size_t points = line.points.size();
      // Over a hole a line goes on at the height it had, or will have.
      std::optional<double> height;
      for (std::size_t i = 0; i < points && !height; ++i)
        height = heightAbove(reader, line.points[i].position);
      if (!height) continue;
      const bool is_chosen = chosen == line.id;
      const std::size_t end = line.closed ? points : points - std::min<std::size_t>(points, 1);
      for (std::size_t i = 0; i < end; i += static_cast<std::size_t>(stride)) {
        const std::size_t to = std::min(i + static_cast<std::size_t>(stride), end);
        const EdgePoint &a = line.points[i], &b = line.points[to % points];
        render::OverlayLine piece;
        const auto placeOf = [&](const EdgePoint& point) {
          if (const auto above = heightAbove(reader, point.position)) height = above;
          return placeAt(grid, point.position, *height);
        };
        piece.from_mm = placeOf(a);
        piece.to_mm = placeOf(b);
        piece.depth = render::OverlayLine::Depth::kInScene;
        if (a.located) {
          render::OverlayLine band = piece;
          const double width_px = 2.0 * kBand * a.deviation * across_mm / mm_per_pixel;
          band.width_px = std::min(static_cast<float>(width_px), kWidest_px);
          band.opacity = 0.3F;
          band.colour = meaningOf(a, false).colour;
          if (band.width_px > kLine_px) pieces_.push_back(band);
        }
        piece.width_px = is_chosen ? kChosen_px : kLine_px;
        const render::LineMeaning& meaning = meaningOf(a, is_chosen);
        addMeaning(meaning, meanings_);
        piece.colour = meaning.colour;
        pieces_.push_back(piece);
      }
    }
  }
  overlays.lines.insert(overlays.lines.end(), pieces_.begin(), pieces_.end());
  for (const render::LineMeaning& meaning : meanings_) addMeaning(meaning, overlays.meanings);
}

}  // namespace fettle::app
