#include "app/window/picture_rehearsal.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "engine/base/stopwatch.h"
#include "render/window/window.h"

namespace fettle::app {
namespace {

// Neither it nor half, a quarter or twice of it is a power of two, as windows are not: drivers of processors compile for
// images of such sides in another way.
constexpr int kSide_px = 78;
// Samples of a field of any size: 4 times what such a part of a picture can ask for.
constexpr std::int64_t kDeviceBytes = std::int64_t{128} << 20;
// Longer than what is compiled already can take: a hand would wait.
constexpr double kMostOfHand_ms = 250.0;
// Times of what shows all of a field: so near that the cells of the longest one are larger than a pixel and a half, from where on they are
// drawn in another way, and so far that those of all but the shortest are smaller.
constexpr double kNear = 1024.0, kFar = 64.0;

// The middle of the picture, in its own pixels: what cells are smaller than a pixel there are so here.
void takeMiddle(render::FrameInput& input) {
  const auto along = [](int side) {
    return std::pair{(side - std::min(side, kSide_px)) / 4 * 2, std::min(side, kSide_px)};
  };
  const auto [x, width] = along(input.view.width);
  const auto [y, height] = along(input.view.height);
  input.part = render::Rectangle{x, y, width, height};
}

// A pen in contact, a line through the surface and one over it.
void addStylus(const engine::Version& field, render::Overlays& overlays) {
  const engine::Grid& grid = field.grid();
  const glm::dvec3 middle{0.5 * (grid.width - 1) * grid.spacingXMm(),
                          0.5 * (grid.height - 1) * grid.spacingYMm(), 0.0};
  overlays.stylus = render::StylusBody{.tip_mm = middle};
  for (const auto depth : {render::OverlayLine::Depth::kInScene, render::OverlayLine::Depth::kOnTop})
    overlays.lines.push_back({.from_mm = middle, .to_mm = middle + glm::dvec3(1.0), .depth = depth});
}

render::LiveOptions smallOptions() {
  render::LiveOptions options;
  options.memory_budget_bytes = kDeviceBytes;
  return options;
}

}  // namespace

// What a few keys and a wheel make of this picture, the likeliest first; each while something moves and at rest.
std::vector<PictureRehearsal::Scene> PictureRehearsal::scenesOf(const render::Shown& shown,
                                                                const render::FrameInput& look) {
  Scene now{.input = look};
  takeMiddle(now.input);
  now.input.panel_vertices.clear();  // those were of the window's last frame
  std::vector<Scene> scenes;
  const auto add = [&scenes](Scene scene) {
    for (const render::Sharpness fewer : {render::Sharpness::kHalf, render::Sharpness::kQuarter}) {
      scene.input.sharpness = fewer;
      scenes.push_back(scene);
    }
    scene.input.sharpness = render::Sharpness::kFine;
    scenes.push_back(std::move(scene));
  };
  Scene pen = now;
  addStylus(shown.versions.front(), pen.input.overlays);
  add(pen);
  for (const bool other_projection : {false, true})
    for (const bool deviation : {false, true})
      for (const double zoom :
           {look.view.zoom, std::max(look.view.zoom, 1.0) * kNear, std::min(look.view.zoom, 1.0) / kFar})
        for (const bool contours : {false, true}) {
          Scene scene = now;
          if (other_projection)
            scene.input.view.projection = look.view.projection == render::Projection::kPerspective
                                              ? render::Projection::kOrthographic
                                              : render::Projection::kPerspective;
          scene.deviation = deviation;
          scene.input.view.zoom = zoom;
          if (contours) scene.input.contours = render::Contours::kShow;
          add(std::move(scene));
        }
  now.without_marks = true;
  add(std::move(now));
  return scenes;
}

render::Shown PictureRehearsal::Scene::of(render::Shown shown) const {
  if (deviation && !shown.original) shown.original = shown.versions.front();
  if (without_marks) shown.marks = render::MarksOverlay::kHide;
  return shown;
}

void PictureRehearsal::begin(render::LivePicture& window, render::Shown shown,
                             const render::FrameInput& look) {
  end();
  stage_ = std::make_shared<Stage>();
  stage_->window = window_ = &window;
  std::vector<Scene> scenes = scenesOf(shown, look);
  left_.assign(scenes.rbegin(), scenes.rend());
  versions_ = shown.versions.size();
  render::LiveOptions options = smallOptions();
  options.device = window.device();
  options.colour_format = render::Window::pictureFormat();
  work_.replace([options = std::move(options), scenes = std::move(scenes), shown = std::move(shown),
                 stage = stage_](engine::JobControl& job) -> engine::Result<Nothing> {
    const Done done(*stage, job);
    if (const auto picture = render::LivePicture::create(options))
      for (const Scene& scene : scenes) {
        if (job.cancelled()) return engine::cancelled();
        if ((*picture)->update(scene.of(shown))) (void)(*picture)->drawAndWait(scene.input);
        prepare(*stage, **picture);
      }
    return Nothing{};
  });
}

// One thing at a time: the window waits for no more than that when its picture ends.
void PictureRehearsal::prepare(Stage& stage, const render::LivePicture& rehearsed) {
  for (bool more = true; more;) {
    const std::scoped_lock lock(stage.mutex);
    more = stage.window != nullptr && stage.window->prepareNextOf(rehearsed);
  }
}

void PictureRehearsal::drawNext(const render::Shown& shown) {
  if (!drawsNext()) return;
  if (shown.versions.size() != versions_) left_.clear();  // another picture
  if (left_.empty()) return beside_.reset();
  if (!beside_)
    if (auto made = render::LivePicture::createBeside(*window_, smallOptions())) beside_ = std::move(*made);
  const engine::Stopwatch watch;
  if (beside_ && beside_->update(left_.back().of(shown))) (void)beside_->drawAndWait(left_.back().input);
  left_.pop_back();
  // A driver that keeps nothing compiles here: as well when a key asks for it.
  if (watch.ms() > kMostOfHand_ms) left_.clear();
  if (left_.empty()) beside_.reset();
}

void PictureRehearsal::end() noexcept {
  work_.cancel();
  left_.clear();
  beside_.reset();
  window_ = nullptr;
  const std::scoped_lock lock(stage_->mutex);
  stage_->window = nullptr;
}

}  // namespace fettle::app
