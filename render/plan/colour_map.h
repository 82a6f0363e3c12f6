#pragma once

#include <array>

#include <glm/vec3.hpp>

#include "render/plan/picture.h"

namespace fettle::render {

/// 256 colours, even steps of the value from low to high, in linear light (sRGB primaries).
using ColourTable = std::array<glm::vec3, 256>;

/// The table of a map. kAuto must be resolved first.
///
/// Sources, stated in full in assets/colour_maps: viridis (Smith and van der Walt 2015), cividis (Nunez et
/// al. 2018), diverging (Brewer, ColorBrewer RdBu, turned round, white middle); grey is even in sRGB code
/// values, close to even in perceived lightness.
[[nodiscard]] const ColourTable& colourTable(ColourMap map);

/// The quantity that kAuto depends on. kOneSign: a difference of which all lies on one side of zero.
enum class Quantity { kHeight, kDeviation, kOneSign };
[[nodiscard]] ColourMap resolve(ColourMap map, Quantity quantity) noexcept;

/// The colour of a value between low (first colour) and high (last), interpolated linearly between the
/// table's colours in linear light, as in the shaders.
[[nodiscard]] glm::vec3 mapped(const ColourTable& table, double value, const ValueRange& range) noexcept;

/// The table of a picture whose colours span `range`: that of `colouring`'s map (resolved), in steps and with its
/// middle colour up to the tolerance where `quantity` has one. Between two steps, and at the tolerance, the
/// colour changes within 1/255 of the range.
[[nodiscard]] ColourTable tableOf(const Colouring& colouring, Quantity quantity, const ValueRange& range);

/// IEC 61966-2-1, channel values 0 .. 1.
[[nodiscard]] double linearFromSrgb(double code) noexcept;
[[nodiscard]] double srgbFromLinear(double light) noexcept;

}  // namespace fettle::render
