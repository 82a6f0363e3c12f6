#pragma once

#include <memory>
#include <vector>

#include <glm/vec3.hpp>

#include "render/live/live_frame.h"
#include "render/live/stereo_compose.h"

namespace fettle::render {

/// The frames of two eyes: in one pass for both where the device has that, else in a pass each. What that needs is created on
/// first use.
///
/// Threading: as Context. References what it is made of. Throws vk::SystemError.
class LiveEyes {
 public:
  /// `left` draws the left eye where each has a pass of its own.
  LiveEyes(Context& context, Submissions& submissions, StagingRing& staging, const Glyphs& glyphs,
           LiveFrame& left, vk::Format colour);
  LiveEyes& operator=(LiveEyes&&) = delete;

  /// What both eyes see, each by its own camera in LivePanel::uniforms. Where each has a pass the right one's takes the place
  /// of the left one's.
  struct Drawn {
    std::vector<LivePanel>& panels;
    const std::vector<gpu::Quad>& decorations;
    glm::vec3 ground;
    Sharpness sharpness;
  };
  /// Two pictures, combined in the target as `stereo` says.
  void record(const Stereo& stereo, const Drawn& drawn, const LiveTarget& target);
  /// A headset's eyes, into the two layers of the target: directly in one pass, else by a copy.
  void recordHead(Stereo::Passes passes, const Drawn& drawn, const LiveTarget& target);

 private:
  [[nodiscard]] bool onePass(Stereo::Passes passes) const noexcept;
  void beginEyes(vk::Extent2D eye, StereoCompose::Layers layers);
  void recordBoth(const Drawn& drawn, const LiveTarget& target);
  void recordEach(const Drawn& drawn);
  void recordOne(LiveFrame& frame, const Drawn& drawn, const LiveTarget& target);

  Context& context_;
  Submissions& submissions_;
  StagingRing& staging_;
  const Glyphs& glyphs_;
  LiveFrame& left_;
  vk::Format colour_;
  std::unique_ptr<StereoCompose> compose_;
  std::unique_ptr<LiveFrame> both_;   // in one pass
  std::unique_ptr<LiveFrame> right_;  // in a pass of its own
};

}  // namespace fettle::render
