#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "bench/filter_bounds.h"
#include "engine/base/error.h"
#include "engine/base/job.h"
#include "engine/filter/catalogue.h"
#include "engine/filter/tgv_device.h"

namespace fettle::bench {

/// Content of a row's field in addition to its heights.
enum class FilterGround {
  kPlain,  ///< neither hole nor mark
  kHoles,  ///< round dropouts and single ones, about 1 % of the samples, in about a third of the tiles
  kMarks,  ///< a line of kept samples through every tile
};

struct FiltersBenchOptions {
  std::int32_t side = 8192;  ///< samples along each side of the field, 64 .. 32768
  std::vector<engine::FilterKind> kinds = engine::plainFilters();
  std::vector<int> windows = {3, 5, 11, 31, 101};  ///< [samples], odd, 3 .. FilterSpec::kMaxWindow
  std::vector<int> threads = {1, 2};               ///< each 1 .. FilterSpec::kMaxThreads
  std::vector<FilterGround> grounds = {FilterGround::kPlain, FilterGround::kHoles, FilterGround::kMarks};
  /// Of the filters that have one: a row for each.
  std::vector<engine::Element> elements = {engine::Element::kBall, engine::Element::kDisk,
                                           engine::Element::kSquare};
  int repeats = 5;        ///< 1 .. 100
  double limit_s = 10.0;  ///< a row that would take longer gets a smaller field, > 0 .. 1e6
  /// Adds a row with this device to each row of a filter that can use it (Filter::on_device); null: none.
  engine::TgvDevice* device = nullptr;
  /// Adds to each row of one thread on the processor what its filter cannot do without (filter_bounds.h).
  bool bounds = false;
};

/// One filter over one field: all of applyFilter, its report included. Rates in samples per second.
struct FiltersBenchRow {
  engine::FilterKind kind = engine::FilterKind::kBox;
  engine::Element element = engine::Element::kBall;  ///< of a filter that has one
  int window = 0;                                    ///< of a body: twice its radius
  int threads = 0;
  FilterGround ground = FilterGround::kPlain;
  bool on_device = false;
  std::int32_t side = 0;  ///< of this row's field; less than the option's where limit_s was met
  double median = 0.0, slowest = 0.0, fastest = 0.0;
  double cpu = 0.0;       ///< median of samples per second of processor time: not affected by a busy machine
  double copy = 0.0;      ///< median rate of plain copying of floats by as many threads, in the same run
  double copy_cpu = 0.0;  ///< the same per second of processor time
  /// Rate over that of the same row with one thread, median of the ratios of each round; 0 without one.
  double over_one = 0.0;
  /// On a device: rate over that of the row before it, the processor's, likewise; and the largest difference from its
  /// result [range_sigma].
  double over_processor = 0.0, most_off = 0.0;
  std::uint64_t hash = 0;  ///< of the result; the same in every repeat
  FilterBound bound;       ///< all 0 where it was not asked for
};

struct FiltersBenchReport {
  std::string machine;
  std::string device;  ///< its name; empty: none
  std::vector<FiltersBenchRow> rows;
};

/// Target of a row on plain ground, for each machine: a share of the copy with one thread, a gain over one
/// thread with two. 0: no target.
struct FilterTarget {
  double share = 0.0;
  double over_one = 0.0;
};
/// What suggestFilter takes for the cost of a pass like this one (FilterTrial::cost) [ns per sample]; 0 of a row of several
/// threads, of a device, or of a window that it does not try.
[[nodiscard]] double suggestedCost(const FiltersBenchRow& row) noexcept;

[[nodiscard]] FilterTarget targetOf(const FiltersBenchRow& row) noexcept;

/// Filters synthetic relief with noise, `repeats` times each row, alternating between all rows, with a plain
/// copy of an array of as many floats in each round. A first run of each row, which obtains memory from the
/// system, is not counted. Errors: kInput for options out of range, kFailed when two repeats differ in a bit,
/// kCancelled. Memory: fields of all grounds and one result, 4.2 bytes per sample each, and two arrays to
/// copy. A filter without a window has one row for all of them. Thread: any; blocks.
[[nodiscard]] engine::Result<FiltersBenchReport> benchFilters(const FiltersBenchOptions& options,
                                                              engine::JobControl& job);

/// "plain", "holes", "marks" and back; throws nothing, empty for none.
[[nodiscard]] std::string groundName(FilterGround ground);

}  // namespace fettle::bench
