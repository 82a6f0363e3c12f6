#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "engine/base/error.h"
#include "engine/base/job.h"

namespace fettle::bench {

struct LargeOptions {
  std::int32_t side = 32768;  ///< samples along each side of the scan, 256 .. 131072
  std::string folder;         ///< where the scan and the saved file lie; empty: the system's temporary folder
  double effort = 1.0;        ///< share of the ticks and repeats, 0.01 .. 1
  bool picture = true;        ///< draw it too, which needs a Vulkan device
};

/// One stage of the run.
struct LargeStage {
  std::string name;
  double seconds = 0.0;
  double samples = 0.0;          ///< samples processed; 0 where not applicable
  double plain_seconds = 0.0;    ///< the yardstick of the same run; 0 = there is none
  std::string plain;             ///< name of the yardstick
  std::uint64_t resident = 0;    ///< memory after it [bytes]
  std::uint64_t peak = 0;        ///< most at any moment of it [bytes]
  std::uint64_t own = 0;         ///< part of `resident` that is not backed by a file [bytes]
  std::uint64_t disk_reads = 0;  ///< major page faults
  std::string note;
};

/// Time of a tick on the large field and on 1024 x 1024 samples.
struct LargeTicks {
  std::string name;
  double ns = 0.0;
  double small_ns = 0.0;
  double p999_ns = 0.0;  ///< single ticks by the clock, on the large field
  double worst_ns = 0.0;
  std::int64_t ticks = 0;
  std::int64_t waited = 0;  ///< timed ticks that had a major page fault
};

/// The live loop over the large field, in real time at 1 kHz, with a hand at 50 mm/s that smooths.
struct LargeLoop {
  std::uint64_t ticks = 0;
  std::uint64_t contact_ticks = 0;
  std::uint64_t not_prefetched = 0;  ///< ticks without contact because samples were still on the disk
  std::uint64_t disk_waits = 0;      ///< times the loop's thread waited for the disk
  std::uint64_t prefetched = 0;      ///< tiles prefetched for the loop
  std::uint64_t not_locked = 0;      ///< of these, those whose pages could not be locked
  double compute_p50_us = 0.0, compute_p999_us = 0.0, compute_worst_us = 0.0;
};

struct LargeReport {
  std::string machine;
  std::int32_t side = 0;
  std::uint64_t file_bytes = 0;
  std::uint64_t saved_bytes = 0;
  std::uint64_t stored_bytes = 0;  ///< disk space of the tiles; 0 when they lie in memory
  double copy_bytes_per_s = 0.0;   ///< one thread, memory to memory
  std::uint64_t peak = 0;          ///< of all stages [bytes]
  std::uint64_t hash = 0;          ///< of the filtered field that was saved
  std::int64_t stroke_tiles = 0;   ///< that the stroke changed
  std::vector<LargeStage> stages;
  std::vector<LargeTicks> ticks;
  LargeLoop loop;
};

/// A complete run with a scan of side x side samples: written as an uncompressed TIFF, opened, felt (by ticks
/// in sequence, and by the live loop), edited with a brush, undone, filtered whole (median 3, undone, box
/// 11), drawn, saved, undone. Checks before it starts whether disk and memory suffice. The files lie in a
/// temporary folder and are removed.
///
/// Disk: three times 4 bytes per sample, and the tiles if they are in a store. Memory: about 10 bytes per
/// sample without one. Errors: kInput for an option out of range or too little disk or memory; kCancelled;
/// those of the stages. Thread: any; blocks.
[[nodiscard]] engine::Result<LargeReport> benchLarge(const LargeOptions& options, engine::JobControl& job);

}  // namespace fettle::bench
