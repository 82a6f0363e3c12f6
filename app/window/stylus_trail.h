#pragma once

#include <chrono>
#include <deque>

#include <glm/vec3.hpp>

#include "render/live/live_picture.h"

namespace fettle::app {

/// The way of the stylus during the last second, thinner the longer ago; hidden by the surface in front of it.
/// Threading: main.
class StylusTrail {
 public:
  using Clock = std::chrono::steady_clock;
  static constexpr std::chrono::milliseconds kLasts{1000};

  /// The tip is here now [field mm]; what is left of its way becomes lines of the next frame. `mm_per_pixel`: shorter
  /// steps than one pixel are left out.
  void append(const glm::dvec3& tip_mm, double mm_per_pixel, Clock::time_point now,
              render::Overlays& overlays);
  void clear() noexcept { places_.clear(); }
  /// Whether the tip has been at one place alone for all that time: nothing is drawn.
  [[nodiscard]] bool empty() const noexcept { return places_.size() < 2; }

 private:
  struct Place {
    glm::dvec3 at_mm;
    Clock::time_point when;  // the tip was here last
  };
  std::deque<Place> places_;  // oldest first
};

}  // namespace fettle::app
