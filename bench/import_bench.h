#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "engine/base/error.h"
#include "engine/base/job.h"

namespace fettle::bench {

struct ImportBenchOptions {
  /// Samples along each side of the field that is written and read, 16 .. 16384. Above 2048 it is written as
  /// GeoTIFF alone, in each layout: text and meshes would take minutes and tens of gigabytes.
  std::int32_t side = 1024;
  int repeats = 5;  ///< 1 .. 100
  /// Files to read instead; with none the same field is written in every format.
  std::vector<std::string> files;
};

/// Import rate of one file. Rates in bytes of the file per second.
struct ImportBenchRow {
  std::string name;    ///< kind of file written, "PLY mesh"; of a given file, its name
  std::string format;  ///< FormatInfo::name of the reader
  std::int64_t bytes = 0;
  std::int64_t samples = 0;  ///< of the field
  double median = 0.0, slowest = 0.0, fastest = 0.0;
  double plain = 0.0;  ///< median rate of reading the same file into a buffer, in the same run
  /// Median rate of GDAL alone (bench/gdal_yardstick.h) in the same run; 0 for files that it does not read.
  double gdal = 0.0;
  double gdal_new = 0.0;  ///< the same into memory that was never used
  /// Median rate at which the memory of the field's tiles is provided, alone: its pages are cleared. No import into new tiles
  /// is faster than this or than plain reading, whichever is slower.
  double memory = 0.0;
  std::uint64_t hash = 0;  ///< of the field; the same in every repeat
};

struct ImportBenchReport {
  std::string machine;
  std::vector<ImportBenchRow> rows;
};

/// Imports each file `repeats` times, alternating between them, each time after plain reading (1 MB at a
/// time), providing the memory alone and, for a TIFF, reading by GDAL alone, so that the file is in the page cache for all and a change
/// of the machine's speed affects all. Files made here lie in a new folder in the system's temporary folder
/// and are removed.
/// Errors: kInput for options out of range and files that cannot be read or made, kFailed when two repeats
/// differ in a bit, kCancelled. Thread: any; blocks.
[[nodiscard]] engine::Result<ImportBenchReport> benchImport(const ImportBenchOptions& options,
                                                            engine::JobControl& job);

}  // namespace fettle::bench
