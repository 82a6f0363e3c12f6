#pragma once

#include <span>
#include <string_view>

#include "engine/measure/section.h"

namespace fettle::app {

/// How heights between samples are found, as options, reports and files say it.
struct InterpolationWord {
  engine::Interpolation interpolation;
  const char* word;  ///< "bilinear"
  const char* text;
};
/// The usual one first.
[[nodiscard]] std::span<const InterpolationWord> interpolationWords() noexcept;

/// What a word means; of another one the usual.
[[nodiscard]] engine::Interpolation interpolationNamed(std::string_view word) noexcept;
[[nodiscard]] const char* interpolationWord(engine::Interpolation interpolation) noexcept;

}  // namespace fettle::app
