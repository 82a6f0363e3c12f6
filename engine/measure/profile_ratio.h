#pragma once

#include <span>

namespace fettle::engine {

// The material ratio curve of a profile (ISO 21920-2:2021; ISO 4287:1997, 4.5.1): of the profile that is straight between evenly spaced
// places, by lengths. The material length at a height is the length along which the profile is at it or higher; the ratio is that over
// the whole length.

/// Rmr(c): the material ratio at a height, 0 .. 1. `profile`: heights without NaN, two or more; one unit. Any thread.
[[nodiscard]] double materialRatioAt(std::span<const double> profile, double height) noexcept;

/// Rmc(p), its inverse: the highest height that has at least the ratio p, 0 .. 1: the highest place for 0, the lowest for 1. Exact to 1e-14 of the
/// profile's height. Linear time for each of 48 halvings.
[[nodiscard]] double heightOfRatio(std::span<const double> profile, double ratio) noexcept;

}  // namespace fettle::engine
