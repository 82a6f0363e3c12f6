#pragma once

#include <cstdint>
#include <span>

namespace fettle::render {

/// DejaVu Sans and DejaVu Sans Bold 2.37 (Bitstream Vera licence, free to embed) as TrueType files, embedded
/// from fonts-dejavu-core at build time: nothing is searched at run time.
[[nodiscard]] std::span<const std::uint8_t> regularFont() noexcept;
[[nodiscard]] std::span<const std::uint8_t> boldFont() noexcept;

}  // namespace fettle::render
