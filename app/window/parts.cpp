#include "app/window/parts.h"

#include <algorithm>
#include <filesystem>
#include <system_error>
#include <utility>

#include <fmt/format.h>

#include "app/terminal.h"
#include "app/texts/texts.h"
#include "app/window/axes_gizmo.h"

namespace fettle::app {
namespace {

// A session beside the scan whose name is free.
std::string freeSession(const ActiveDocument& document, const char* ending) {
  std::error_code none;
  std::string path = document.suggestedPath(fmt::format("{}.fettle", ending).c_str());
  for (int n = 2; std::filesystem::exists(path, none); ++n)
    path = document.suggestedPath(fmt::format("{}_{}.fettle", ending, n).c_str());
  return path;
}

}  // namespace

const engine::Grid* Parts::seenGrid() const {
  if (document.isOpen()) return &document.client()->field().grid();
  return opening.coarse() != nullptr ? &opening.coarse()->field.grid() : nullptr;
}

bool Parts::coarseIsShown() const {
  return opening.coarse() != nullptr && !document.isOpen() && !picture.empty();
}

bool Parts::announcesPicture() const {
  constexpr std::int64_t kAtOnce = std::int64_t{1} << 20;  // samples
  return document.isOpen() && picture.empty() && !opening.announced() &&
         document.client()->field().grid().samples() > kAtOnce;
}

bool Parts::held() const {
  return stylus.held() || marking.held() || drag.active();
}

void Parts::flyTo(const render::View& to) {
  flight.stop();
  const auto framing = settings.display.flies() ? picture.framing() : std::nullopt;
  render::View sized = to;
  sized.width = view.width;
  sized.height = view.height;
  if (!framing)
    view = sized;
  else if (!(sized == view))
    flight.begin(view, sized, *framing, Flight::Clock::now());
  picture.requestRedraw();
}

std::optional<Action> Parts::axisAt(const glm::dvec2& place) const {
  if (!settings.display.axes || seenGrid() == nullptr || !picture.inside(place.x, place.y))
    return std::nullopt;
  const AxesGizmo gizmo(view, picture.plot(view, settings.display), window.scale());
  const AxesGizmo::Ball* const ball = gizmo.under(place);
  return ball != nullptr ? ball->action : std::nullopt;
}

void Parts::showMarksMade() {
  const LoopClient* const client = document.client();
  if (client == nullptr) return;
  const engine::History& history = client->history();
  const std::int64_t now = history.number();
  const bool stroke = stylus.held() && haptic::isMarkTool(client->tool());
  const bool step =
      now > std::max(steps_seen, history.first()) && (history.info(now).kind == engine::StepKind::kMark ||
                                                      history.info(now).kind == engine::StepKind::kLines);
  steps_seen = now;
  if (!(stroke || step) || settings.display.marks) return;
  settings.display.marks = true;
  picture.requestRedraw();
}

void Parts::chooseTool(std::optional<haptic::Tool> tool) {
  marking.leaveLasso();
  plane_points.stop();
  stylus.choose(tool, *document.client(), picture, cursor);
}

void Parts::releaseHands() {
  drag.stop();
  line_drag.stop();
  section_drag.stop();
  radial.close();
  shows_before = false;
  marking.release();
  LoopClient* const client = document.client();
  if (client != nullptr) brush.leave(*client, feedback.notices);
  stylus.release(client);
}

void Parts::setFullScreen(bool on) {
  if (full_screen == on) return;
  full_screen = on;
  if (on) {
    leavePanels();
    window.enterFullScreen();
    status_before = std::exchange(feedback.status, tr("F11, Tab or Esc: back to the panels"));
  } else {
    window.leaveFullScreen();
    if (feedback.status == tr("F11, Tab or Esc: back to the panels"))
      feedback.status = std::move(status_before);
    status_before.clear();
  }
}

ScanOptions Parts::readingOf(const std::string& path) const {
  if (!scanOptionsText(usual_reading).empty()) return usual_reading;
  return files.readings.find(path).value_or(usual_reading);
}

void Parts::leavePanels() {
  enter_panels = false;
  window.leavePanels();
}

void Parts::dropCoarse() {
  if (!opening.dropCoarse() || document.isOpen()) return;
  window.clearPicture();
  picture.clear();
  flight.stop();
  drag.stop();
  line_drag.stop();
  section_drag.stop();
}

std::string Parts::scenePathToSave() const {
  return scene_files.path().empty() ? saving.suggestedPath(document, SceneFiles::kExtension)
                                    : scene_files.path();
}

void Parts::writeTransformed() {
  transform.write(*document.client(), picture.seenRect(document.client()->field().grid()),
                  freeSession(document, "_transformed"));
}

void Parts::writeJoined() {
  join.write(*document.client(), freeSession(document, "_joined"));
}

void Parts::closeDocument(SessionKeeper::Afterwards afterwards) {
  if (!document.isOpen()) return;
  releaseHands();
  flight.stop();
  bookmarks.clear();
  filters.finish(*document.client());
  suggester.clear();
  line_suggester.clear();
  form.clear();
  form.options.through.reset();
  plane_points.stop();
  heights.clear();
  removal.clear();
  measure.clear();
  if (auto kept = section.takeKept()) document.keepSections(*std::move(kept));
  section.reset();
  fit.clear();
  features.clear();
  transform.cancel();
  join.clear();
  compare.clear();
  marking.reset();
  change.cancel();
  colours.clear(settings.display);
  costs.reset();
  saving.dropWaiting();
  feedback.dropOfField();
  if (const auto closed = document.close(afterwards); !closed)
    warn(fmt::format("{}: what was not written is lost", closed.error().line()));
}

}  // namespace fettle::app
