#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "render/plan/camera.h"
#include "render/vulkan/vulkan.h"

namespace fettle::render {

/// An image that a frame is drawn to: one of a swap chain, or off-screen.
struct LiveTarget {
  vk::Image image;
  vk::ImageView view;  ///< of all of `image`, in the format that LivePicture was created for
  vk::Extent2D extent;
  /// Layout of the image after the frame (ePresentSrcKHR for a swap chain).
  vk::ImageLayout leaves_as = vk::ImageLayout::ePresentSrcKHR;
  /// Of an image that only frames of one picture are drawn to, and that `leaves_as` until the next one: a number for each such image,
  /// by which a frame knows that the one before is in it, and writes only what differs. 0: the old content is discarded.
  std::uint64_t kept = 0;
  /// Frames add the places at which they differ from the one before, whoever uses the image takes them away.
  std::vector<Rectangle> changed{};
  /// Waited for before the image is written; null when it is free already.
  vk::Semaphore free;
  /// Signalled when the frame is in the image; null when not needed.
  vk::Semaphore done;
  /// Called while the frame is recorded, inside a rendering of only this image (colour attachment loaded, no
  /// depth), after the picture: for panels of a user interface. May be empty.
  std::function<void(vk::CommandBuffer)> over;
};

}  // namespace fettle::render
