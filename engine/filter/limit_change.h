#pragma once

namespace fettle::engine {

/// `height` drawn to within `most` of `original`: the float nearest to it for which |float - original| <=
/// most holds in exact arithmetic. `height` and `original` finite (an `original` of NaN leaves it as it is),
/// `most` finite and >= 0.
[[nodiscard]] float limitedChange(float height, float original, double most) noexcept;

}  // namespace fettle::engine
