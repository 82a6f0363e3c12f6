#pragma once

#include <deque>
#include <optional>

#include "haptic/loop/timing.h"

namespace fettle::haptic {

/// Lateness of two threads beside each other, for the same time on each of two cores.
struct TimingRound {
  TimingHistogram mine, other;
};

/// Ends of the interval in which a ratio lies with 95 % confidence.
struct Interval {
  double low = 0.0, high = 0.0;
};

/// Of the ratios of the 99th and 99.9th percentiles, mine over the other's.
struct RatioIntervals {
  Interval p99, p999;
};

/// Fewest rounds that say how much they differ.
inline constexpr std::size_t kFewestRounds = 6;

/// A machine has good and bad seconds: wake-ups within one are alike, so that their number says little of how far a
/// percentile is off. Whole rounds are drawn with replacement, as many as there are, again and again, and the middle 95 % of the
/// ratios taken (block bootstrap with percentiles: B. Efron, R. Tibshirani, An Introduction to the Bootstrap, 1993, 13.3). The
/// same rounds give the same intervals. Nothing for fewer than kFewestRounds, or where the other's percentile is 0.
[[nodiscard]] std::optional<RatioIntervals> ratioIntervals(const std::deque<TimingRound>& rounds);

}  // namespace fettle::haptic
