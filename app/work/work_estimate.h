#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "app/report.h"
#include "app/work/filter_compute.h"
#include "engine/field/sample_rect.h"
#include "engine/field/version.h"
#include "engine/filter/filter.h"
#include "engine/io/export.h"

namespace fettle::app {

/// What work on a field and the writing of its result will take.
struct WorkEstimate {
  double work_seconds = 0.0;
  double write_seconds = 0.0;
  std::uint64_t memory_bytes = 0;  ///< of the whole process at its most; without samples that lie in a store
  std::uint64_t disk_bytes = 0;    ///< of the output
  std::uint64_t kept_bytes = 0;    ///< of kept work at its most (--resume)
  std::uint64_t store_bytes = 0;   ///< more of the store's disk, for a field that lies in one

  [[nodiscard]] double seconds() const noexcept { return work_seconds + write_seconds; }
};

/// A filter that is to be applied. Both live as long as the plan.
struct PlannedFilter {
  const engine::FilterSpec& spec;  ///< with its range
  FilterCompute& compute;
  double share =
      1.0;  ///< samples that it has before it, for each of the field: others where a step before it crops
};

/// Work whose time is in proportion to the samples: the same work on a rectangle of the field, and what it makes of that.
struct PlannedOnPieces {
  using Work =
      std::function<engine::Result<engine::Version>(const engine::SampleRect& rect, engine::JobControl& job)>;
  Work work;
  int fields = 1;  ///< of which it makes pieces, which the work on the whole does not
  /// Samples of a field from which on the work takes no longer: of work on a choice of places.
  double most_samples = 1e18;
  double share = 1.0;  ///< as of PlannedFilter
  /// What there is to do in a rectangle of the field, where that is not its samples; and around which sample the squares lie
  /// then. As of most_samples a sample is not taken where it would be much of the work.
  std::function<double(const engine::SampleRect& rect)> amount = {};
  std::int32_t column = 0, row = 0;
  /// What the work makes of the original, for work whose result is of another size; empty: it stays as it is.
  Work of_original = {};
  /// [bytes] for each sample up to most_samples, where pieces are too small to show what the work takes; 0: by the pieces.
  double memory_each = 0.0;
  /// The time of the whole measured in another way than on squares, which say little of it; without --estimate only of a field of
  /// so many samples (each counted `share` times), where that is a small part of the work.
  struct Whole {
    std::function<engine::Result<double>(engine::JobControl& job)> seconds;
    double fewest_samples = 0.0;
  };
  std::optional<Whole> whole = {};
  /// The disk is that of squares all over the field, as where the writing is all of the work: what is made lies densely here
  /// and not there.
  bool uneven = false;
};

using PlannedStep = std::variant<PlannedFilter, PlannedOnPieces>;

/// Writes a piece of the result as the whole will be written.
using WritePiece = std::function<engine::Status(const engine::Version& piece, const std::string& path,
                                                engine::JobControl& job)>;

/// Work that is to be done to a field, one step after the other, and where its result goes.
struct PlannedWork {
  const engine::Version& field;
  const engine::Version& original;
  std::vector<PlannedStep> steps;
  std::string out;        ///< file, or "-"; empty: nothing is written
  std::string extension;  ///< of its format, with its dot
  engine::ExportOptions writing;
  bool kept = false;      ///< with --resume
  double result = 1.0;    ///< samples of the result for each of the field
  WritePiece write = {};  ///< empty: engine::exportField
  bool alike = false;     ///< what is written is as large whatever the samples: one piece shows it
};

/// Estimates from a sample: blocks of the very filters (engine::sampleWork), other work on squares of three sizes from the
/// middle of the field, and pieces of the result written in the output's format and folder; where the writing is all of
/// the work, squares all over the field as well, since a mesh with an error takes the more the rougher the surface is. Takes about `most_seconds`
/// for each step, and only where that is a small share of the work; otherwise nothing, unless `always`: then the whole
/// work may be done. Several filters are sampled on the field as it is, not as earlier steps leave it. Errors as the
/// steps and exportField.
[[nodiscard]] engine::Result<std::optional<WorkEstimate>> estimateWork(const PlannedWork& work, bool always,
                                                                       engine::JobControl& job,
                                                                       double most_seconds = 0.5);

/// Refuses what the free memory, the disk of the output or that of the store cannot hold (kFailed). A disk with a tenth
/// less than needed may do and is not refused; memory must have a tenth more and 64 MB for each core,
/// as a sample does not show all and a process that runs out of memory is ended by the system.
[[nodiscard]] engine::Status checkRoom(const WorkEstimate& estimate, const PlannedWork& work);

/// "about 3 min, 9.4 GB of memory and 4.0 GB of disk".
[[nodiscard]] std::string textOf(const WorkEstimate& estimate);

/// Its members as `seconds`, `work_seconds`, `write_seconds`, `memory_bytes`, `disk_bytes`, `kept_bytes`, `store_bytes`.
[[nodiscard]] Report reportOf(const WorkEstimate& estimate);

}  // namespace fettle::app
