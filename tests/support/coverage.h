#pragma once

#include <cmath>
#include <cstdlib>

#include <algorithm>
#include <array>
#include <string>

#include <fmt/format.h>

namespace fettle::tests {

/// Simulated scans in a test of standard errors: FETTLE_TRIALS, else 100 [1 ..]. Under a sanitizer 5, for their paths alone.
[[nodiscard]] inline int coverageSeeds() {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  return 5;
#else
  const char* const typed = std::getenv("FETTLE_TRIALS");
  return typed != nullptr ? std::max(std::atoi(typed), 1) : 100;
#endif
}

/// Whether there are enough of them to count shares.
[[nodiscard]] inline bool countsCoverage() {
  return coverageSeeds() >= 100;
}

/// Three standard deviations of a root mean square of so many Gaussian errors, as a share of it.
[[nodiscard]] inline double scatterOfRms() {
  return 3.0 / std::sqrt(2.0 * coverageSeeds());
}

/// How often the truth lies within one, two and three stated standard errors.
class Coverage {
 public:
  void add(double error, double stated) {
    ++trials_;
    for (int k = 0; k < 3; ++k)
      within_[static_cast<std::size_t>(k)] += std::abs(error) <= (k + 1) * stated ? 1 : 0;
    squares_ += error * error;
    sum_ += stated;
  }

  [[nodiscard]] double rms() const { return std::sqrt(squares_ / trials_); }
  [[nodiscard]] double stated() const { return sum_ / trials_; }
  [[nodiscard]] std::string counts() const {
    return fmt::format("{:4} {:4} {:4} of {}", within_[0], within_[1], within_[2], trials_);
  }

  /// Empty if these are shares of Gaussian errors, but for three standard deviations of such a count: of 1,000 trials 683 +-
  /// 45 (44.1), 954 +- 20 (19.9), at least 991.
  [[nodiscard]] std::string complaint() const {
    constexpr std::array<double, 3> kShares{0.6827, 0.9545, 0.9973};
    for (std::size_t k = 0; k < 3; ++k) {
      const double expected = trials_ * kShares[k];
      // Counts are whole, and 1,000 trials may miss by a hair more, as the bounds above say.
      const double scatter = 3.0 * std::sqrt(expected * (1.0 - kShares[k])) + 1.4;
      if (within_[k] < expected - scatter || (k < 2 && within_[k] > expected + scatter))
        return fmt::format("{}: {} within {} standard errors, expected {:.0f} +- {:.0f}", counts(),
                           within_[k], k + 1, expected, scatter);
    }
    return {};
  }

 private:
  int trials_ = 0;
  std::array<int, 3> within_{};
  double squares_ = 0.0, sum_ = 0.0;
};

}  // namespace fettle::tests
