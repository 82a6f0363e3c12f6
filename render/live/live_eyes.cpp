#include "render/live/live_eyes.h"

namespace fettle::render {

LiveEyes::LiveEyes(Context& context, Submissions& submissions, StagingRing& staging, const Glyphs& glyphs,
                   LiveFrame& left, vk::Format colour)
    : context_(context),
      submissions_(submissions),
      staging_(staging),
      glyphs_(glyphs),
      left_(left),
      colour_(colour) {}

void LiveEyes::record(const Stereo& stereo, const Drawn& drawn, const LiveTarget& target) {
  const bool one_pass = onePass(stereo.passes);
  beginEyes(StereoCompose::eyeExtent(stereo.mode, target.extent),
            one_pass ? StereoCompose::Layers::kOneImage : StereoCompose::Layers::kTwoImages);
  if (one_pass)
    recordBoth(drawn, compose_->target(Eye::kLeft));
  else
    recordEach(drawn);
  compose_->record(submissions_.commands(), stereo.mode, target);
}

void LiveEyes::recordHead(Stereo::Passes passes, const Drawn& drawn, const LiveTarget& target) {
  if (onePass(passes)) return recordBoth(drawn, target);
  beginEyes(target.extent, StereoCompose::Layers::kTwoImages);
  recordEach(drawn);
  compose_->copyToLayers(submissions_.commands(), target);
}

bool LiveEyes::onePass(Stereo::Passes passes) const noexcept {
  return passes == Stereo::Passes::kBest  ? context_.multiviewWorks()
         : passes == Stereo::Passes::kOne ? context_.multiview()
                                          : false;
}

void LiveEyes::beginEyes(vk::Extent2D eye, StereoCompose::Layers layers) {
  if (!compose_) compose_ = std::make_unique<StereoCompose>(context_, colour_);
  compose_->begin(submissions_, eye, layers);
}

// Both eyes into the two layers of a target.
void LiveEyes::recordBoth(const Drawn& drawn, const LiveTarget& target) {
  constexpr auto kBoth = Pipelines::Views::kBoth;
  if (!both_)
    both_ = std::make_unique<LiveFrame>(context_, colour_, kBoth,
                                        std::make_shared<LivePrograms>(context_, colour_, kBoth));
  recordOne(*both_, drawn, target);
}

// Both eyes into the images of `compose_`, in two passes.
void LiveEyes::recordEach(const Drawn& drawn) {
  recordOne(left_, drawn, compose_->target(Eye::kLeft));
  for (LivePanel& panel : drawn.panels) panel.uniforms.views[0] = panel.uniforms.views[1];
  if (!right_)
    right_ = std::make_unique<LiveFrame>(context_, colour_, Pipelines::Views::kOne, left_.programs());
  recordOne(*right_, drawn, compose_->target(Eye::kRight));
}

void LiveEyes::recordOne(LiveFrame& frame, const Drawn& drawn, const LiveTarget& target) {
  frame.record(submissions_, staging_, drawn.panels, drawn.decorations, drawn.ground, glyphs_, target,
               LiveFrame::Redraw::kAll, drawn.sharpness);
}

}  // namespace fettle::render
