#pragma once

#include <cstdint>
#include <optional>

#include "engine/field/version.h"

namespace fettle::trials {

/// A square of a field without holes, as near to its middle as can be found in steps of half a side: at most
/// `side` samples each way, fewer where the field has fewer. A separate field, beginning at 0, 0. Empty: none
/// without holes. Throws std::bad_alloc.
[[nodiscard]] std::optional<engine::Version> wholeSquare(const engine::Version& field, std::int32_t side);

/// The field grown by a ball of `radius_mm`: H(x, y) = max over |d| <= radius of h((x, y) + d) +
/// sqrt(radius^2 - |d|^2), where the centre of a ball is that rests on the surface. `finer` samples for each
/// of the field's, for surface and ball: H is too low by about (spacing / finer)^2 / (4 radius), the rise of
/// a ball's foot within half such a step, and by more only where the surface is sharper than the ball. Cost:
/// (2 radius / spacing finer)^2 per sample. `field` has cells and no holes. Throws std::bad_alloc.
[[nodiscard]] engine::Version grownByBall(const engine::Version& field, double radius_mm, int finer);

}  // namespace fettle::trials
