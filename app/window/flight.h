#pragma once

#include <chrono>

#include <glm/vec3.hpp>

#include "app/window/zoom_path.h"
#include "render/plan/framing.h"

namespace fettle::app {

/// A movement of the view to another one in a fraction of a second, so that the eye can follow what goes where. It
/// turns about the point that both views look at; between places it follows ZoomPath. A function of the time: a
/// slow device shows fewer pictures of it and ends as early. Any other movement of the view ends it where it is.
/// No cost while none is under way. Threading: main.
class Flight {
 public:
  using Clock = std::chrono::steady_clock;
  static constexpr std::chrono::milliseconds kTime{300};

  /// From a view to another of the same field. Where heights are not exaggerated alike, both would be seen on
  /// different surfaces: the other one follows immediately.
  void begin(const render::View& from, const render::View& to, const render::Framing& framing,
             Clock::time_point now);
  void stop() noexcept { active_ = false; }
  [[nodiscard]] bool active() const noexcept { return active_; }
  /// The view at its end; only while one is under way.
  [[nodiscard]] const render::View& destination() const noexcept { return to_; }
  /// Moves `view` to where it is now; at the end exactly to the destination, with the size of the picture kept.
  void follow(render::View& view, Clock::time_point now);

 private:
  [[nodiscard]] render::View at(double way) const;

  bool active_ = false;
  render::View from_, to_;
  render::Framing framing_;
  Clock::time_point begun_;
  double turn_deg_ = 0.0;
  // The points that are looked at, and how far in front of the middle of the picture they are.
  glm::dvec3 first_{0.0}, last_{0.0};
  double nearer_first_ = 0.0, nearer_last_ = 0.0;
  ZoomPath path_;
};

}  // namespace fettle::app
