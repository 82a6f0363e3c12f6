#pragma once

#include <cstdint>
#include <random>
#include <vector>

#include "engine/field/version.h"
#include "engine/uncertainty/noise_trial.h"

namespace fettle::engine {

/// The highest heights of a surface, or the lowest, as noise may make the highest of any of them: how many there are in each tenth of the
/// noise's standard deviation, ten of these down.
class ExtremeTail {
 public:
  enum class End : std::uint8_t { kHighest, kLowest };

  /// `sigma` > 0 [height_unit]. One look at the samples of tiles that reach so far. Thread: any.
  ExtremeTail(const Version& surface, End end, double sigma);

  /// By how much the extreme moves outwards with white noise of that size, and with its opposite [height_unit]: that of n
  /// samples of a class is drawn from the distribution of the greatest of n. Nothing without a sample: 0, 0.
  [[nodiscard]] TrialPair drawn(std::mt19937_64& random) const;

 private:
  struct HeightClass {
    std::int64_t count = 0;
    double sum = 0.0;  // of distances from the extreme [sigma]
  };
  std::vector<HeightClass> classes_;
  double sigma_;
};

}  // namespace fettle::engine
