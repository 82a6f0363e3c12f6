#include "haptic/loop/ratio_interval.h"

#include <algorithm>
#include <memory>
#include <random>
#include <vector>

namespace fettle::haptic {

namespace {

constexpr std::size_t kDraws = 1000;
constexpr double kOutside = 0.025;  // at each end

Interval middleOf(std::vector<double>& ratios) {
  std::sort(ratios.begin(), ratios.end());
  const auto cut = static_cast<std::size_t>(kOutside * static_cast<double>(ratios.size()));
  return {ratios[cut], ratios[ratios.size() - 1 - cut]};
}

}  // namespace

std::optional<RatioIntervals> ratioIntervals(const std::deque<TimingRound>& rounds) {
  if (rounds.size() < kFewestRounds) return std::nullopt;
  std::mt19937_64 random(1);  // any seed: the same one for the same figures
  std::uniform_int_distribution<std::size_t> any(0, rounds.size() - 1);
  std::vector<double> p99, p999;
  for (std::size_t draw = 0; draw < kDraws; ++draw) {
    const auto drawn = std::make_unique<TimingRound>();
    for (std::size_t i = 0; i < rounds.size(); ++i) {
      const TimingRound& round = rounds[any(random)];
      drawn->mine.add(round.mine);
      drawn->other.add(round.other);
    }
    const TimingFigures mine = drawn->mine.figures(), other = drawn->other.figures();
    if (other.p99_ns <= 0) return std::nullopt;
    p99.push_back(static_cast<double>(mine.p99_ns) / static_cast<double>(other.p99_ns));
    p999.push_back(static_cast<double>(mine.p999_ns) / static_cast<double>(other.p999_ns));
  }
  return RatioIntervals{middleOf(p99), middleOf(p999)};
}

}  // namespace fettle::haptic
