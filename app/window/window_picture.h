#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <glm/vec2.hpp>

#include "app/window/camera_motion.h"
#include "app/window/frame_budget.h"
#include "app/window/picture_at_rest.h"
#include "app/window/picture_rehearsal.h"
#include "app/window/refinement.h"
#include "app/window/settings.h"
#include "app/window/sharp_later.h"
#include "app/work/visible_part.h"
#include "engine/field/sample_rect.h"
#include "haptic/loop/timing.h"
#include "render/live/live_picture.h"
#include "render/window/window.h"

namespace fettle::app {

/// Statistics of drawing.
struct DrawFigures {
  double last_ms = 0.0;  ///< of the main thread
  haptic::TimingHistogram times;
  std::int64_t tiles_uploaded = 0;
  std::int64_t bytes_uploaded = 0;
};

/// The picture of the field in the window: what it shows, whether and how finely the next frame draws it, and
/// what is under a position of it. It is lost with a graphics device and created again.
///
/// Positions are pixels of the window's frame. Threading: main.
class WindowPicture {
 public:
  using Clock = Refinement::Clock;
  /// Text of the decorations over that of a picture [render::layOut], at scale 1 of the display: 13 pixels, a
  /// little smaller than that of the panels.
  static constexpr double kDecorations = 0.87;

  explicit WindowPicture(render::Window& window) : window_(window) {}
  WindowPicture& operator=(WindowPicture&&) = delete;
  ~WindowPicture() { lose(); }

  /// Creates it with the window's device; its content is uploaded again. Errors: LivePicture::create.
  [[nodiscard]] engine::Status make();
  void lose() {
    rehearsal_.end();
    live_.reset();
  }
  [[nodiscard]] bool made() const noexcept { return live_ != nullptr; }
  /// Whether other pictures of what is shown were drawn beforehand (PictureRehearsal), as far as that goes.
  [[nodiscard]] bool rehearsed() const noexcept { return rehearsal_.done(); }
  /// Another field follows: shows nothing.
  void clear();

  /// Somebody uses the window.
  void noteHand() noexcept { hand_ = Clock::now(); }
  /// Whether frames with nothing to draw are used for a rehearsal.
  [[nodiscard]] bool rehearsing() const noexcept { return rehearsal_.drawsNext(); }
  void requestRedraw() noexcept { needs_redraw_ = true; }
  void skipRedraw() noexcept { needs_redraw_ = results_wait_ = false; }
  /// Whether something must be drawn without waiting.
  [[nodiscard]] bool active() const noexcept {
    return needs_redraw_ || results_wait_ || motion_.sharpPending() || figures_.upload.pending_tiles > 0 ||
           figures_.bands_left > 0;
  }
  /// Whether a preview is being computed. Frames that show nothing else than more of it leave as much time as they take: they slow
  /// down what they wait for, and a key waits for the one that is being drawn. Whole frames meanwhile have a FrameBudget of their own: to
  /// be said once results are taken, and the same until noteFrame().
  void computes(bool previews) noexcept;
  /// How long nothing has to be drawn although active() [s].
  [[nodiscard]] double restsFor_s() const noexcept {
    const bool only_results = !needs_redraw_ && !motion_.sharpPending() && figures_.bands_left == 0 &&
                              figures_.upload.pending_of_first == 0;
    return computes_ && only_results
               ? std::max(0.0, std::chrono::duration<double>(results_due_ - Clock::now()).count())
               : 0.0;
  }
  [[nodiscard]] bool refining() const noexcept { return refinement_.pending() || sharp_later_.pending(); }
  /// Whether frames are left until the picture has four rays per pixel.
  [[nodiscard]] bool smoothing() const noexcept { return smooth_at_rest_ && at_rest_.pending(); }
  /// Whether it gets them at rest.
  void smoothAtRest(bool wanted) noexcept;

  /// Sets the view's size to that of the picture's area.
  void fit(render::View& view);
  /// Shows this from now on. Errors: LivePicture::update; the content stays as it was.
  [[nodiscard]] engine::Status show(render::Shown shown);
  /// The resolution of a frame of this view, drawn now; `held`: by a button, so that the movement may
  /// continue.
  [[nodiscard]] render::Sharpness sharpness(const render::View& view, bool held);
  /// Whether drawing adapts to the time it takes (FrameBudget).
  void adapt(bool wanted) noexcept { adapts_ = wanted; }
  /// Whether whole frames may have half the resolution while they take long.
  void allowHalf(bool wanted) noexcept { may_be_half_ = wanted; }
  /// Whether what costs most of a frame in which only a brush works is to be left out.
  [[nodiscard]] bool spares() const noexcept { return adapts_ && strokes_.less(); }
  /// The frame that was begun with this picture took so long until it was passed to the window system.
  void noteFrame(double ms) noexcept;
  enum class Draws : std::uint8_t { kCoarse, kRefined };
  /// Whether a frame is due; if so, it must be drawn now.
  [[nodiscard]] bool takeDue(Draws draws);
  /// Draws the next frame, with the vertices that are due when it is refined. Returns whether it was drawn;
  /// `status`: the reason if not, unless the window reports it.
  [[nodiscard]] bool draw(render::FrameInput input, Draws draws, std::string& status);
  /// Computes the ranges of colours again.
  void refreshRanges();
  /// LivePicture::refreshColours().
  void refreshColours();

  [[nodiscard]] const render::Shown& shown() const noexcept { return shown_; }
  [[nodiscard]] bool empty() const noexcept { return shown_.versions.empty(); }
  /// How the last frame showed marks.
  [[nodiscard]] render::MarksLook marksLook() const noexcept {
    return look_ ? look_->marks_look : render::MarksLook::kTint;
  }
  /// Of the last frame.
  [[nodiscard]] render::Sharpness drawnSharpness() const noexcept { return drawn_sharpness_; }
  [[nodiscard]] const render::FrameStatistics& figures() const noexcept { return figures_; }
  [[nodiscard]] const DrawFigures& drawFigures() const noexcept { return draw_figures_; }
  [[nodiscard]] double pixelsPerMm() const noexcept { return figures_.pixels_per_mm; }
  [[nodiscard]] double mmPerPixel() const noexcept {
    return figures_.pixels_per_mm > 0.0 ? 1.0 / figures_.pixels_per_mm : 0.0;
  }

  /// Whether the position is in the picture and not on a panel.
  [[nodiscard]] bool inside(double x, double y) const;
  /// The surface at that position; nothing while the device is lost.
  [[nodiscard]] std::optional<render::Picked> pick(double x, double y) const;
  /// The level plane at that position, of `height` or of the middle one of `field` [mm].
  [[nodiscard]] std::optional<glm::dvec2> levelAt(const glm::dvec2& pixel, const engine::Version& field,
                                                  const render::View& view,
                                                  std::optional<double> height = std::nullopt) const;
  /// The surface, and where there is none the plane at half the height of `field` [mm].
  [[nodiscard]] std::optional<glm::dvec2> fieldAt(const glm::dvec2& pixel, const engine::Version& field,
                                                  const render::View& view) const;
  /// Where a place of the field [mm] is seen in the first plot; nothing while there is no picture.
  [[nodiscard]] std::optional<glm::dvec2> placeOf(const glm::dvec3& field_mm) const;
  /// What a hand takes hold of at that position (LivePicture::grip); nothing while there is no picture.
  [[nodiscard]] std::optional<render::Grip> grip(double x, double y) const;
  /// The same in the middle of the first plot.
  [[nodiscard]] std::optional<render::Grip> gripInMiddle() const;
  /// How the view becomes the camera of the first plot.
  [[nodiscard]] std::optional<render::Framing> framing() const;
  /// The visible part of the field, with which processing should begin.
  [[nodiscard]] engine::FieldView seenPart(const engine::Grid& grid, const render::View& view) const;
  /// The samples of a field of this grid that are visible, by some hundred places of the picture; empty where none is.
  [[nodiscard]] engine::SampleRect seenRect(const engine::Grid& grid) const;
  /// Position of the first plot in the window's frame.
  [[nodiscard]] render::Rectangle plot(const render::View& view, const Display& display) const;
  /// Whether two versions share one plot, with a line between them.
  [[nodiscard]] bool hasSplitLine(const Display& display) const;

 private:
  [[nodiscard]] bool drawsLess(bool changes_whole, Refinement::Clock::time_point now) const noexcept;
  [[nodiscard]] bool samplesCome() const noexcept;
  void tellOfWhole(double ms) noexcept;
  [[nodiscard]] bool measuresFirst(Refinement::Clock::time_point now);
  [[nodiscard]] std::vector<Seen> seenPlaces(const engine::Grid& grid) const;

  render::Window& window_;
  std::unique_ptr<render::LivePicture> live_;
  render::Shown shown_;
  render::FrameStatistics figures_;  // of the last frame
  CameraMotion motion_;
  Refinement refinement_;
  PictureAtRest at_rest_;
  bool smooth_at_rest_ = false;
  bool only_rest_asked_ = false;  // for the frame that is due
  bool needs_redraw_ = true;
  bool computes_ = false;
  bool results_wait_ = false;               // more of a preview is to be drawn
  Clock::time_point results_due_;           // when
  std::optional<render::FrameInput> look_;  // of the last frame, without overlays
  bool adapts_ = true, may_be_half_ = true;
  FrameBudget moving_, strokes_{FrameBudget::kSlowStroke_ms, FrameBudget::kQuickStroke_ms},
      whole_alone_ = FrameBudget::ofWhole(), whole_beside_ = FrameBudget::ofWhole();
  // Of frames that change as a whole: a preview that is computed takes its share, and the first key beside it must not find that out.
  [[nodiscard]] FrameBudget& wholeFrames() noexcept { return computes_ ? whole_beside_ : whole_alone_; }
  [[nodiscard]] const FrameBudget& wholeFrames() const noexcept {
    return computes_ ? whole_beside_ : whole_alone_;
  }
  SharpLater sharp_later_;
  bool results_came_ = false;  // of a preview, for the next frame
  // What the frame that is being shown is measured for.
  enum class Measured : std::uint8_t {
    kNothing,
    kMoving,
    kStroke,
    kWhole,
    kWholeWithLess
  } measured_ = Measured::kNothing;
  double bands_ms_ = 0.0;  // of the bands of one sharp picture
  render::Sharpness drawn_sharpness_ = render::Sharpness::kFull;
  Clock::time_point drawn_;  // the last frame
  Clock::time_point hand_;   // the last input
  bool drew_ = false;        // the frame that is not noted yet
  DrawFigures draw_figures_;
  bool rehearses_ = false;  // what is shown; begun
  PictureRehearsal rehearsal_;
};

}  // namespace fettle::app
