#pragma once

#include "render/plan/picture.h"
#include "render/vulkan/context.h"
#include "render/xr/room.h"
#include "render/xr/xr_calls.h"
#include "render/xr/xr_images.h"

namespace fettle::render {

/// A picture from the host's memory in a swapchain of its own, for a quad layer.
class XrPicture {
 public:
  /// Replaces the picture; of another size its swapchain, too. Waits for the copy. Throws vk::SystemError.
  [[nodiscard]] XrResult set(const XrCalls& calls, XrSession session, Context& context, vk::Format format,
                             const Image& picture);
  void destroy();
  /// Whether it has one.
  [[nodiscard]] bool made() const noexcept { return shown_; }
  [[nodiscard]] XrCompositionLayerQuad on(const RoomPanel& panel, XrSpace room) const noexcept;

 private:
  XrImages images_;
  bool shown_ = false;
  bool opaque_ = true;
};

}  // namespace fettle::render
