#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include "engine/base/job.h"
#include "engine/field/reader.h"
#include "engine/field/sample_rect.h"

namespace fettle::engine {

/// A compensated sum, which carries the rounding error of each addition; its error is one rounding of the
/// result plus a term of second order in the number of addends. Neumaier, Rundungsfehleranalyse einiger
/// Verfahren zur Summation endlicher Summen (1974), algorithm IV.
class CompensatedSum {
 public:
  void add(double x) noexcept {
    const double t = sum_ + x;
    lost_ += std::abs(sum_) >= std::abs(x) ? (sum_ - t) + x : (x - t) + sum_;
    sum_ = t;
  }
  void add(const CompensatedSum& other) noexcept {
    add(other.sum_);
    add(other.lost_);
  }
  [[nodiscard]] double value() const noexcept { return sum_ + lost_; }

 private:
  double sum_ = 0.0;
  double lost_ = 0.0;
};

/// The samples of tile `index`, counted row-major from 0.
[[nodiscard]] inline SampleRect tileRect(const FieldReader& field, std::int64_t index) noexcept {
  SampleRect rect;
  rect.column = static_cast<std::int32_t>(index % field.tileColumns()) * kTileSide;
  rect.row = static_cast<std::int32_t>(index / field.tileColumns()) * kTileSide;
  rect.columns = std::min(kTileSide, field.width() - rect.column);
  rect.rows = std::min(kTileSide, field.height() - rect.row);
  return rect;
}

/// Calls f(rect, part) for every tile on all workers of the arena, each with its own part, and returns the
/// parts in tile order (row-major), so that combining them gives the same result for any thread count. Parts
/// of tiles after a cancel are as constructed: check job.cancelled(). Advances the job by one per tile.
template <class Part, class F>
[[nodiscard]] std::vector<Part> forEachTile(const FieldReader& field, JobControl& job, const F& f) {
  const std::int64_t tiles = std::int64_t{field.tileColumns()} * field.tileRows();
  std::vector<Part> parts(static_cast<std::size_t>(tiles));
  tbb::parallel_for(tbb::blocked_range<std::int64_t>(0, tiles), [&](const auto& range) {
    for (std::int64_t i = range.begin(); i < range.end() && !job.cancelled(); ++i) {
      f(tileRect(field, i), parts[static_cast<std::size_t>(i)]);
      job.advance();
    }
  });
  return parts;
}

/// Number of tiles, the steps that forEachTile advances a job by.
[[nodiscard]] inline std::uint64_t tileCount(const FieldReader& field) noexcept {
  return static_cast<std::uint64_t>(field.tileColumns()) * static_cast<std::uint64_t>(field.tileRows());
}

}  // namespace fettle::engine
