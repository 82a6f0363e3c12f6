#include "app/window/workstation/workstation.h"

#include <algorithm>
#include <chrono>
#include <thread>
#include <utility>

#include <fmt/format.h>
#include <imgui.h>

#include "app/terminal.h"
#include "app/texts/chosen_catalogue.h"
#include "app/texts/texts.h"
#include "app/window/device_buttons.h"
#include "app/window/draw_field.h"
#include "app/work/behind_the_window.h"
#include "engine/base/memory.h"
#include "engine/base/stopwatch.h"

namespace fettle::app {
namespace {

constexpr double kIdle_s = 0.1;   // between two frames while nothing happens
constexpr double kBusy_s = 0.03;  // ... while only figures change
constexpr auto kSaveSettingsEvery = std::chrono::seconds(1);
constexpr auto kMinimised = std::chrono::milliseconds(10);

std::string settingsPath(const char* file) {
  const std::string folder = settingsFolder();
  return folder.empty() ? std::string() : folder + file;
}

// Whether a worker runs whose progress is shown.
bool working(const Parts& p) {
  return p.files.busy() || p.marking.busy() || p.costs.busy() || p.opening.busy() ||
         p.saving.busy(p.document) || p.results.busy() || p.filters.computing() || p.filters.awaitsRest() ||
         p.filters.measuresNoise() || p.filters.applying() || p.suggester.busy() || p.line_suggester.busy() ||
         p.devices.busy() || p.form.busy() || p.measure.busy() || p.section.busy() || p.heights.busy() ||
         p.heights.awaitsRest() || p.removal.busy() || p.colours.busy() || p.compare.busy() || p.fit.busy() ||
         p.features.busy() || p.transform.busy() || p.join.busy() ||
         (p.document.isOpen() &&
          (p.picture.refining() || p.picture.smoothing() || p.spared_shadow.pending()));
}

}  // namespace

Workstation::Workstation(const ViewOptions& options, const Settings& settings,
                         std::unique_ptr<render::Window> window)
    : options_(options),
      window_(std::move(window)),
      parts_(*window_, settings),
      saved_settings_(parts_.settings),
      ui_scale_(settings.ui_scale) {
  parts_.usual_reading = options_.reading;
  parts_.write_report = options_.write_report;
  if (options_.theme) parts_.settings.panels_theme = *options_.theme;
  window_->setWhileWaiting([this] { whileWaiting(); });
}

Workstation::~Workstation() {
  parts_.closeDocument(SessionKeeper::Afterwards::kKeep);
}

// The window in the user's language. A catalogue that cannot be used leaves it in English, and says so.
void useLanguage() {
  auto catalogue = chosenCatalogue(languageWords(), catalogueFolders());
  if (!catalogue) {
    warn(fmt::format("{}; the window is in English", catalogue.error().line()));
    return;
  }
  if (!*catalogue) return;
  if (const auto& refused = (*catalogue)->refused(); !refused.empty())
    warn(
        fmt::format("{} texts are left in English, since their translation cannot take their place: \"{}\"{}",
                    refused.size(), refused.front(), refused.size() > 1 ? " and others" : ""));
  useTexts(**std::move(catalogue));
}

engine::Result<std::unique_ptr<Workstation>> Workstation::create(const ViewOptions& options) {
  useLanguage();
  if (options.xr) render::Headset::silenceLoader();
  render::WindowOptions window = options.window;
  window.layout_file = settingsPath("/layout.ini");
  const Settings settings = Settings::load(settingsPath("/window.json"));
  if (window.scale <= 0.0) window.scale = settings.ui_scale;
  engine::keepFreeMemory();
  comeBeforeOtherWork();
  putWorkersBehindTheWindow();
  auto opened = render::Window::create(window);
  if (!opened) return tl::unexpected(opened.error());
  std::unique_ptr<Workstation> station(new Workstation(options, settings, std::move(*opened)));
  if (const auto made = station->parts_.picture.make(); !made) return tl::unexpected(made.error());
  if (!options.events.empty()) {
    auto events = EventLog::open(options.events);
    if (!events) return tl::unexpected(events.error());
    station->events_ = *std::move(events);
  }
  if (options.xr) {
    LoopClientOptions& client = station->options_.client;
    if (auto started = station->headset_.start({options.window.validation}, options.xr_scale, client);
        !started)
      return tl::unexpected(started.error());
  }
  if (!options.scan.empty()) station->open(options.scan, std::nullopt);
  return station;
}

engine::Result<Report> Workstation::run(engine::JobControl& job) {
  const engine::Stopwatch watch;
  while (parts_.quit == Quit::kNo) {
    runFrame();
    if (!end_) return tl::unexpected(end_.error());
    if (window_->closeAsked()) {
      window_->refuseClose();
      app::carryOut(Action::kQuit, parts_);
    }
    const double lived = watch.seconds();
    if (job.cancelled() || (options_.seconds > 0.0 && lived >= options_.seconds)) break;
  }
  saveSettingsNow();
  Report report = runReport(parts_, figures());
  // A user who quits has saved what was to be saved. Otherwise there was no question: unsaved work is
  // restored when the scan is opened again.
  const bool kept = parts_.quit != Quit::kDone && parts_.document.unsaved();
  parts_.closeDocument(kept ? SessionKeeper::Afterwards::kKeep : SessionKeeper::Afterwards::kDiscard);
  // Without a name it is removed where nothing is to be restored.
  if (!kept && !report.value("session_named", true)) report["session"] = "";
  if (kept)
    warn(fmt::format("{}: unsaved work is stored; open the scan again to continue it",
                     parts_.document.path()));
  // Last: a runtime that does not answer may keep its thread, and the work is safe by then.
  headset_.finish();
  noteHeadset(figures().headset, report);
  return report;
}

void Workstation::runFrame() {
  WindowPicture& picture = parts_.picture;
  const bool rehearses = picture.rehearsing() && !window_->minimised();
  window_->poll(actsNow(parts_, input_)        ? 0.0
                : picture.active()             ? std::min(picture.restsFor_s(), kBusy_s)
                : working(parts_) || rehearses ? kBusy_s
                                               : kIdle_s);
  window_->keepPace();
  input_.beginFrame();
  whileWaiting();
  handleInput();
  followFlight();
  for (const std::string& path : window_->takeDrops()) {
    input_.countDrop();
    askToOpen(path);
  }
  releaseHandsWhenAsked();
  takeResults();
  picture.computes(parts_.filters.computing());
  parts_.showMarksMade();
  headset_.follow(parts_, options_.drawing, documents_);
  window_->setSeenElsewhere(headset_.on());
  releaseHandsWhenAsked();
  if (!parts_.picture.made() || window_->displayLost()) {
    // No graphics device: loop and workers continue.
    renewPicture();
  } else if (window_->canBeSeen()) {
    showFrame();
  } else {
    // Nothing to draw, everything else continues.
    logState(events_, parts_, input_, figures());
  }
  // There is no display to wait for.
  if (window_->minimised()) std::this_thread::sleep_for(kMinimised);
}

// Also called repeatedly while the device draws: passes the cursor to the loop, and takes the loop's reports
// off its ring.
void Workstation::whileWaiting() {
  window_->poll(0.0);
  headset_.takeInput(*window_);
  for (const render::InputEvent& event : window_->takeInput()) input_.add(event, parts_);
  if (parts_.document.isOpen()) parts_.document.client()->poll();
}

void Workstation::handleInput() {
  input_.followSurface(parts_);
  if (LoopClient* const client = parts_.document.client()) {
    const ImGuiIO& io = ImGui::GetIO();
    parts_.stylus.follow(io.KeyShift && !io.WantTextInput, client->state().contact, *client);
  }
  if (parts_.held()) parts_.picture.noteHand();
  while (const auto event = input_.next(parts_)) {
    parts_.picture.noteHand();
    const Input::Request request = Input::handle(*event, parts_);
    if (request.action) app::carryOut(*request.action, parts_);
    if (request.open) askToOpen(*request.open);
    parts_.cursor = {event->x, event->y};
    releaseHandsWhenAsked();
  }
}

void Workstation::followFlight() {
  if (!parts_.flight.active()) return;
  parts_.flight.follow(parts_.view, Flight::Clock::now());
  parts_.picture.requestRedraw();
}

// Releases what is held by the mouse when a dialog appears.
void Workstation::releaseHandsWhenAsked() {
  if (!parts_.feedback.questions.takeAsked()) return;
  parts_.releaseHands();
  parts_.picture.requestRedraw();
}

void Workstation::takeResults() {
  Parts& p = parts_;
  if (p.files.poll()) p.picture.requestRedraw();
  if (const auto sample = p.files.takeSample()) {
    if (*sample)
      askToOpen(**sample);
    else
      p.feedback.note(sample->error());
  }
  if (p.opening.takeCoarse(p.document.isOpen())) p.picture.requestRedraw();
  takeOpened();
  if (!end_) return;
  if (p.document.keeper() != nullptr) p.document.keeper()->poll();
  if (const auto saved = p.saving.poll(p.document, p.feedback)) {
    if (saved->moved) {
      p.recent.add(p.document.path());
      window_->setTitle(p.document.fileName() + " - Fettle");
    }
    resumeAfterSave(saved->afterwards);
  }
  const SessionKeeper* const keeper = p.document.keeper();
  // Before the first step there is no file, and what waits is for one that may come.
  const bool stored = keeper == nullptr || keeper->path().empty() || keeper->waiting() == 0;
  if (const auto written = p.results.poll(stored, p.feedback)) {
    p.saving.noteFolderOf(*written);
    p.picture.requestRedraw();
  }
  if (!p.document.isOpen()) return;
  p.document.poll(p.view, p.feedback);
  followButtons(p);
  if (const auto written = tool_results_.take(p)) askToOpen(*written);
}

void Workstation::showFrame() {
  ImGui::GetIO().DisplaySize =
      ImVec2(static_cast<float>(window_->width()), static_cast<float>(window_->height()));
  const std::optional<std::int64_t> edit_ns =
      parts_.document.isOpen() ? parts_.document.client()->latency().takeUnshownEdit() : std::nullopt;
  const engine::Stopwatch watch;
  parts_.feedback.dropPassed(std::chrono::steady_clock::now());
  window_->setPanelTheme(parts_.settings.panels_theme);
  if (std::exchange(ui_scale_, parts_.settings.ui_scale) != parts_.settings.ui_scale) {
    if (const auto scaled = window_->setScale(ui_scale_); !scaled) {
      losePicture(scaled.error());
      return;
    }
    parts_.picture.requestRedraw();
  }
  window_->beginFrame();
  carryOut(layOutPanels(parts_));
  releaseHandsWhenAsked();
  const bool announces = parts_.announcesPicture();
  if (parts_.document.isOpen()) {
    if (!announces) drawField(parts_, options_.drawing);
  } else if (parts_.opening.coarse() != nullptr) {
    drawCoarse(parts_, options_.drawing);
  } else {
    parts_.picture.skipRedraw();
  }
  const auto shown = window_->present();
  if (shown) {
    if (shown->shown_ns > 0) parts_.picture.noteFrame(watch.ms() - shown->waited_ms);
    noteShown(*shown, edit_ns, announces);
    headset_.showFrame(*window_);
  } else {
    losePicture(shown.error());
  }
}

void Workstation::noteShown(const render::PresentReport& report, std::optional<std::int64_t> edit_ns,
                            bool announces) {
  using Frame = Opening::Frame;
  const Parts& p = parts_;
  const bool open = p.document.isOpen();
  if (open && edit_ns && report.shown_ns > 0)
    p.document.client()->latency().noteShown(*edit_ns, report.shown_ns);
  ++frames_;
  shown_ns_ = report.shown_ns;
  if (announces) parts_.opening.noteAnnounced();
  parts_.opening.noteFrame(p.coarseIsShown()                              ? Frame::kCoarse
                           : !open || p.picture.empty()                   ? Frame::kNothing
                           : p.picture.figures().upload.pending_tiles > 0 ? Frame::kDocument
                                                                          : Frame::kWhole);
  saveSettings();
  logState(events_, p, input_, figures());
}

// Writes changed settings, at most once a second: by time and not by frames, of which a window at rest shows few, so that
// a power cut takes no more than that.
void Workstation::saveSettings() {
  const auto now = std::chrono::steady_clock::now();
  if (now - settings_looked_at_ < kSaveSettingsEvery) return;
  settings_looked_at_ = now;
  saveSettingsNow();
}

void Workstation::saveSettingsNow() {
  if (parts_.settings == saved_settings_) return;
  parts_.settings.save(settingsPath("/window.json"));
  saved_settings_ = parts_.settings;
}

}  // namespace fettle::app
