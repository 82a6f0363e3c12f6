#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "engine/base/error.h"
#include "engine/base/job.h"
#include "render/live/live_picture.h"

namespace fettle::bench {

struct RenderBenchOptions {
  std::vector<std::int32_t> sides{1024, 4096};  ///< samples along each side of the fields, 64 .. 32768
  int frames = 120;                             ///< of each row, 10 .. 100000
  int width = 1280;                             ///< of the picture [px]
  int height = 800;
  double error_px = 1.0;
  std::int64_t vertex_budget = render::kFrameVertices;
  std::int64_t memory_budget_bytes = 0;  ///< LiveOptions::memory_budget_bytes
  std::vector<std::string> scenes;       ///< rows by name; none: all
  /// Resolution of frames while the camera moves, together with the loop and for the targets. kFull: the rows
  /// with half resolution are left out.
  render::Sharpness in_motion = render::Sharpness::kHalf;
  double loop_seconds = 8.0;  ///< drawing with a haptic loop at 1 kHz, first size; 0: none; .. 600
};

/// One scene, drawn `frames` times, waiting for every frame.
struct RenderBenchRow {
  std::string name;
  std::int64_t samples = 0;
  double p50_ms = 0.0, p99_ms = 0.0, worst_ms = 0.0;  ///< of whole frames, uploads included
  double cpu_ms = 0.0;  ///< processor time per frame, all threads: not affected by other programs
  std::int64_t vertices = 0, triangles = 0;  ///< of the last frame
  double bound_px = 0.0;                     ///< the largest
  double of_plain = 0.0;  ///< processor time over that of the plain row of this size; 0: there is none
  double redrawn = 1.0;   ///< mean share of the plot that was drawn again
  double edit_p50_ms = 0.0,
         edit_p99_ms = 0.0;           ///< from passing a version to the completed frame that shows it
  std::int64_t tiles = 0, bytes = 0;  ///< moved in all
  double upload_ms = 0.0;             ///< median per frame, on the calling thread
  double upload_ratio = 0.0;          ///< bytes moved over bytes of the changed rectangles; 0: none
  std::int64_t stalls = 0;
  /// Of a row with half resolution, against the sharp picture of the same view, from twelve sides: largest
  /// difference of a pixel's channels [codes, 0 .. 255], its mean, its maximum, share of pixels above 16.
  double off_mean = 0.0, off_max = 0.0, off_share = 0.0;
  std::uint64_t hash = 0;  ///< of the last picture
};

/// Drawing while a hand presses and smooths at 1 kHz (haptic/loop/loop_bench.h), both measured.
struct RenderWithLoop {
  bool ran = false;
  double frame_p50_ms = 0.0, frame_p99_ms = 0.0;
  double late_p50_us = 0.0, late_p99_us = 0.0, late_p999_us = 0.0;  ///< of the loop's wake-ups
  double p99_ratio = 0.0, p999_ratio = 0.0;  ///< over those of cyclictest in the same run
};

/// A measured figure with its target.
struct RenderTarget {
  std::string name;
  double value = 0.0, limit = 0.0;  ///< met when value <= limit
};

struct RenderBenchReport {
  std::string machine;
  std::string device;
  std::vector<RenderBenchRow> rows;
  std::vector<double> first_ms;  ///< of each field: from a version to its first picture
  std::vector<double> rest_ms;   ///< and to the first frame after which nothing is uploaded or refined
  std::int64_t peak_bytes =
      0;  ///< memory that the process held at most; the device's too, where it is software
  RenderWithLoop loop;
  std::vector<RenderTarget> targets;
};

/// A machined, noisy part. At each size: an empty frame (ground and decorations, the yardstick); from all
/// sides, plain, at half resolution ("moving", as in the window), at a quarter, and while a brush of 31 x 31 samples works;
/// from one side, the brush with frames drawn in parts and as a whole, and a stylus that moves over the
/// surface; and as finely as the window draws a picture at rest. At the first size also each render effect
/// alone, for comparison with the plain row, so that an effect left out can be seen to cost nothing, and a field under a
/// sphere at rest and with the sphere put back and taken out again in each frame. Errors:
/// kInput for options out of range, kCancelled, those of LivePicture. Thread: any; blocks.
[[nodiscard]] engine::Result<RenderBenchReport> benchRender(const RenderBenchOptions& options,
                                                            engine::JobControl& job);

}  // namespace fettle::bench
