#pragma once

#include "render/plan/glyphs.h"
#include "render/vulkan/memory.h"
#include "render/vulkan/submissions.h"

namespace fettle::render {

/// The letters of pictures on the device, uploaded when there are new ones.
class GlyphImage {
 public:
  explicit GlyphImage(Context& context) : context_(context) {}

  [[nodiscard]] bool holds(const Glyphs& glyphs) const noexcept { return generation_ == glyphs.generation(); }
  /// Records it, outside of a rendering. Where `staging` has no room, a later call does.
  void upload(const vk::raii::CommandBuffer& commands, StagingRing& staging, std::uint64_t submission,
              const Glyphs& glyphs);
  /// After an upload.
  [[nodiscard]] vk::ImageView view() const { return image_.view(); }

 private:
  Context& context_;
  GpuImage image_;
  std::uint64_t generation_ = 0;
};

}  // namespace fettle::render
