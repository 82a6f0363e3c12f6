#pragma once

#include <span>
#include <string>
#include <vector>

#include "engine/base/error.h"
#include "engine/base/job.h"
#include "engine/field/version.h"
#include "engine/filter/filter.h"
#include "engine/filter/pass.h"
#include "engine/filter/tgv_square.h"

namespace fettle::engine {

/// Another processor that carries out the steps of generalised variation (tgv_schedule.h), for several squares at a
/// time and while this one prepares the next.
///
/// Each square's u is that of the same steps here, but for rounding: additions, multiplications and comparisons as
/// here, a quotient by a root to within 7 units in the last place. What a square comes to depends on it
/// alone, never on those it is together with.
///
/// Threading: one thread at a time. Memory of the squares stays the caller's, and is not touched by others from start()
/// until the square is finished.
class TgvDevice {
 public:
  TgvDevice() = default;
  TgvDevice(const TgvDevice&) = delete;
  TgvDevice& operator=(const TgvDevice&) = delete;
  virtual ~TgvDevice() = default;

  /// Of the device and its driver.
  [[nodiscard]] virtual const std::string& name() const noexcept = 0;
  /// Most squares of a batch, >= 1; may change with each batch.
  [[nodiscard]] virtual std::size_t mostTogether() const noexcept = 0;
  /// Batches that were started and are not finished, 0 .. kMostBatches.
  [[nodiscard]] virtual int underWay() const noexcept = 0;
  static constexpr int kMostBatches = 2;

  /// Starts a batch of 1 .. mostTogether() prepared squares, each of tgv::kSide + 2 tgv::kHalo samples a side at most,
  /// while fewer than kMostBatches are under way. Does not wait for the device. Error kFailed: the device is lost or
  /// has no memory; then only drop() may follow.
  [[nodiscard]] virtual Status start(std::span<TgvSquare* const> squares) = 0;

  /// Lets the device go on, for about 50 ms at most, and appends the squares that are finished: their u is the result.
  /// Not without a batch under way. Errors as start().
  [[nodiscard]] virtual Status proceed(std::vector<TgvSquare*>& finished) = 0;

  /// Gives up what is under way; returns when the device is done with it.
  virtual void drop() noexcept = 0;
};

/// applyFilter with the steps on a device; the filter has Filter::on_device (asserted). Every result is within 0.001
/// range_sigma + 2^-22 of the largest height of the square less its median of applyFilter's, where noise breaks ties (a
/// field of whole numbers may fall the other way at one: 4 range_sigma), and bit-identical from run to run on one
/// device for any number of threads. What has no steps to take - holes, kept marks, constants - has applyFilter's bits.
///
/// Squares are prepared and merged on spec.threads threads while a thread of its own drives the device. A cancel is
/// seen within about 100 ms. Errors as applyFilter, and those of the device: no part of a result then.
/// Memory: as applyFilter, and 9 MB for each square on its way, 3 mostTogether() + spec.threads at most.
[[nodiscard]] Result<Filtered> applyFilter(const Version& input, const Version& original,
                                           const FilterSpec& spec, TgvDevice& device, JobControl& job,
                                           FilterWork* work = nullptr);

/// Filter::on_device of kGeneralisedVariation.
[[nodiscard]] Result<PassResult> tgvPassOnDevice(const Version& input, const Version& original,
                                                 const FilterSpec& spec, TgvDevice& device, FilterWork* work,
                                                 JobControl& job);

}  // namespace fettle::engine
