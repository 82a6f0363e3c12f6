#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "engine/base/error.h"
#include "engine/base/job.h"

namespace fettle::bench {

struct RenderBenchOptions {
  std::vector<std::int32_t> sides{1024, 4096, 10240};  ///< samples along each side of the fields, 64 .. 16384
  int frames = 120;                                    ///< of each row, 10 .. 100000
  int width = 1280;                                    ///< of the picture [px]
  int height = 800;
  double error_px = 1.0;
  std::int64_t vertex_budget = 65536;
};

/// One way of drawing, `frames` times from a camera that goes round, every frame waited for.
struct RenderBenchRow {
  std::string name;
  std::int64_t samples = 0;
  double p50_ms = 0.0, p99_ms = 0.0, worst_ms = 0.0;  ///< of whole frames, uploads included
  double cpu_ms = 0.0;                       ///< processor time a frame, all threads: what others cannot slow
  std::int64_t vertices = 0, triangles = 0;  ///< of the last frame
  double bound_px = 0.0;                     ///< the largest
  double upload_ms = 0.0;                    ///< median a frame, on the calling thread
  double upload_ratio = 0.0;                 ///< bytes moved over bytes of the changed rectangles; 0: none
  std::int64_t stalls = 0;
  std::uint64_t hash = 0;  ///< of the last picture
};

struct RenderBenchReport {
  std::string machine;
  std::string device;
  std::vector<RenderBenchRow> rows;
  std::vector<double> first_ms;  ///< of each field: from a version to everything on the device
};

/// A machined, noisy part drawn from all round: at each size plain, and while a brush of 31 x 31 samples
/// works; at the second size (or the only one) each render effect alone as well, beside the plain row, so
/// that an effect left out can be seen to cost nothing. Errors: kInput for options out of range, kCancelled,
/// those of LivePicture. Thread: any; blocks.
[[nodiscard]] engine::Result<RenderBenchReport> benchRender(const RenderBenchOptions& options,
                                                            engine::JobControl& job);

}  // namespace fettle::bench
