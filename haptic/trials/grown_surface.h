#pragma once

#include <cstdint>
#include <optional>

#include "engine/field/version.h"

namespace fettle::trials {

/// A square of a field without holes, as near to its middle as one can be found by looking at every half
/// side: at most `side` samples each way, fewer where the field has fewer. A field of its own, beginning at
/// 0, 0. Empty: none without holes. Throws std::bad_alloc.
[[nodiscard]] std::optional<engine::Version> wholeSquare(const engine::Version& field, std::int32_t side);

/// The field grown by a ball of `radius_mm`: H(x, y) = max over |d| <= radius of h((x, y) + d) +
/// sqrt(radius^2 - |d|^2), where the centre of a ball is that rests on the surface. `finer` samples for each
/// of the field's, of surface and ball alike: H is too low by about (spacing / finer)^2 / (4 radius), what a
/// ball's foot moves up by within half such a step, and by more only where the surface is sharper than the
/// ball. Cost: (2 radius / spacing finer)^2 a sample. `field` has cells and no holes. Throws std::bad_alloc.
[[nodiscard]] engine::Version grownByBall(const engine::Version& field, double radius_mm, int finer);

}  // namespace fettle::trials
