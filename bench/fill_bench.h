#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "engine/base/error.h"
#include "engine/base/job.h"

namespace fettle::bench {

struct FillBenchOptions {
  std::int32_t side = 4096;  ///< samples along each side of the field, 512 .. 32768
  int repeats = 3;           ///< 1 .. 100
};

/// Filling one kind of holes by one method.
struct FillBenchRow {
  std::string holes;   ///< "single", "discs", "scratches", "one large"
  std::string method;  ///< "membrane", "curvature"
  std::int64_t count = 0, filled = 0;
  double median = 0.0, fastest = 0.0, slowest = 0.0;  ///< [s]
  double plain = 0.0;      ///< median time of copying every sample of the field, in the same run [s]
  std::uint64_t hash = 0;  ///< of the field; the same in every repeat
};

struct FillBenchReport {
  std::string machine;
  std::int64_t samples = 0;
  std::vector<FillBenchRow> rows;
};

/// Fills holes of a waved field: single samples at random (one in twenty), discs of 2 to 6 samples' radius, scratches of
/// 3 samples' width along the field, one disc of 60,000 samples. Before each repeat the field's samples are copied into
/// an array that is there already, by one thread. Errors: kInput for options out of range; kFailed without memory or when
/// two repeats differ in a bit; kCancelled. Thread: any; blocks.
[[nodiscard]] engine::Result<FillBenchReport> benchFill(const FillBenchOptions& options,
                                                        engine::JobControl& job);

}  // namespace fettle::bench
