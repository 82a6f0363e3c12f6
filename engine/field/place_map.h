#pragma once

#include <glm/vec2.hpp>

namespace fettle::engine {

/// Where the samples of a new field lie among those of an old one: old place = first + column * per_column + row * per_row
/// [samples]. per_column and per_row are not parallel.
struct PlaceMap {
  glm::dvec2 first{0.0}, per_column{1.0, 0.0}, per_row{0.0, 1.0};

  [[nodiscard]] glm::dvec2 at(double column, double row) const noexcept {
    return first + column * per_column + row * per_row;
  }
  /// The new place of an old one.
  [[nodiscard]] glm::dvec2 newPlace(const glm::dvec2& old) const noexcept {
    const glm::dvec2 d = old - first;
    const double det = per_column.x * per_row.y - per_column.y * per_row.x;
    return {(d.x * per_row.y - d.y * per_row.x) / det, (per_column.x * d.y - per_column.y * d.x) / det};
  }
};

}  // namespace fettle::engine
