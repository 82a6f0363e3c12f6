#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "engine/field/version.h"
#include "haptic/contact/surface.h"

namespace fettle::bench {

/// Heights as the yardsticks of a tick read them: a plain row-major array in the field's unit, copied from a field without holes.
/// Threading: constant after construction; any thread. Throws std::bad_alloc.
struct PlainHeights {
  explicit PlainHeights(const engine::Version& field)
      : width(field.grid().width),
        height(field.grid().height),
        spacing_x_mm(field.grid().spacingXMm()),
        spacing_y_mm(field.grid().spacingYMm()),
        unit_mm(field.grid().height_unit.mm),
        samples(static_cast<std::size_t>(width) * static_cast<std::size_t>(height)) {
    field.reader().readHeights(0, 0, width, height, samples.data(), width);
  }

  /// The surface over a cell that has all four corners, in millimetres.
  [[nodiscard]] haptic::Patch patch(haptic::CellIndex cell) const noexcept {
    const float* z = samples.data() + static_cast<std::ptrdiff_t>(cell.row) * width + cell.column;
    const double a = unit_mm * static_cast<double>(z[0]);
    const double b = unit_mm * static_cast<double>(z[1]) - a;
    const double c = unit_mm * static_cast<double>(z[width]) - a;
    const double d = unit_mm * static_cast<double>(z[width + 1]) - a - b - c;
    return {cell.column * spacing_x_mm, cell.row * spacing_y_mm, spacing_x_mm, spacing_y_mm, a, b, c, d};
  }

  std::int32_t width, height;
  double spacing_x_mm, spacing_y_mm, unit_mm;
  std::vector<float> samples;
};

}  // namespace fettle::bench
