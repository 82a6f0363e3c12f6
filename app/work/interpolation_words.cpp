#include "app/work/interpolation_words.h"

namespace fettle::app {

namespace {

constexpr InterpolationWord kInterpolations[] = {
    {engine::Interpolation::kBilinear, "bilinear", "of the four samples around; none next to a hole"},
    {engine::Interpolation::kNearest, "nearest", "of the nearest sample"}};

}  // namespace

std::span<const InterpolationWord> interpolationWords() noexcept {
  return kInterpolations;
}

engine::Interpolation interpolationNamed(std::string_view word) noexcept {
  for (const InterpolationWord& known : kInterpolations)
    if (word == known.word) return known.interpolation;
  return kInterpolations[0].interpolation;
}

const char* interpolationWord(engine::Interpolation interpolation) noexcept {
  for (const InterpolationWord& known : kInterpolations)
    if (known.interpolation == interpolation) return known.word;
  return kInterpolations[0].word;
}

}  // namespace fettle::app
