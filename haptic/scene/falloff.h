#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <string_view>

#include "engine/base/rows.h"

namespace fettle::haptic {

/// How the effect of a brush falls from its centre to its rim. A shape is a function of the share of the way, 0 to 1, with the
/// value 1 in the centre. Only additions, products and square roots: the same bits on every machine.
enum class Falloff : std::uint8_t {
  kFlat,    ///< the same everywhere, then nothing
  kSmooth,  ///< without an edge: a cubic, level at both ends
  kSphere,  ///< a ball's cap: full for long, then steep
  kLinear,  ///< a cone
  kSharp,   ///< a cone squared: little but the middle
  kCount
};

struct FalloffRow {
  Falloff falloff;
  std::string_view word;  ///< in scene files
  std::string_view hint;  ///< in the window
  double (*weight)(double way) noexcept;
};

inline constexpr std::array kFalloffRows = {
    FalloffRow{Falloff::kFlat, "flat", "the same up to the rim", [](double) noexcept { return 1.0; }},
    FalloffRow{Falloff::kSmooth, "smooth", "without an edge",
               [](double way) noexcept { return 1.0 - way * way * (3.0 - 2.0 * way); }},
    FalloffRow{Falloff::kSphere, "sphere", "full for long, then steep",
               [](double way) noexcept { return std::sqrt(1.0 - way * way); }},
    FalloffRow{Falloff::kLinear, "linear", "evenly from the middle to the rim",
               [](double way) noexcept { return 1.0 - way; }},
    FalloffRow{Falloff::kSharp, "sharp", "little but the middle",
               [](double way) noexcept { return (1.0 - way) * (1.0 - way); }},
};
static_assert(engine::inOrder(kFalloffRows, &FalloffRow::falloff, Falloff::kCount));

/// The words, in the order of Falloff.
inline constexpr auto kFalloffWords = [] {
  std::array<std::string_view, kFalloffRows.size()> words;
  for (std::size_t i = 0; i < words.size(); ++i) words[i] = kFalloffRows[i].word;
  return words;
}();

[[nodiscard]] constexpr const FalloffRow& rowOf(Falloff falloff) noexcept {
  return kFalloffRows[static_cast<std::size_t>(falloff)];
}

}  // namespace fettle::haptic
