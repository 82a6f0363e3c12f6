#pragma once

#include <cstdint>
#include <map>
#include <string>

#include "app/sound/loudness.h"
#include "app/window/mouse_presets.h"
#include "app/window/pen_hold.h"
#include "app/work/device_setup.h"
#include "render/plan/picture.h"
#include "render/plan/stereo.h"

namespace fettle::app {

/// Which values the colours span.
struct RangeRule {
  enum class Kind : std::uint8_t {
    kAutomatic,  ///< found by the picture: render::PictureSpec::range
    kShare,      ///< the middle `share` of heights; of changes the smallest ones
    kAll,        ///< up to the extremes
    kTyped,      ///< by hand: of one scan, not stored
  };
  Kind kind = Kind::kAutomatic;
  double share = 0.95;  ///< 0.01 .. 1
};

/// How the stylus is drawn.
struct StylusLook {
  bool pen = true;     ///< a shaded pen (render::StylusBody); else a disc and a line
  bool shadow = true;  ///< of the pen
  bool force = true;   ///< an arrow
  bool trail = false;  ///< StylusTrail
};

/// Display settings, stored for the next start.
struct Display {
  bool marks = true;  ///< not stored, and shown in each scan: who does not see them marks blindly
  bool deviation = false;
  bool contours = false;
  bool split = true;
  double split_at = 0.5;
  render::ColourMap map = render::ColourMap::kAuto;
  RangeRule heights{}, changes{};  ///< while colours show heights; changes or deviations
  bool colour_steps = false;
  render::Theme theme = render::Theme::kDark;
  float marks_opacity = 0.65F;
  float light_azimuth_deg = 135.0F;
  float light_elevation_deg = 45.0F;
  bool decorations = true;
  bool axes = true;               ///< AxesGizmo
  bool flights = true;            ///< the view moves to another one (Flight) and does not jump there
  bool reduced_motion = false;    ///< no flights and no trail, whatever is said of these
  std::int64_t vertices = 65536;  ///< most vertices of a frame, 4096 .. 2^22
  render::FormShading form = render::kShownForm;
  bool half_in_motion = true;  ///< the picture is half as sharp while the view moves (CameraMotion)
  StylusLook stylus{};
  bool smooth_at_rest = true;  ///< four rays per pixel at rest (PictureAtRest)
  // Not stored: the next user may have no glasses.
  render::StereoMode stereo = render::StereoMode::kOff;
  float eye_separation = 1.0F / 30.0F;

  [[nodiscard]] bool flies() const noexcept { return flights && !reduced_motion; }
  [[nodiscard]] StylusLook stylusLook() const noexcept {
    StylusLook look = stylus;
    look.trail = look.trail && !reduced_motion;
    return look;
  }
};

/// Settings of the user: a JSON file in the settings folder.
struct Settings {
  Display display;
  Habits habits = Habits::kBlender;
  render::Theme panels_theme = render::Theme::kDark;  ///< of panels and dialogs
  double ui_scale = 0.0;  ///< factor on the size of text and panels, 0.5 .. 4; 0: the display's
  bool side_panel = true;
  float side_width = 0.0F;             ///< [pixels at scale 1]; 0: default
  std::map<std::string, bool> panels;  ///< which ones are open, by their names
  PenUse pen;                          ///< of a tablet
  bool draw_lines = true;              ///< strokes of the mark tool become edge lines
  Loudness loudness;                   ///< of scenes with sound
  DeviceSetups devices;                ///< that were set up on the page of the device
  bool ask_before_quitting = true;     ///< with work that is not saved; it is stored either way

  /// Reads a file written by save(). A value that is missing, of a wrong type or out of range keeps its
  /// default; a file that cannot be read gives the defaults.
  [[nodiscard]] static Settings load(const std::string& path);
  /// Writes all settings, completely or not at all; no effect for an empty path. A failure is not reported:
  /// the next start uses the old settings.
  void save(const std::string& path) const;

  friend bool operator==(const Settings& a, const Settings& b) { return a.text() == b.text(); }

 private:
  [[nodiscard]] std::string text() const;
};

}  // namespace fettle::app
