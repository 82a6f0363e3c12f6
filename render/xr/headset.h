#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "engine/base/error.h"
#include "render/plan/picture.h"
#include "render/xr/room.h"

namespace fettle::render {

class Context;
struct LiveTarget;

struct HeadsetOptions {
  Validation validation = Validation::kOff;
};

/// What a frame of a headset calls, in this order; all on the calling thread.
struct HeadsetFrame {
  /// The hands, as they will be when the frame is seen. Also called while nothing is drawn; with none while the session does not run,
  /// and in a frame in which the room's origin moves.
  std::function<void(const RoomHands&)> hands;
  /// Draws both eyes into the two layers of the target, in an image of Headset::colourFormat(). Called only where the
  /// picture is seen; empty: nothing is drawn yet. Headset::eyes() may be called by it, as late as it likes.
  std::function<engine::Status(LiveTarget&)> draw;
  /// Shown over the picture, in this order, where setPicture() gave them one. Called after `draw`; empty: none.
  std::function<std::vector<RoomPanel>()> panels;
};

/// A headset by OpenXR: a session, a Vulkan device that its runtime makes, an image of two layers for the eyes, the hands.
/// The loader's library is loaded by create() and by nothing else.
///
///   create() -> frame(), frame(), ... -> ended(), or an error: the runtime or the headset is lost
///
/// Threading: one thread, which waits in frame() for the headset's clock. The device is this thread's own.
class Headset {
 public:
  /// Keeps the loader from writing to standard error what create() says better. Sets an environment variable: to be called
  /// before the program has threads. $XR_LOADER_DEBUG of the user is left as it is.
  static void silenceLoader();
  /// Errors (kFailed): no OpenXR loader, no runtime (and where it was looked for), no headset, no suitable Vulkan device.
  [[nodiscard]] static engine::Result<std::unique_ptr<Headset>> create(const HeadsetOptions& options = {});
  ~Headset();
  Headset& operator=(Headset&&) = delete;

  [[nodiscard]] Context& context();
  /// The VkFormat of the eyes' images.
  [[nodiscard]] std::uint32_t colourFormat() const;
  /// Of one eye's picture [px].
  [[nodiscard]] int width() const;
  [[nodiscard]] int height() const;
  /// As the runtime calls it.
  [[nodiscard]] const std::string& name() const;
  /// Whether the room's origin is on the floor.
  [[nodiscard]] bool floor() const;

  /// Waits for the next frame and makes it; where the runtime wants none, waits a moment for its events. Errors (kFailed):
  /// the session is lost; those of the frame's draw.
  [[nodiscard]] engine::Status frame(const HeadsetFrame& frame);
  /// The eyes, left and right, as they will be when the frame is seen. Only within HeadsetFrame::draw.
  [[nodiscard]] std::array<RoomEye, 2> eyes();
  /// Of a hand (0 left, 1 right), 0 .. 1, for at most a tenth of a second: to be called in each HeadsetFrame::hands; 0 stops it.
  void vibrate(std::size_t hand, double amplitude);
  /// What panels with this picture show from now on; rows from the top, sRGB, with its opacity. Only within
  /// HeadsetFrame::draw. Errors (kFailed): the session is lost.
  [[nodiscard]] engine::Status setPicture(RoomPicture which, const Image& picture);

  /// Asks the runtime to end the session: frames follow until ended().
  void requestEnd();
  /// Whether the session was ended as asked, by the user or by requestEnd().
  [[nodiscard]] bool ended() const;
  /// Frames in which the eyes were drawn.
  [[nodiscard]] std::uint64_t framesDrawn() const;
  [[nodiscard]] std::vector<std::string> validationMessages() const;

 private:
  struct Impl;
  explicit Headset(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace fettle::render
