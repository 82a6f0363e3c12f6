#pragma once

#include <cstdint>

namespace fettle::render {

/// Division of a field into the layers of an image array. Page sides are multiples of a tile's, so that no
/// tile lies on two pages.
struct Paging {
  std::uint32_t columns = 64, rows = 64;  ///< of one page [samples]
  std::uint32_t across = 1, up = 1;       ///< pages
  int log2_columns = 0, log2_rows = 0;    ///< when there is more than one page: sides are powers of two then
  [[nodiscard]] std::uint32_t layers() const noexcept { return across * up; }
  [[nodiscard]] bool paged() const noexcept { return layers() > 1; }
};

/// One page when the field fits the image limit `max_side`. Otherwise the largest powers of two that leave at
/// most an eighth of the last page empty, per direction. Both > 0, max_side >= 64.
[[nodiscard]] Paging choosePaging(std::int32_t width, std::int32_t height, std::uint32_t max_side);

}  // namespace fettle::render
