// The robust Gaussian regression filter of second order, ISO 16610-71:2014, as J. Seewig has it (Linear and robust Gaussian regression
// filters, 2005): in each round every sample is weighted by Tukey's biweight of its distance from the surface of the round before, which
// ends at 4.4478 medians of all distances. That the bend of the surface itself is no outlier is ours (kRobustBend). The text of
// the standard was not at hand.

#include "engine/filter/robust_gaussian.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <optional>
#include <vector>

#include <tbb/parallel_for.h>

#include "engine/field/tile.h"
#include "engine/filter/filter_work.h"
#include "engine/filter/middle_distance.h"
#include "engine/filter/robust_weights.h"
#include "engine/filter/surface_pass.h"

namespace fettle::engine {

RobustRegression::RobustRegression(const Version& input, const FilterSpec& spec, CpuLevel level)
    : field_(input.reader()),
      filter_(field_, spec.nesting_mm, level),
      stride_((field_.width() + 31) / 16 * 16),
      surface_(static_cast<std::size_t>(stride_) * static_cast<std::size_t>(field_.height()) + 16) {}

// take(rect, heights, stride) for blocks of what the filter makes of all that it was prepared with.
bool RobustRegression::eachBlock(const JobControl& job, const auto& take) {
  constexpr std::int32_t kSide = 2 * kTileSide;
  const std::int32_t across = (field_.width() + kSide - 1) / kSide,
                     down = (field_.height() + kSide - 1) / kSide;
  tbb::parallel_for(std::int64_t{0}, std::int64_t{across} * down, [&](std::int64_t i) {
    if (job.cancelled()) return;
    const auto column = static_cast<std::int32_t>(i % across) * kSide;
    const auto row = static_cast<std::int32_t>(i / across) * kSide;
    const SampleRect rect{column, row, std::min(kSide, field_.width() - column),
                          std::min(kSide, field_.height() - row)};
    std::vector<float>& part = parts_.local();
    part.resize(static_cast<std::size_t>(kSide) * kSide + 16);
    if (filter_.fill(rect, part.data(), kSide, job)) take(rect, part.data(), std::ptrdiff_t{kSide});
  });
  return !job.cancelled();
}

// The surface: that of the weights of the last weigh(), or of weights that are all 1. False when cancelled.
bool RobustRegression::smooth(const JobControl& job) {
  return filter_.prepare({weights(), nullptr, stride_}, job) &&
         eachBlock(job, [&](const SampleRect& rect, const float* z, std::ptrdiff_t stride) {
           for (std::int32_t r = 0; r < rect.rows; ++r) {
             float* const to = surface_.data() + (rect.row + r) * stride_ + rect.column;
             // Where no sample of the window has weight the surface of the round before stays.
             for (std::int32_t c = 0; c < rect.columns; ++c)
               if (const float height = z[r * stride + c]; height == height) to[c] = height;
           }
         });
}

// Weights of the next round, from the surface's distances and its bend. False when cancelled.
bool RobustRegression::weigh(const JobControl& job) {
  weights_.resize(surface_.size());
  return filter_.prepare({nullptr, surface_.data(), stride_}, job) &&
         eachBlock(job, [&](const SampleRect& rect, const float* smoother, std::ptrdiff_t stride) {
           std::vector<float> heights(static_cast<std::size_t>(rect.columns + 16));
           for (std::int32_t r = 0; r < rect.rows; ++r) {
             field_.readHeights(rect.column, rect.row + r, rect.columns, 1, heights.data(),
                                static_cast<std::ptrdiff_t>(heights.size()));
             const std::ptrdiff_t at = (rect.row + r) * stride_ + rect.column;
             for (std::int32_t c = 0; c < rect.columns; ++c) {
               const double middle = static_cast<double>(surface_[static_cast<std::size_t>(at + c)]);
               const double off = static_cast<double>(heights[static_cast<std::size_t>(c)]) - middle;
               const double bend = middle - static_cast<double>(smoother[r * stride + c]);
               // Of a hole it is not read.
               weights_[static_cast<std::size_t>(at + c)] =
                   static_cast<float>(robustWeight(off, bend == bend ? bend : 0.0, limit_));
             }
           }
         });
}

bool RobustRegression::find(FilterWork* work, const JobControl& job) {
  int round = 0;
  const std::size_t bytes = surface_.size() * sizeof(surface_[0]);
  // Not held while the rounds run: it is as large as the field.
  if (const auto kept = work != nullptr ? work->roundsBefore() : std::nullopt;
      kept && kept->numbers.size() == bytes) {
    std::memcpy(surface_.data(), kept->numbers.data(), bytes);
    limit_ = kept->limit;
    round = kept->done;
  }
  for (; round < kMostRobustRounds; ++round) {
    if (round > 0 && !weigh(job)) return false;
    if (!smooth(job)) return false;
    const double next = kRobustLimit * middleDistance(field_, surface_.data(), stride_);
    // More than half of the samples lie on the surface: there is no scale to weight the others by.
    const bool ends = !(next > 0.0) || std::fabs(next - limit_) <= kRobustTolerance * limit_;
    limit_ = next;
    if (ends) break;
    if (work != nullptr && work->wantsRounds())
      work->roundDone({round + 1, limit_, {reinterpret_cast<const char*>(surface_.data()), bytes}});
  }
  return true;
}

std::int64_t RobustRegression::weightless() const {
  if (weights_.empty()) return 0;
  std::int64_t count = 0;
  std::vector<float> heights(static_cast<std::size_t>(field_.width() + 16));
  for (std::int32_t r = 0; r < field_.height(); ++r) {
    field_.readHeights(0, r, field_.width(), 1, heights.data(), static_cast<std::ptrdiff_t>(heights.size()));
    for (std::int32_t c = 0; c < field_.width(); ++c)
      if (const float z = heights[static_cast<std::size_t>(c)];
          z == z && weights_[static_cast<std::size_t>(r * stride_ + c)] == 0.0F)
        ++count;
  }
  return count;
}

Result<PassResult> robustGaussianPass(const Version& input, const Version& original, const FilterSpec& spec,
                                      const FilterTuning& tuning, JobControl& job) {
  RobustRegression filter(input, spec, std::min(tuning.level, bestCpuLevel()));
  if (!filter.find(tuning.work, job)) return cancelled();
  Result<PassResult> result = passOfSurface(
      [&](const SampleRect& rect, float* out, std::ptrdiff_t stride) {
        for (std::int32_t r = 0; r < rect.rows; ++r)
          std::copy_n(filter.surface() + (rect.row + r) * filter.stride() + rect.column, rect.columns,
                      out + r * stride);
        return true;
      },
      std::max(input.grid().width, input.grid().height), input, original, spec, tuning, job);
  if (result) result->weightless = filter.weightless();
  return result;
}

}  // namespace fettle::engine
