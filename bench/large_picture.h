#pragma once

#include <memory>

#include "engine/base/error.h"
#include "engine/base/job.h"
#include "engine/field/version.h"
#include "render/live/live_picture.h"

namespace fettle::bench {

/// What showing a version took.
struct PictureSteps {
  double first_s = 0.0;    ///< until a first frame shows it, coarsely perhaps
  double rest_s = 0.0;     ///< until nothing is left to be moved or measured for
  double longest_s = 0.0;  ///< that the thread of the window was held at once: by update() or by a frame
  int frames = 0;
};

/// The live picture of a very large field, 1280 x 800, as the window drives it.
///
/// Threading: one thread.
class LargePicture {
 public:
  /// Errors as LivePicture::create.
  [[nodiscard]] static engine::Result<LargePicture> create();
  /// Draws `version` until the picture is at rest. Errors: the picture's, kCancelled.
  [[nodiscard]] engine::Result<PictureSteps> show(const engine::Version& version, engine::JobControl& job);

 private:
  explicit LargePicture(std::unique_ptr<render::LivePicture> picture) : picture_(std::move(picture)) {}
  std::unique_ptr<render::LivePicture> picture_;
};

}  // namespace fettle::bench
