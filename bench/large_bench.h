#pragma once

#include <cstdint>
#include <optional>
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

/// One step of the way.
struct LargeStage {
  std::string name;
  double seconds = 0.0;
  double samples = 0.0;          ///< that it went through; 0 where that means nothing
  double plain_seconds = 0.0;    ///< the yardstick beside it, same run; 0 = there is none
  std::string plain;             ///< what that is
  std::uint64_t resident = 0;    ///< memory after it [bytes]
  std::uint64_t peak = 0;        ///< most at any moment of it [bytes]
  std::uint64_t own = 0;         ///< part of `resident` that is no file [bytes]
  std::uint64_t disk_reads = 0;  ///< pages that were waited for (major faults)
  std::string note;
};

/// Time of a tick on the large field beside the same on 1024 x 1024 samples.
struct LargeTicks {
  std::string name;
  double ns = 0.0;
  double small_ns = 0.0;
  double p999_ns = 0.0;  ///< single ticks by the clock, on the large field
  double worst_ns = 0.0;
  std::int64_t ticks = 0;
  std::int64_t waited = 0;  ///< ticks, of those by the clock, that met a page on the disk
};

/// The live loop over the large field, in real time at 1 kHz, with a hand at 50 mm/s that smooths.
struct LargeLoop {
  std::uint64_t ticks = 0;
  std::uint64_t contact_ticks = 0;
  std::uint64_t not_near = 0;    ///< ticks that felt nothing because samples were still on the disk
  std::uint64_t disk_waits = 0;  ///< times the loop's thread waited for the disk
  std::uint64_t brought = 0;     ///< tiles that the keeper read ahead of the hand
  std::uint64_t not_locked = 0;  ///< of these, those whose pages could not be locked
  double compute_p50_us = 0.0, compute_p999_us = 0.0, compute_worst_us = 0.0;
};

struct LargeReport {
  std::string machine;
  std::int32_t side = 0;
  std::uint64_t file_bytes = 0;
  std::uint64_t saved_bytes = 0;
  std::uint64_t stored_bytes = 0;  ///< disk that the tiles take; 0 when they lie in memory
  double copy_bytes_per_s = 0.0;   ///< one thread, memory to memory
  std::uint64_t peak = 0;          ///< of all stages [bytes]
  std::uint64_t hash = 0;          ///< of the filtered field that was saved
  std::int64_t stroke_tiles = 0;   ///< that the stroke changed
  std::vector<LargeStage> stages;
  std::vector<LargeTicks> ticks;
  LargeLoop loop;
};

/// A scan of side x side samples the whole way: written as an uncompressed TIFF, opened, felt (by ticks one
/// after the other, and by the live loop), edited with a brush, undone, filtered whole (median 3, undone, box
/// 11), drawn, saved, undone. Tells before it starts whether disk and memory suffice. The files lie in a
/// folder of their own and are removed.
///
/// Disk: three times 4 bytes a sample, and the tiles where they go into a store. Memory: some 10 bytes a
/// sample without one. Errors: kInput for an option out of range or too little disk or memory; kCancelled;
/// what the stages say. Thread: any; blocks.
[[nodiscard]] engine::Result<LargeReport> benchLarge(const LargeOptions& options, engine::JobControl& job);

}  // namespace fettle::bench
