#pragma once

#include <memory>

#include "engine/filter/block.h"

namespace fettle::engine {

/// Largest window that makeSmallMedian takes.
inline constexpr int kSmallMedianWindow = 7;

/// Windows of 3, 5 and 7: compares samples, many outputs abreast.
[[nodiscard]] std::unique_ptr<BlockFilter> makeSmallMedian(int window);

/// Any window: a sliding set of ranks.
[[nodiscard]] std::unique_ptr<BlockFilter> makeRankMedian(int window);

/// (a + b) / 2, exact and rounded to float once, ties to even. Both finite.
[[nodiscard]] float midpoint(float a, float b) noexcept;

}  // namespace fettle::engine
