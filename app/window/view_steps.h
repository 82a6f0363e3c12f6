#pragma once

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "app/texts/texts.h"
#include "app/window/action_steps.h"
#include "app/window/navigation.h"

/// What the actions of the menus View, Device and Help do: only for the table in actions.cpp, as action_steps.h.
namespace fettle::app::steps {

inline constexpr double kKey_px = 40.0;   ///< by which an arrow key moves the view
inline constexpr double kKey_deg = 10.0;  ///< by which it turns it

// --- View

template <bool Display::*flag>
void toggle(Parts& p) {
  p.settings.display.*flag = !(p.settings.display.*flag);
}
template <bool Display::*flag>
bool isOn(const Parts& p) {
  return p.settings.display.*flag;
}
inline bool hasCompared(const Parts& p) {
  return hasField(p) && p.compare.compared() != nullptr;
}
inline void compareWithScan(Parts& p) {
  ask(p, Question::Kind::kCompare, hasCompared(p) ? p.compare.compared()->path : p.document.path());
}
inline void compareAgain(Parts& p) {
  p.compare.again(clientOf(p));
}
// By its key until that is released (Input), from the menu until it is chosen again.
inline void showBefore(Parts& p) {
  p.shows_before = !p.shows_before;
}
inline bool showsBefore(const Parts& p) {
  return p.shows_before;
}
inline void deviation(Parts& p) {
  toggle<&Display::deviation>(p);
  p.picture.refreshRanges();
}
inline render::Theme other(render::Theme theme) {
  return theme == render::Theme::kDark ? render::Theme::kLight : render::Theme::kDark;
}
inline void theme(Parts& p) {
  p.settings.display.theme = other(p.settings.display.theme);
}
inline void panelsTheme(Parts& p) {
  p.settings.panels_theme = other(p.settings.panels_theme);
}
inline void takeNoticesAway(Parts& p) {
  p.feedback.notices.clear();
}
inline bool hasNotices(const Parts& p) {
  return !p.feedback.notices.empty();
}
inline bool panelsAreLight(const Parts& p) {
  return p.settings.panels_theme == render::Theme::kLight;
}
template <int degrees>
void turnLight(Parts& p) {
  float& azimuth = p.settings.display.light_azimuth_deg;
  azimuth = std::fmod(azimuth + static_cast<float>(degrees), 360.0F);
}
template <int degrees>
void liftLight(Parts& p) {
  float& elevation = p.settings.display.light_elevation_deg;
  elevation = std::clamp(elevation + static_cast<float>(degrees), 5.0F, 90.0F);
}
inline void lastStroke(Parts& p) {
  const engine::SampleRect rect = clientOf(p).lastRect();
  const auto framing = p.picture.framing();
  if (rect.empty() || !framing) return;
  const glm::dvec2 low(rect.column, rect.row), high = low + glm::dvec2(rect.columns, rect.rows);
  render::View view = p.view;
  Navigation::centreOn(view, *framing,
                       framing->sceneOf(middleOnSurface(clientOf(p).field().reader(), low, high)));
  p.flyTo(view);
}
template <int azimuth, int elevation>
void look(Parts& p) {
  render::View view = p.viewToCome();
  if (const auto grip = p.picture.gripInMiddle()) {
    Navigation::lookFrom(view, grip->framing, grip->point, azimuth, elevation);
  } else {
    view.azimuth_deg = azimuth;
    view.elevation_deg = elevation;
  }
  p.flyTo(view);
}
inline void projection(Parts& p) {
  using enum render::Projection;
  p.flight.stop();
  p.view.projection = p.view.projection == kOrthographic ? kPerspective : kOrthographic;
}
// About what is in the middle of the picture; it ends a flight.
void moveView(Parts& p, const auto& move) {
  p.flight.stop();
  if (const auto grip = p.picture.gripInMiddle()) move(*grip);
}
template <int x, int y>
void turn(Parts& p) {
  moveView(p, [&](const render::Grip& grip) {
    Navigation::turnAbout(p.view, grip.framing, grip.point, p.view.azimuth_deg - x * kKey_deg,
                          p.view.elevation_deg + y * kKey_deg);
  });
}
template <int x, int y>
void pan(Parts& p) {
  moveView(p, [&](const render::Grip& grip) {
    const glm::dvec2 at = grip.framing.camera(p.view).pixelOf(grip.point);
    Navigation::put(p.view, grip.framing, grip.point, at + kKey_px * glm::dvec2(x, y));
  });
}
template <int steps>
void zoom(Parts& p) {
  moveView(p, [&](const render::Grip& grip) { Navigation::zoomAt(p.view, grip.framing, grip.point, steps); });
}
template <std::size_t number>
void setBookmark(Parts& p) {
  p.bookmarks.set(number, p.viewToCome());
  p.document.keepViews(p.bookmarks.text());
  p.feedback.status = trFormat("view {} is set: F{} comes back to it", number + 1, number + 2);
}
template <std::size_t number>
void recallBookmark(Parts& p) {
  if (const auto& view = p.bookmarks.at(number))
    p.flyTo(*view);
  else
    p.feedback.status = trFormat("no view is set there: Shift+F{} sets this one", number + 2);
}
template <std::size_t number>
bool hasBookmark(const Parts& p) {
  return hasField(p) && p.bookmarks.at(number).has_value();
}
inline void fullScreen(Parts& p) {
  p.setFullScreen(!p.full_screen);
}
inline bool isFullScreen(const Parts& p) {
  return p.full_screen;
}
inline void enterPanels(Parts& p) {
  p.setFullScreen(false);
  p.settings.side_panel = true;
  p.enter_panels = true;
  p.window.enterPanels();
}
inline void nextMap(Parts& p) {
  if (ColourRange::quantityOf(p.picture.shown()) == render::Quantity::kDeviation)
    p.feedback.status =
        tr("what is shown has a sign: its colours are white at zero, and K chooses those of heights");
  else
    next(p.settings.display.map, 5);
}
inline void stereo(Parts& p) {
  next(p.settings.display.stereo, 3);
}
inline bool isStereo(const Parts& p) {
  return p.settings.display.stereo != render::StereoMode::kOff;
}
inline bool isLight(const Parts& p) {
  return p.settings.display.theme == render::Theme::kLight;
}
inline void mouseHabits(Parts& p) {
  next(p.settings.habits, static_cast<int>(kMousePresets.size()));
}
inline void viewAll(Parts& p) {
  render::View view = p.viewToCome();
  Navigation::showAll(view);
  p.flyTo(view);
}
inline void sidePanel(Parts& p) {
  // Out of the full screen, too: nobody has to know its own key.
  p.settings.side_panel = p.full_screen || !p.settings.side_panel;
  p.setFullScreen(false);
}
inline bool hasSidePanel(const Parts& p) {
  return p.settings.side_panel;
}

// --- Device, Help

inline void arm(Parts& p) {
  clientOf(p).arm();
}
inline void disarm(Parts& p) {
  clientOf(p).disarm();
}
// Without force: it is moved by hand.
inline void setUpDevice(Parts& p) {
  if (clientOf(p).device().profile().gives_force) clientOf(p).disarm();
  p.device_check.forget();
  p.device_setup = clientOf(p).deviceSetup();
  p.feedback.questions.ask({.kind = Question::Kind::kDevice});
}
inline void calibrate(Parts& p) {
  clientOf(p).calibrate();
}
inline void listShortcuts(Parts& p) {
  ask(p, Question::Kind::kShortcuts);
}

}  // namespace fettle::app::steps
