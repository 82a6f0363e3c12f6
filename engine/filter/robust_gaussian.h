#pragma once

#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include <tbb/enumerable_thread_specific.h>

#include "engine/field/reader.h"
#include "engine/filter/gaussian_regression.h"
#include "engine/filter/pass.h"

namespace fettle::engine {

/// The rounds of the robust Gaussian regression filter over a whole field (FilterKind::kRobustGaussian in filter.h), whose weights
/// FilterKind::kRobustSpline takes as well. Memory: 8 bytes per sample and what GaussianRegression has.
/// Threading: one thread, on all workers of its arena; the same bits for any number of them.
class RobustRegression {
 public:
  RobustRegression(const Version& input, const FilterSpec& spec, CpuLevel level);

  /// All rounds, or what `work`, which may be null, has not kept of them. False when cancelled. Throws std::bad_alloc.
  [[nodiscard]] bool find(FilterWork* work, const JobControl& job);

  /// Row-major, of the whole field; unspecified at holes.
  [[nodiscard]] const float* surface() const noexcept { return surface_.data(); }
  /// The samples' in the last round, 0 to 1, as surface(); null: all 1.
  [[nodiscard]] const float* weights() const noexcept { return weights_.empty() ? nullptr : weights_.data(); }
  /// The plane of weights(), which is null from then on; empty where all are 1.
  [[nodiscard]] std::vector<float> takeWeights() noexcept { return std::move(weights_); }
  [[nodiscard]] std::ptrdiff_t stride() const noexcept { return stride_; }
  [[nodiscard]] double limit() const noexcept { return limit_; }
  /// Samples, no holes, whose weight in the last round was 0.
  [[nodiscard]] std::int64_t weightless() const;

 private:
  bool smooth(const JobControl& job);
  bool weigh(const JobControl& job);
  bool eachBlock(const JobControl& job, const auto& take);

  FieldReader field_;
  GaussianRegression filter_;
  std::ptrdiff_t stride_;
  double limit_ = 0.0;
  std::vector<float> surface_, weights_;
  tbb::enumerable_thread_specific<std::vector<float>> parts_;
};

/// The pass of FilterKind::kRobustGaussian: FilterPass.
[[nodiscard]] Result<PassResult> robustGaussianPass(const Version& input, const Version& original,
                                                    const FilterSpec& spec, const FilterTuning& tuning,
                                                    JobControl& job);

}  // namespace fettle::engine
