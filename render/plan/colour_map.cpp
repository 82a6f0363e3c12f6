#include "render/plan/colour_map.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <span>

#include "colour_map_data.h"  // generated from assets/colour_maps

namespace fettle::render {
namespace {

glm::vec3 linear(const std::array<float, 3>& code) {
  return {linearFromSrgb(code[0]), linearFromSrgb(code[1]), linearFromSrgb(code[2])};
}

// Tables with fewer steps are interpolated linearly in code values.
ColourTable tableOf(std::span<const std::array<float, 3>> steps) {
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
  static const ColourTable viridis = tableOf(data::kViridis);
  static const ColourTable cividis = tableOf(data::kCividis);
  static const ColourTable diverging = tableOf(data::kDiverging);
  // Begins at dark grey, so that shading can darken the lowest heights too.
  static constexpr std::array<std::array<float, 3>, 2> kGreyEnds{{{0.2F, 0.2F, 0.2F}, {1.0F, 1.0F, 1.0F}}};
  static const ColourTable grey = tableOf(kGreyEnds);
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

glm::vec3 mapped(const ColourTable& table, double value, const ValueRange& range) noexcept {
  const double t = std::clamp((value - range.low) / (range.high - range.low), 0.0, 1.0) * 255.0;
  const std::size_t i = std::min(static_cast<std::size_t>(t), table.size() - 2);
  const auto f = static_cast<float>(t - static_cast<double>(i));
  return table[i] * (1.0F - f) + table[i + 1] * f;
}

}  // namespace fettle::render
