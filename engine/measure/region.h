#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>

#include <tl/expected.hpp>

#include "engine/base/error.h"
#include "engine/field/reader.h"
#include "engine/field/sample_rect.h"

namespace fettle::engine {

/// The samples that a form is fitted to, or that a parameter is taken over. Holes belong to none.
enum class Region : std::uint8_t {
  kAll,
  kMarked,
  kUnmarked,
};

/// "all", "marked", "unmarked".
[[nodiscard]] std::string_view wordOf(Region region) noexcept;
/// Nothing for another word.
[[nodiscard]] std::optional<Region> regionNamed(std::string_view word) noexcept;

/// Whether a sample with a height is in the region. Tiles are read until one has such a sample: all with marks, where only
/// holes are marked. Any thread; no allocation.
[[nodiscard]] bool anyIn(const FieldReader& field, Region region) noexcept;

/// The error (kInput) of a region that no sample with a height is in: it says of a region of marks that nothing, or everything,
/// is marked, and what to do.
[[nodiscard]] tl::unexpected<Error> nothingIn(Region region, std::string_view where);

/// As FieldReader::readHeights, with NaN where a sample is not in the region. The rectangle may reach over the field's
/// border; it has at most (kTileSide + 1) x (kTileSide + 1) samples. Any thread; no allocation.
void readRegion(const FieldReader& field, Region region, const SampleRect& rect, float* out,
                std::ptrdiff_t stride) noexcept;

}  // namespace fettle::engine
