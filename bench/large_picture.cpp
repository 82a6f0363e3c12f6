#include "bench/large_picture.h"

#include <algorithm>

#include "engine/base/stopwatch.h"

namespace fettle::bench {

engine::Result<LargePicture> LargePicture::create() {
  auto made = render::LivePicture::create();
  if (!made) return tl::unexpected(made.error());
  return LargePicture(*std::move(made));
}

engine::Result<PictureSteps> LargePicture::show(const engine::Version& version, engine::JobControl& job) {
  PictureSteps steps;
  render::FrameInput input;
  input.view.width = 1280;
  input.view.height = 800;
  const engine::Stopwatch all;
  if (auto ok = picture_->update(version); !ok) return tl::unexpected(ok.error());
  steps.longest_s = all.seconds();
  for (bool rests = false; !rests; ++steps.frames) {
    if (job.cancelled()) return engine::cancelled();
    const engine::Stopwatch frame_time;
    const auto frame = picture_->drawAndWait(input);
    if (!frame) return tl::unexpected(frame.error());
    steps.longest_s = std::max(steps.longest_s, frame_time.seconds());
    if (steps.frames == 0) steps.first_s = all.seconds();
    rests = frame->upload.pending_tiles == 0 && frame->residency.pages_loaded == 0;
  }
  steps.rest_s = all.seconds();
  return steps;
}

}  // namespace fettle::bench
