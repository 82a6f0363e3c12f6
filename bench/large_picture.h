#pragma once

#include <memory>

#include "engine/base/error.h"
#include "engine/base/job.h"
#include "engine/field/version.h"
#include "render/live/live_picture.h"

namespace fettle::bench {

/// Times for showing a version.
struct PictureSteps {
  double first_s = 0.0;    ///< until a first frame shows it, possibly coarse
  double rest_s = 0.0;     ///< until uploads and level of detail are complete
  double longest_s = 0.0;  ///< longest time of update() or of a frame on the window's thread
  int frames = 0;
};

/// The live picture of a very large field, 1280 x 800, as the window drives it.
///
/// Threading: one thread.
class LargePicture {
 public:
  /// Errors as LivePicture::create.
  [[nodiscard]] static engine::Result<LargePicture> create();
  /// Draws `version` until the picture is complete. Errors: the picture's, kCancelled.
  [[nodiscard]] engine::Result<PictureSteps> show(const engine::Version& version, engine::JobControl& job);

 private:
  explicit LargePicture(std::unique_ptr<render::LivePicture> picture) : picture_(std::move(picture)) {}
  std::unique_ptr<render::LivePicture> picture_;
};

}  // namespace fettle::bench
