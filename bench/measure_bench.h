#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "engine/base/error.h"
#include "engine/base/job.h"

namespace fettle::bench {

struct MeasureBenchOptions {
  std::int32_t side = 4096;  ///< samples along each side of the field, 512 .. 32768
  int repeats = 3;           ///< 1 .. 100
};

/// One step of measuring, or of making a field ready for it.
struct MeasureBenchRow {
  std::string step;                                   ///< "level, plane"
  double median = 0.0, fastest = 0.0, slowest = 0.0;  ///< [s]
  double plain = 0.0;      ///< median time of copying every sample of the field, in the same run [s]
  std::uint64_t bits = 0;  ///< hash of the field, or of the figures; the same in every repeat
};

struct MeasureBenchReport {
  std::string machine;
  std::int64_t samples = 0;
  std::vector<MeasureBenchRow> rows;
};

/// Levels, sections, parameters, transforms, an alignment and removals of a waved, tilted field with noise and a wall. Before
/// each repeat the field's samples are copied into an array that is there already, by one thread. Memory: the field four
/// times, and 40 bytes per sample for the parameters. Errors: kInput for options out of range; kFailed without memory or
/// when two repeats differ in a bit; kCancelled. Thread: any; blocks.
[[nodiscard]] engine::Result<MeasureBenchReport> benchMeasure(const MeasureBenchOptions& options,
                                                              engine::JobControl& job);

}  // namespace fettle::bench
