#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "app/report.h"
#include "app/work/filter_compute.h"
#include "engine/field/version.h"
#include "engine/filter/filter.h"
#include "engine/io/export.h"

namespace fettle::app {

/// What a filter and the writing of its result will take.
struct WorkEstimate {
  double filter_seconds = 0.0;
  double write_seconds = 0.0;
  std::uint64_t memory_bytes = 0;  ///< of the whole process at its most; without samples that lie in a store
  std::uint64_t disk_bytes = 0;    ///< of the output
  std::uint64_t kept_bytes = 0;    ///< of kept work at its most (--resume)
  std::uint64_t store_bytes = 0;   ///< more of the store's disk, for a field that lies in one

  [[nodiscard]] double seconds() const noexcept { return filter_seconds + write_seconds; }
};

/// A filter that is to be applied, and where its result goes.
struct PlannedWork {
  const engine::Version& field;
  const engine::Version& original;
  const engine::FilterSpec& spec;  ///< with its range
  FilterCompute& compute;
  std::string out;        ///< file, or "-"
  std::string extension;  ///< of its format, with its dot
  engine::ExportOptions writing;
  bool kept = false;  ///< with --resume
};

/// Estimates from a sample: blocks of the very filter (engine::sampleWork), and pieces of their result written in the
/// output's format and folder. Takes about `most_seconds`, and only where that is a small share of the work; otherwise
/// nothing, unless `always`: then the whole filter may be run. Errors as FilterCompute::apply and exportField.
[[nodiscard]] engine::Result<std::optional<WorkEstimate>> estimateWork(const PlannedWork& work, bool always,
                                                                       engine::JobControl& job,
                                                                       double most_seconds = 0.5);

/// Refuses what the free memory, the disk of the output or that of the store cannot hold (kFailed). What is a tenth
/// less than needed may fit and is not refused.
[[nodiscard]] engine::Status checkRoom(const WorkEstimate& estimate, const PlannedWork& work);

/// "about 3 min, 9.4 GB of memory and 4.0 GB of disk".
[[nodiscard]] std::string textOf(const WorkEstimate& estimate);

/// Its members as `seconds`, `filter_seconds`, `write_seconds`, `memory_bytes`, `disk_bytes`, `kept_bytes`, `store_bytes`.
[[nodiscard]] Report reportOf(const WorkEstimate& estimate);

}  // namespace fettle::app
