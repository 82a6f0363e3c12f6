#pragma once

namespace fettle::engine {

/// `height` drawn to within `most` of `original`: the float nearest to it for which |float - original| <=
/// most holds in exact arithmetic. On a thread that flushes denormals it holds as well for an `original` that
/// is none, and the float may be one nearer to the original than need be. `height` and `original` finite (an
/// `original` of NaN leaves it as it is), `most` finite and >= 0.
[[nodiscard]] float limitedChange(float height, float original, double most) noexcept;

}  // namespace fettle::engine
