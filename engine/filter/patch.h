#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "engine/field/sample_rect.h"

namespace fettle::engine {

/// Values of a rectangle of a field, row-major; rows may be read and written for 16 elements beyond their end.
template <class T>
struct Patch {
  SampleRect rect{};
  std::ptrdiff_t stride = 0;
  std::vector<T> values;

  /// For these samples, with unspecified values. Throws std::bad_alloc.
  void resize(const SampleRect& to) {
    rect = to;
    stride = (to.columns + 31) / 16 * 16;
    values.resize(static_cast<std::size_t>(stride) * static_cast<std::size_t>(to.rows) + 16);
  }
  /// The row of the field with this number, from the rectangle's first column on.
  [[nodiscard]] T* row(std::int32_t r) noexcept { return values.data() + (r - rect.row) * stride; }
  [[nodiscard]] const T* row(std::int32_t r) const noexcept {
    return values.data() + (r - rect.row) * stride;
  }
};

}  // namespace fettle::engine
