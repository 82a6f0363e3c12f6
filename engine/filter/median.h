#pragma once

#include <memory>

#include "engine/filter/block.h"

namespace fettle::engine {

/// kMedian: the faster of the two below.
[[nodiscard]] std::unique_ptr<BlockFilter> makeMedianFilter(const FilterSpec& spec, CpuLevel level);

/// Largest window that makeSmallMedian takes.
inline constexpr int kSmallMedianWindow = 11;

/// Windows of 3 to 11: compares samples, one output in each vector lane.
[[nodiscard]] std::unique_ptr<BlockFilter> makeSmallMedian(int window, CpuLevel level);

/// Any window from 3 on: sets of ranks that windows share.
[[nodiscard]] std::unique_ptr<BlockFilter> makeRankMedian(int window, CpuLevel level);

/// (a + b) / 2, exact and rounded to float once, ties to even. Both finite.
[[nodiscard]] float midpoint(float a, float b) noexcept;

}  // namespace fettle::engine
