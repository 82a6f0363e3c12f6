#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <glm/vec2.hpp>

#include "app/window/camera_motion.h"
#include "app/window/refinement.h"
#include "app/window/settings.h"
#include "engine/field/tile_range.h"
#include "haptic/loop/timing.h"
#include "render/live/live_picture.h"
#include "render/window/window.h"

namespace fettle::app {

/// What drawing took so far.
struct DrawFigures {
  double last_ms = 0.0;  ///< of the main thread
  haptic::TimingHistogram times;
  std::int64_t tiles_uploaded = 0;
  std::int64_t bytes_uploaded = 0;
};

/// The picture of the field in the window: what it shows, whether and how finely the next frame draws it, and
/// what lies under a place of it. It goes with a graphics device that is lost and is made again.
///
/// Places are pixels of the window's frame. Threading: main.
class WindowPicture {
 public:
  /// Text of the decorations over that of a picture [render::layOut], at scale 1 of the display: 13 pixels, a
  /// little smaller than that of the panels.
  static constexpr double kDecorations = 0.87;

  explicit WindowPicture(render::Window& window) : window_(window) {}

  /// Makes it with the window's device; whatever was shown is uploaded again. Errors: LivePicture::create.
  [[nodiscard]] engine::Status make();
  void lose() { live_.reset(); }
  [[nodiscard]] bool made() const noexcept { return live_ != nullptr; }
  /// Another field follows: nothing is shown.
  void clear();

  void requestRedraw() noexcept { needs_redraw_ = true; }
  void skipRedraw() noexcept { needs_redraw_ = false; }
  /// Something is to be drawn without waiting.
  [[nodiscard]] bool active() const noexcept {
    return needs_redraw_ || motion_.sharpPending() || figures_.upload.pending_tiles > 0;
  }
  [[nodiscard]] bool refining() const noexcept { return refinement_.pending(); }

  /// The view is as large as the place it is drawn to.
  void fit(render::View& view);
  /// From now on shows this. Errors: LivePicture::update; it shows what it showed.
  [[nodiscard]] engine::Status show(render::Shown shown);
  /// How sharp a frame of this view is, drawn now; `held`: by a hand that may go on.
  [[nodiscard]] render::Sharpness sharpness(const render::View& view, bool held);
  enum class Draws : std::uint8_t { kCoarse, kRefined };
  /// Whether a frame is due; if so, it is to be drawn now.
  [[nodiscard]] bool takeDue(Draws draws);
  /// Draws the next frame, with the vertices that are due when it is refined. Whether it was drawn; `status`:
  /// why not, where the window does not say so itself.
  [[nodiscard]] bool draw(render::FrameInput input, Draws draws, std::string& status);
  /// Works out the ranges of colours again.
  void refreshRanges();

  [[nodiscard]] const render::Shown& shown() const noexcept { return shown_; }
  [[nodiscard]] bool empty() const noexcept { return shown_.versions.empty(); }
  [[nodiscard]] const render::FrameStatistics& figures() const noexcept { return figures_; }
  [[nodiscard]] const DrawFigures& drawFigures() const noexcept { return draw_figures_; }
  [[nodiscard]] double pixelsPerMm() const noexcept { return figures_.pixels_per_mm; }
  [[nodiscard]] double mmPerPixel() const noexcept {
    return figures_.pixels_per_mm > 0.0 ? 1.0 / figures_.pixels_per_mm : 0.0;
  }
  /// The view came nearer by a factor, without a frame yet: the next move starts from there.
  void zoomed(double factor) noexcept { figures_.pixels_per_mm *= factor; }

  /// Whether the picture is there and panels are not.
  [[nodiscard]] bool inside(double x, double y) const;
  /// The surface there; nothing while the device is lost.
  [[nodiscard]] std::optional<render::Picked> pick(double x, double y) const;
  /// The same; where there is no surface, the plane at half the height of `field` [mm].
  [[nodiscard]] std::optional<glm::dvec2> fieldAt(const glm::dvec2& pixel, const engine::Version& field,
                                                  const render::View& view) const;
  /// The part of the field that work should begin with, since it is seen.
  [[nodiscard]] std::vector<engine::TileRange> seenPart(const engine::Grid& grid,
                                                        const render::View& view) const;
  /// Where the first plot is, in the window's frame.
  [[nodiscard]] render::Rectangle plot(const render::View& view, const Display& display) const;
  /// Whether two versions share it, with a line between them.
  [[nodiscard]] bool hasSplitLine(const Display& display) const;

 private:
  render::Window& window_;
  std::unique_ptr<render::LivePicture> live_;
  render::Shown shown_;
  render::FrameStatistics figures_;  // of the last frame
  CameraMotion motion_;
  Refinement refinement_;
  bool needs_redraw_ = true;
  DrawFigures draw_figures_;
};

}  // namespace fettle::app
