#pragma once

#include <array>
#include <string>

#include "render/xr/room.h"
#include "render/xr/xr_calls.h"

namespace fettle::render {

[[nodiscard]] RoomPose roomPose(const XrPosef& pose) noexcept;
[[nodiscard]] XrPosef xrPose(const RoomPose& pose) noexcept;

/// The controllers: where they are, what is pressed, and their vibration. Bound to what the simple controller of the
/// specification has and to Touch controllers; runtimes map others to these.
class Hands {
 public:
  /// Makes and attaches the actions; once for a session.
  [[nodiscard]] XrResult make(const XrCalls& calls, XrInstance instance, XrSession session);
  void destroy();
  /// As of `time`, in `room`. Not tracked: one whose place is not seen but guessed, or no number; without the focus both.
  [[nodiscard]] XrResult read(XrSpace room, XrTime time, RoomHands& hands);
  /// 0 .. 1 until the next call, at most a tenth of a second; 0 stops it. Only 0 after 0 asks nothing of the runtime: any other is sent
  /// again, since it would end by itself.
  [[nodiscard]] XrResult vibrate(std::size_t hand, double amplitude);

 private:
  [[nodiscard]] XrResult suggest(const char* profile,
                                 const std::vector<std::pair<XrAction, std::string>>& bindings);
  [[nodiscard]] XrPath path(const std::string& text) const;

  const XrCalls* xr_ = nullptr;
  XrInstance instance_ = XR_NULL_HANDLE;
  XrSession session_ = XR_NULL_HANDLE;
  XrActionSet set_ = XR_NULL_HANDLE;
  XrAction grip_ = XR_NULL_HANDLE, aim_ = XR_NULL_HANDLE, trigger_ = XR_NULL_HANDLE,
           squeeze_ = XR_NULL_HANDLE, button_ = XR_NULL_HANDLE, scroll_ = XR_NULL_HANDLE,
           vibration_ = XR_NULL_HANDLE;
  struct Hand {
    XrPath path = XR_NULL_PATH;
    XrSpace grip = XR_NULL_HANDLE, aim = XR_NULL_HANDLE;
    double amplitude = 0.0;
  };
  std::array<Hand, 2> hands_;
};

}  // namespace fettle::render
