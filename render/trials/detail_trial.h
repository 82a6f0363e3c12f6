#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "engine/base/error.h"
#include "engine/base/job.h"
#include "render/live/live_picture.h"

namespace fettle::trials {

/// How finely the surface may be drawn; see render::FrameInput.
struct DetailChoice {
  const char* name;
  double error_px = 1.0;
  std::int64_t vertices = render::kFrameVertices;
  render::Sharpness sharpness = render::Sharpness::kFull;
};

/// Every sample, up to 2^24 vertices.
[[nodiscard]] const DetailChoice& everySample();

struct DetailFigures {
  double ms = 0.0, ms_worst = 0.0;  ///< per frame: median and worst of the views
  double mean_codes = 0.0, p99_codes = 0.0,
         worst_codes = 0.0;   ///< of 255, largest difference of the channels of a pixel
  double far_off = 0.0;       ///< share of pixels more than 16 codes off, 0 .. 1
  double bound_px = 0.0;      ///< largest proved error of the geometry
  std::int64_t vertices = 0;  ///< of the view with the most
  std::uint64_t hash = 0;
};

/// Draws what `picture` shows from `views` directions around it, beginning with that of `input`: by each
/// choice, and by `reference`, which they are compared with; its figures come last. Whole frames, nothing is
/// reused. Progress: one per picture. Errors: kCancelled; those of LivePicture::draw. Threading: that of the
/// picture. Deterministic except for times where the device is.
[[nodiscard]] engine::Result<std::vector<DetailFigures>> measureDetail(render::LivePicture& picture,
                                                                       render::FrameInput input, int views,
                                                                       std::span<const DetailChoice> choices,
                                                                       const DetailChoice& reference,
                                                                       engine::JobControl& job);

}  // namespace fettle::trials
