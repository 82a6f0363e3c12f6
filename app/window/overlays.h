#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include <glm/vec2.hpp>

#include "app/window/settings.h"
#include "app/window/stylus_trail.h"
#include "app/work/loop_client.h"
#include "app/work/place_tool.h"
#include "app/work/section_tool.h"
#include "app/xr/room_tip.h"
#include "render/live/live_picture.h"

namespace fettle::app {

/// The view of a place from the direction of `view`, so near that its edge can be followed.
[[nodiscard]] render::View viewOfPlace(const render::View& view, const render::Framing& framing,
                                       const engine::FieldReader& reader, const engine::WorthPlace& place);

/// The places where a line by hand is worth most, in the picture: lines along them, the present one with discs at its
/// ends; open, done and skipped ones each in a colour. Threading: main.
class PlaceOverlay {
 public:
  /// Adds them to the overlays of the next frame, with pieces of about three pixels or longer. They are computed again
  /// where the places, the field or that length differ from the last frame's.
  void append(const engine::Version& field, const PlaceTool& places, double mm_per_pixel,
              render::Overlays& overlays);

 private:
  engine::Version of_;
  std::uint64_t revision_ = 0;
  double mm_per_pixel_ = 0.0;
  std::vector<render::OverlayLine> pieces_;
};

/// The outline of what a step changed, on the surface.
void appendStepArea(const engine::Version& field, const engine::History& history, std::int64_t step,
                    render::Overlays& overlays);

/// Points of a plane on the surface [mm in field coordinates], with a line from each to the next.
void appendPoints(const engine::Version& field, std::span<const glm::dvec2> points_mm,
                  render::Overlays& overlays);

/// The lines of the sections in the picture, the chosen one with discs at its ends. Threading: main.
class SectionOverlay {
 public:
  /// Adds it to the overlays of the next frame, with pieces of about three pixels or longer.
  void append(const engine::Version& field, const SectionTool& section, double mm_per_pixel,
              render::Overlays& overlays);

 private:
  void addSection(const engine::FieldReader& reader, const glm::dvec2& spacing, const KeptSection& section,
                  bool chosen);

  engine::Version of_;
  std::uint64_t revision_ = 0;
  double mm_per_pixel_ = 0.0;
  std::vector<render::OverlayLine> pieces_;
};

/// The stylus in the picture: a pen, its shadow, force and trail, and the ring of the brush; and the force of the last
/// frames. Threading: main.
class StylusOverlay {
 public:
  /// Whether the drawn position differs from the actual one by more than a pixel.
  [[nodiscard]] bool moved(const haptic::LoopState& state, double mm_per_pixel) const;
  /// Adds it to the overlays of the next frame. A device that does not say how its stylus is held has a pen as a hand before
  /// the picture would hold it.
  /// `scale`: of the display and the user interface, with which pen and arrow grow.
  void append(const LoopClient& client, const haptic::LoopState& state, double mm_per_pixel, double scale,
              const StylusLook& look, render::Overlays& overlays);
  /// How the tip looks: its brush's ring, its ball, its colour.
  [[nodiscard]] static TipLook tipLookOf(const LoopClient& client);
  /// The same without its trail: for a picture beside the window's.
  static void appendTip(const LoopClient& client, const haptic::LoopState& state, double mm_per_pixel,
                        double scale, const StylusLook& look, render::Overlays& overlays);
  /// The next frame shows no stylus.
  void hide() noexcept { trail_.clear(); }
  /// Whether the picture changes with time alone.
  [[nodiscard]] bool fades() const noexcept { return !trail_.empty(); }
  /// The next frame shows this state, and `drawn`: it was drawn.
  void begin(const haptic::LoopState& state) { state_ = state; }
  void drawn();

  [[nodiscard]] const haptic::LoopState& state() const noexcept { return state_; }
  /// Of the last frames [N], oldest first.
  [[nodiscard]] const std::vector<float>& forces() const noexcept { return forces_; }

 private:
  haptic::LoopState state_;
  std::vector<float> forces_;
  StylusTrail trail_;
};

}  // namespace fettle::app
