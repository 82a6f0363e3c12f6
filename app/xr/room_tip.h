#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <utility>

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "app/xr/room_hands.h"
#include "app/xr/room_table.h"
#include "haptic/devices/virtual/controller_stylus.h"
#include "render/live/live_picture.h"

namespace fettle::app {

/// How the tip of the hand looks, as the window knows it.
struct TipLook {
  double ring_mm = 0.0;         ///< radius of the brush's ring on the surface
  double ball_radius_mm = 0.0;  ///< of a ball tip; 0 for a point
  glm::vec3 colour{1.0F, 1.0F, 1.0F};
};

/// A controller as the tip: from its place in the room to the loop, and from what the loop says of it to its vibration and its
/// picture. Without a link the controllers are hands that hold and point, and no tip.
///
/// Threading: the headset's thread.
class RoomTip {
 public:
  explicit RoomTip(std::shared_ptr<haptic::ControllerLink> link) : link_(std::move(link)) {}

  /// The hands of a frame: publishes the one that may be the tip, in coordinates of the field of `reader` (ControllerHand::reader).
  void follow(const render::RoomHands& hands, const RoomHandUses& uses, const RoomTable& table,
              const render::Framing& framing, std::uint64_t reader);
  /// No hand is the tip: the session ends, or another program has the hands.
  void leave();
  /// What the hand is to be told by vibration now, 0 .. 1.
  [[nodiscard]] double vibration(std::size_t hand) const noexcept;
  /// Whether a hand touches or works, so that what it does is to be seen at once.
  [[nodiscard]] bool works() const noexcept;
  /// The hand that is the tip now.
  [[nodiscard]] std::optional<std::size_t> hand() const noexcept;

  /// Adds what the eyes see of hands and tip.
  void append(const render::RoomHands& hands, const RoomTable& table, const render::Framing& framing,
              const TipLook& look, render::Overlays& overlays) const;

 private:
  [[nodiscard]] bool leads() const noexcept { return link_ && link_->leads.load(std::memory_order_relaxed); }

  [[nodiscard]] bool jumps(const RoomTable& table, const render::Framing& framing);

  std::shared_ptr<haptic::ControllerLink> link_;
  std::optional<std::size_t> hand_;  // published
  // What a place of the room is on the field by.
  struct Coordinates {
    std::uint64_t placements = 0;
    glm::dvec2 first{0.0};
    double reference_mm = 0.0, exaggeration = 1.0;
    friend bool operator==(const Coordinates&, const Coordinates&) = default;
  };
  Coordinates coordinates_;
  std::uint64_t jumps_ = 0, press_ = 0;  // ControllerHand::press
  bool spent_ = false;                   // the press that goes on was before a jump
  bool pressed_ = false;
  haptic::Touched touched_;
};

}  // namespace fettle::app
