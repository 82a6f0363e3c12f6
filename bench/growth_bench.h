#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "engine/base/error.h"
#include "engine/base/job.h"

namespace fettle::bench {

struct GrowthOptions {
  /// Samples along the sides of the largest field, 256 .. 32768; the others are this divided by powers of
  /// two, down to 256.
  std::int32_t largest = 8192;
  /// Share of the full work except the fields' sizes, 0.01 .. 1: ticks, samples under a window.
  double effort = 1.0;
  bool picture = true;  ///< uploads too, which need a Vulkan device
};

/// A cost at one size of the work, over repeats.
struct GrowthPoint {
  double work = 0.0;
  double median = 0.0;
  double worst = 0.0;
};

struct GrowthSeries {
  std::string name;  ///< "box 11 x 11"
  std::vector<GrowthPoint> points;
  /// Of the line through the points' logarithms, by least squares: 0 = constant cost, 1 = proportional to the
  /// work, 2 = to its square.
  double slope = 0.0;
  double target = 0.0;  ///< largest allowed cost at any size; 0: no target
};

/// Costs of a kind against the same work, for one picture with logarithmic axes.
struct Growth {
  std::string id;  ///< "tick"
  std::string title;
  std::string work;      ///< "samples of the field"
  std::string cost;      ///< with its unit: "time per tick [ns]"
  std::string expected;  ///< expected slope, and why
  std::vector<GrowthSeries> series;
};

struct GrowthReport {
  std::string machine;
  double copy_bytes_per_s = 0.0;  ///< yardstick, one thread
  std::vector<Growth> growths;
};

/// How costs grow with the work: a tick, snapshot, edit, undo and storing a stroke in a session
/// (commit_times.h) over the size of the field; filters over the size of the field and of the window; a tick
/// over the radius of its brush; an upload over the tiles that changed. One thread except for the filters of
/// whole fields, which use all cores. Memory: about 20 bytes per sample of the largest field. Errors: kInput
/// for an option out of range, kCancelled, kFailed without memory or device. Thread: any; blocks.
[[nodiscard]] engine::Result<GrowthReport> benchGrowth(const GrowthOptions& options, engine::JobControl& job);

/// The slope of a series. 0 for less than two points.
[[nodiscard]] double slopeOf(const std::vector<GrowthPoint>& points);

}  // namespace fettle::bench
