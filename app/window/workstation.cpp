#include "app/window/workstation.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <thread>

#include <fmt/format.h>
#include <imgui.h>
#include <glm/geometric.hpp>

#include "app/terminal.h"

namespace fettle::app {
namespace {

constexpr double kIdle_s = 0.1;     // between two frames while nothing happens
constexpr double kBusy_s = 0.03;    // ... while only figures move
constexpr std::size_t kPlot = 240;  // frames of force shown

std::string layoutFile() {
  const std::string folder = settingsFolder();
  return folder.empty() ? std::string() : folder + "/layout.ini";
}
std::string settingsFile() {
  const std::string folder = settingsFolder();
  return folder.empty() ? std::string() : folder + "/window.json";
}

double ms(std::int64_t ns) {
  return 1e-6 * static_cast<double>(ns);
}

}  // namespace

Workstation::Workstation(const ViewOptions& options)
    : options_(options), recent_(recentFile()), settings_(Settings::load(settingsFile())) {
  saved_settings_ = settings_;
  display_ = settings_.display;
  habits_ = settings_.habits;
  side_panel_ = settings_.side_panel;
}

Workstation::~Workstation() {
  closeDocument(SessionKeeper::Afterwards::kKeep);
}

engine::Result<std::unique_ptr<Workstation>> Workstation::create(const ViewOptions& options) {
  std::unique_ptr<Workstation> station(new Workstation(options));
  render::WindowOptions window = options.window;
  window.layout_file = layoutFile();
  auto opened = render::Window::create(window);
  if (!opened) return tl::unexpected(opened.error());
  station->window_ = std::move(*opened);
  station->window_->setWhileWaiting([s = station.get()] { s->whileWaiting(); });
  if (const auto made = station->makePicture(); !made) return tl::unexpected(made.error());
  if (!options.events.empty()) {
    auto events = EventLog::open(options.events);
    if (!events) return tl::unexpected(events.error());
    station->events_ = *std::move(events);
  }
  station->view_.azimuth_deg = 330.0;
  if (!options.scan.empty()) station->open(options.scan);
  return station;
}

engine::Result<Report> Workstation::run(engine::JobControl& job) {
  const auto begin = std::chrono::steady_clock::now();
  while (!quit_ && !quit_unasked_) {
    goRound();
    if (!end_) return tl::unexpected(end_.error());
    if (window_->closeAsked()) {
      window_->refuseClose();
      act(Action::kQuit);
    }
    const double lived = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    if (job.cancelled() || (options_.seconds > 0.0 && lived >= options_.seconds)) break;
  }
  const Report report = this->report();
  // Who quits has saved what was to be saved. Else nobody was asked: unsaved work is there when the scan is
  // opened again.
  const bool kept = !quit_ && unsaved();
  const std::string path = path_;
  closeDocument(kept ? SessionKeeper::Afterwards::kKeep : SessionKeeper::Afterwards::kDiscard);
  if (kept) warn(fmt::format("{}: what was not saved is kept; open the scan again to go on with it", path));
  return report;
}

bool Workstation::active() const {
  return stale_ || !input_.empty() || camera_motion_.owesSharp() || stylus_held_ || drag_ != Drag::kNone ||
         figures_.upload.pending_tiles > 0;
}

// What a person chose is written when it has changed, at most once in some seconds.
void Workstation::rememberLayout() {
  constexpr std::uint64_t kFrames = 120;
  if (!quit_ && !quit_unasked_ && frames_ % kFrames != 0) return;
  Settings now = settings_;
  now.display = display_;
  now.habits = habits_;
  now.side_panel = side_panel_;
  if (now == saved_settings_) return;
  now.save(settingsFile());
  saved_settings_ = now;
}

void Workstation::goRound() {
  const bool working = mark_edit_.busy() || edges_.busy() || costs_.busy() || loading_.busy() ||
                       saving_.busy() || filters_.computing() || filters_.applying() ||
                       (touch_ && refinement_.owed());
  window_->poll(active() ? 0.0 : working ? kBusy_s : kIdle_s);
  whileWaiting();
  handleInput();
  for (const std::string& path : window_->takeDrops()) {
    ++hands_.drops;
    askToOpen(path);
  }
  takeResults();
  if (!picture_ || window_->displayLost()) {
    // Nothing to draw with: touch and workers go on.
    renewPicture();
    return;
  }
  if (window_->minimised()) {
    // Nothing to draw, everything else goes on.
    tell();
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
    return;
  }
  frame();
}

// Also called again and again while the device draws: the cursor goes on to the loop, and what the loop tells
// is taken off its ring.
void Workstation::whileWaiting() {
  window_->poll(0.0);
  for (const render::InputEvent& event : window_->takeInput()) {
    const bool at_once = std::none_of(input_.begin(), input_.end(), [](const Pending& p) {
      return p.event.kind == render::InputKind::kKeyDown;
    });
    disarmAtOnce(event);
    if (at_once) toStylus(event);
    input_.push_back({event, at_once});
  }
  if (touch_) touch_->poll();
}

void Workstation::takeResults() {
  takeCoarse();
  if (auto done = loading_.take()) {
    if (!*done) dropCoarse();
    if (*done) {
      takeDocument(std::move(**done));
    } else if (!touch_ && loading_path_ == options_.scan &&
               done->error().kind != engine::ErrorKind::kCancelled) {
      // Named on the command line: its errors are the command's.
      end_ = tl::unexpected(done->error());
      return;
    } else if (done->error().kind != engine::ErrorKind::kCancelled) {
      message(done->error().line(), "");
    }
    stale_ = true;
  }
  if (keeper_) keeper_->poll();
  takeSaved();
  if (!touch_) return;
  touch_->poll();
  if (auto older = keeper_->older()) {
    if (*older) {
      touch_->prepend(**older);
      touch_->undo();
    } else {
      notices_.push_back({older->error().what, older->error().remedy});
    }
  }
  lookAfterSession();
  if (filters_.poll(*touch_, notices_)) stale_ = true;
  pollMarking();
  for (Notice& notice : touch_->takeNotices()) notices_.push_back(std::move(notice));
  while (notices_.size() > 6) notices_.erase(notices_.begin());
  if (change_.poll(*touch_)) stale_ = true;
  for (const engine::Error& error : costs_.poll()) notices_.push_back({error.line(), ""});
  if (auto done = measuring_.take(); done && *done) deviation_ = **done;
  const engine::Version now = touch_->upright();
  if (!measuring_.busy() && !(measured_ == now) && !stylus_held_) {
    measured_ = now;
    measuring_.start([original = touch_->original(), now](engine::JobControl& job) {
      return engine::compareFields(original, now, job);
    });
  }
}

void Workstation::frame() {
  ImGui::GetIO().DisplaySize =
      ImVec2(static_cast<float>(window_->width()), static_cast<float>(window_->height()));
  const std::optional<std::int64_t> edit = touch_ ? touch_->latency().takeUnshownEdit() : std::nullopt;
  window_->beginFrame();
  panels();
  const bool announces = announcesPicture();
  if (touch_ && !announces) drawPicture();
  if (!touch_ && coarse_) drawCoarse();
  if (!touch_ && !coarse_) stale_ = false;  // there is no picture to make
  const auto shown = window_->present();
  if (!shown) {
    losePicture(shown.error());
    return;
  }
  if (touch_ && edit && shown->shown_ns > 0) touch_->latency().noteShown(*edit, shown->shown_ns);
  ++frames_;
  opening_.announced = opening_.announced || announces;
  noteOpening();
  rememberLayout();
  tell();
}

double Workstation::Opening::sinceAsked() const {
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - asked).count();
}

// The first picture of a large field takes the main thread some seconds: a frame before it says so.
bool Workstation::announcesPicture() const {
  constexpr std::int64_t kAtOnce = std::int64_t{1} << 20;  // samples
  return touch_ && shown_.versions.empty() && !opening_.announced &&
         touch_->field().grid().samples() > kAtOnce;
}

// After a frame was shown.
void Workstation::noteOpening() {
  if (coarseIsShown() && opening_.coarse_ms == 0.0) {
    opening_.coarse_ms = opening_.sinceAsked();
    coarse_slot_->shown();
  }
  if (!touch_ || shown_.versions.empty()) return;
  if (opening_.seen_ms == 0.0) opening_.seen_ms = opening_.sinceAsked();
  if (opening_.whole_ms == 0.0 && figures_.upload.pending_tiles == 0)
    opening_.whole_ms = opening_.sinceAsked();
}

// The view is as large as the place it is drawn to.
void Workstation::followArea() {
  const render::Rectangle& area = window_->pictureArea();
  if (view_.width != area.width || view_.height != area.height) stale_ = true;
  view_.width = area.width;
  view_.height = area.height;
}

// How sharp the next frame is; one that owes a sharp one after it has to be drawn.
render::Sharpness Workstation::seeMotion() {
  const bool owed = camera_motion_.owesSharp();
  const render::Sharpness sharpness =
      camera_motion_.see(view_, drag_ != Drag::kNone, CameraMotion::Clock::now());
  if (owed && !camera_motion_.owesSharp()) stale_ = true;
  return sharpness;
}

// What the user chose.
render::FrameInput Workstation::frameInput(render::Sharpness sharpness) const {
  render::FrameInput input;
  input.view = view_;
  input.vertex_budget = display_.vertices;
  input.arrangement = display_.split && shown_.versions.size() == 2 ? render::Arrangement::kSplit
                                                                    : render::Arrangement::kSideBySide;
  input.split = display_.split_at;
  input.contours = display_.contours ? render::Contours::kShow : render::Contours::kHide;
  input.marks_opacity = display_.marks_opacity;
  input.map = display_.map;
  input.stereo.mode = display_.stereo;
  input.stereo.eye_separation = static_cast<double>(display_.eye_separation);
  input.theme = display_.theme;
  if (display_.half_in_motion && !options_.sharp_motion) input.sharpness = sharpness;
  input.furniture_scale = kFurniture * window_->scale();
  input.decoration = display_.furniture ? render::Decoration::kFull : render::Decoration::kNone;
  input.light_azimuth_deg = display_.light_azimuth_deg;
  input.light_elevation_deg = display_.light_elevation_deg;
  return input;
}

// Whether it was drawn.
bool Workstation::submit(const render::FrameInput& input) {
  const auto start = std::chrono::steady_clock::now();
  const auto target = window_->pictureTarget();
  if (!target) return false;  // present() tells
  const auto figures = picture_->draw(input, **target);
  if (!figures) {
    if (window_->usable()) status_text_ = figures.error().line();
    return false;
  }
  const auto took = std::chrono::steady_clock::now() - start;
  figures_ = *figures;
  frame_ms_ = std::chrono::duration<double, std::milli>(took).count();
  frame_times_.add(std::chrono::duration_cast<std::chrono::nanoseconds>(took).count());
  tiles_uploaded_ += figures_.upload.tiles;
  bytes_uploaded_ += figures_.upload.bytes;
  return true;
}

// Of what can be turned and zoomed; null when there is nothing.
const engine::Grid* Workstation::seenGrid() const {
  if (touch_) return &touch_->field().grid();
  return coarse_ ? &coarse_->field.grid() : nullptr;
}

void Workstation::drawPicture() {
  const haptic::LoopState state = touch_->state();
  const double moved = glm::length(state.endpoint_mm - drawn_state_.endpoint_mm);
  const double pixel_mm = figures_.pixels_per_mm > 0.0 ? 1.0 / figures_.pixels_per_mm : 0.0;
  if (moved > pixel_mm || state.contact != drawn_state_.contact) stale_ = true;
  followArea();

  render::Shown shown;
  shown.versions.push_back(edges_.over(touch_->field()));
  // All of one sign: the loop inverts the field some ticks after the scene was changed, and a preview may
  // have been computed before that.
  const float sign = shown.versions.front().reader().sign();
  const auto likeField = [sign](const engine::Version& v) {
    return v.reader().sign() == sign ? v : v.inverted();
  };
  const std::vector<FilterPreview::Picture> pictures = filters_.pictures();
  for (const FilterPreview::Picture& picture : pictures) shown.versions.push_back(likeField(picture.field));
  if (display_.deviation) shown.original = likeField(touch_->original());
  shown.marks = display_.marks ? render::MarksOverlay::kShow : render::MarksOverlay::kHide;
  if (edges_.suggestion() != nullptr) shown.accepted = touch_->field();
  const bool same = shown.versions == shown_.versions && shown.original == shown_.original &&
                    shown.marks == shown_.marks && shown.accepted == shown_.accepted;
  if (!same) {
    if (const auto status = picture_->update(shown); !status) {
      // Of a lost device present() tells.
      if (window_->usable()) message(status.error().line(), "");
      return;
    }
    shown_ = std::move(shown);
    stale_ = true;
  }
  const render::Sharpness sharpness = seeMotion();
  const auto now = Refinement::Clock::now();
  if (sharpness == render::Sharpness::kHalf) refinement_.restart(now);  // the view moves
  if (!stale_ && figures_.upload.pending_tiles == 0 && !refinement_.due(now)) return;
  stale_ = false;

  render::FrameInput input = frameInput(sharpness);
  input.panel_vertices = refinement_.vertices(input.vertex_budget, shown_.versions.size(), now);
  if (shown_.versions.size() > 1) {
    input.titles.emplace_back("as it is");
    for (const FilterPreview::Picture& picture : pictures) input.titles.push_back(picture.title);
    // One plot has room for one title.
    if (input.arrangement == render::Arrangement::kSplit)
      input.titles = {fmt::format("left: as it is, right: {}", input.titles[1]), ""};
  }
  const bool stylus = tool_on_ || touch_->mouse() == nullptr;
  if (stylus && state.link == haptic::LinkState::kConnected) {
    const haptic::Scene& scene = touch_->scene();
    const engine::Grid& grid = touch_->field().grid();
    render::StylusState tip;
    tip.endpoint_mm = state.endpoint_mm;
    tip.proxy_mm = state.proxy_mm;
    tip.force_n = state.force_n;
    tip.contact = state.contact;
    if (scene.tip == haptic::TipShape::kSphere) tip.tip_radius_mm = scene.tip_radius_mm;
    // The largest force is an arrow of sixty pixels.
    render::appendStylus(tip, 60.0 * pixel_mm / scene.force_limit_n, input.overlays.lines);
    const bool marking = touch_->tool() == haptic::Tool::kMark || touch_->tool() == haptic::Tool::kUnmark;
    const double radius = marking ? scene.mark_radius_samples : scene.brush_radius_samples;
    render::Overlays::Ring ring;
    ring.x_mm = state.contact ? state.proxy_mm.x : state.endpoint_mm.x;
    ring.y_mm = state.contact ? state.proxy_mm.y : state.endpoint_mm.y;
    ring.radius_mm = std::max(radius, 0.5) * std::max(grid.spacingXMm(), grid.spacingYMm());
    ring.colour = marking ? glm::vec3{1.0F, 0.55F, 0.0F} : glm::vec3{1.0F, 1.0F, 1.0F};
    input.overlays.rings.push_back(ring);
  }
  drawn_state_ = state;
  if (!submit(input)) return;
  refinement_.drawn({.whole = figures_.redrawn == 1.0,
                     .continued = figures_.continued,
                     .tiles_coming = figures_.upload.pending_tiles > figures_.residency.pages_waiting,
                     .pages_coming = figures_.residency.pages_waiting > 0},
                    Refinement::Clock::now());
  force_plot_.push_back(static_cast<float>(glm::length(state.force_n)));
  if (force_plot_.size() > kPlot) force_plot_.erase(force_plot_.begin());
  touch_->setView(view_.azimuth_deg, view_.zoom);
}

Report Workstation::report() const {
  Report r{{"device", window_->device()}, {"frames", frames_}};
  const haptic::TimingFigures frame = frame_times_.figures();
  r["frame_p50_ms"] = ms(frame.p50_ns);
  r["frame_p99_ms"] = ms(frame.p99_ns);
  r["tiles_uploaded"] = tiles_uploaded_;
  r["bytes_uploaded"] = bytes_uploaded_;
  if (touch_) {
    r["open_coarse_picture_ms"] = opening_.coarse_ms;
    r["open_read_ms"] = opening_.read_ms;
    r["open_touched_ms"] = opening_.touched_ms;
    r["open_first_picture_ms"] = opening_.seen_ms;
    r["open_whole_picture_ms"] = opening_.whole_ms;
    const haptic::TimingFigures late = touch_->timing().lateness.figures();
    const haptic::TimingFigures edit = touch_->latency().histogram().figures();
    r["ticks"] = late.count;
    r["rate_hz"] = touch_->measuredRate();
    r["lateness_p50_us"] = 1e3 * ms(late.p50_ns);
    r["lateness_p99_us"] = 1e3 * ms(late.p99_ns);
    r["lateness_worst_us"] = 1e3 * ms(late.worst_ns);
    r["edits_shown"] = edit.count;
    r["edit_to_pixel_p50_ms"] = ms(edit.p50_ns);
    r["edit_to_pixel_p99_ms"] = ms(edit.p99_ns);
    r["steps"] = touch_->history().number();
    r["filters_applied"] = filters_.applied();
    r["saved"] = save_path_;
    r["session"] = keeper_->path();
    r["session_named"] = keeper_->named();
    r["unsaved_changes"] = unsaved();
  }
  r["validation_messages"] = window_->validationMessages();
  return r;
}

}  // namespace fettle::app
