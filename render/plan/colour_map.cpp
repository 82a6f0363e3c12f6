#include "render/plan/colour_map.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <span>

#include "render/config.h"

#include "colour_map_data.h"  // generated from assets/colour_maps

namespace fettle::render {
namespace {

// A deviation just beyond the tolerance, as a share of the way from the middle colour to the end's.
constexpr double kBeyondTolerance = 0.3;
// Steps of one colour on each side beyond a tolerance.
constexpr double kStepsBeyond = 0.5 * kColourSteps - 1.0;

glm::vec3 linear(const std::array<float, 3>& code) {
  return {linearFromSrgb(code[0]), linearFromSrgb(code[1]), linearFromSrgb(code[2])};
}

// Tables with fewer steps are interpolated linearly in code values.
ColourTable evenly(std::span<const std::array<float, 3>> steps) {
  ColourTable table;
  for (std::size_t i = 0; i < table.size(); ++i) {
    const double at = static_cast<double>(i) / 255.0 * static_cast<double>(steps.size() - 1);
    const std::size_t k = std::min(static_cast<std::size_t>(at), steps.size() - 2);
    const double t = at - static_cast<double>(k);
    std::array<float, 3> code{};
    for (std::size_t c = 0; c < 3; ++c)
      code[c] = static_cast<float>(steps[k][c] * (1.0 - t) + steps[k + 1][c] * t);
    table[i] = linear(code);
  }
  return table;
}

}  // namespace

double linearFromSrgb(double code) noexcept {
  return code <= 0.04045 ? code / 12.92 : std::pow((code + 0.055) / 1.055, 2.4);
}

double srgbFromLinear(double light) noexcept {
  return light <= 0.0031308 ? light * 12.92 : 1.055 * std::pow(light, 1.0 / 2.4) - 0.055;
}

const ColourTable& colourTable(ColourMap map) {
  static const ColourTable viridis = evenly(data::kViridis);
  static const ColourTable cividis = evenly(data::kCividis);
  static const ColourTable diverging = evenly(data::kDiverging);
  // Begins at dark grey, so that shading can darken the lowest heights too.
  static constexpr std::array<std::array<float, 3>, 2> kGreyEnds{{{0.2F, 0.2F, 0.2F}, {1.0F, 1.0F, 1.0F}}};
  static const ColourTable grey = evenly(kGreyEnds);
  switch (map) {
    case ColourMap::kAuto:
      assert(false && "resolve() first");
      break;
    case ColourMap::kViridis:
      return viridis;
    case ColourMap::kCividis:
      return cividis;
    case ColourMap::kGrey:
      return grey;
    case ColourMap::kDiverging:
      return diverging;
  }
  return viridis;
}

ColourMap resolve(ColourMap map, Quantity quantity) noexcept {
  if (map != ColourMap::kAuto) return map;
  return quantity == Quantity::kDeviation ? ColourMap::kDiverging : ColourMap::kViridis;
}

ColourTable tableOf(const Colouring& colouring, Quantity quantity, const ValueRange& range) {
  const ColourTable& map = colourTable(resolve(colouring.map, quantity));
  const double limit = 0.5 * (range.high - range.low);
  const double tolerance =
      quantity == Quantity::kDeviation ? std::min(colouring.tolerance / limit, 1.0) : 0.0;
  if (!colouring.steps && !(tolerance > 0.0)) return map;
  ColourTable table;
  // Zero lies between two entries: what did not change has the middle colour however small the tolerance is.
  const double around_zero = 1.5 / static_cast<double>(table.size() - 1);
  for (std::size_t k = 0; k < table.size(); ++k) {
    // Of the range's half: -1 .. 1.
    double at = 2.0 * static_cast<double>(k) / static_cast<double>(table.size() - 1) - 1.0;
    if (quantity == Quantity::kDeviation && std::abs(at) <= std::max(tolerance, around_zero)) {
      at = 0.0;
    } else if (tolerance > 0.0) {
      double beyond = (std::abs(at) - tolerance) / std::max(1.0 - tolerance, 1e-9);
      if (colouring.steps)
        beyond =
            (std::clamp(std::floor(kStepsBeyond * beyond), 0.0, kStepsBeyond - 1.0) + 0.5) / kStepsBeyond;
      at = std::copysign(kBeyondTolerance + (1.0 - kBeyondTolerance) * beyond, at);
    } else if (colouring.steps) {
      constexpr double kHalf = 0.5 * kColourSteps;
      at = (std::clamp(std::floor(at * kHalf), -kHalf, kHalf - 1.0) + 0.5) / kHalf;
    }
    table[k] = mapped(map, at, {-1.0, 1.0});
  }
  return table;
}

glm::vec3 mapped(const ColourTable& table, double value, const ValueRange& range) noexcept {
  const double t = std::clamp((value - range.low) / (range.high - range.low), 0.0, 1.0) * 255.0;
  const std::size_t i = std::min(static_cast<std::size_t>(t), table.size() - 2);
  const auto f = static_cast<float>(t - static_cast<double>(i));
  return table[i] * (1.0F - f) + table[i + 1] * f;
}

}  // namespace fettle::render
