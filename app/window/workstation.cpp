#include "app/window/workstation.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <thread>
#include <utility>

#include <fmt/format.h>
#include <imgui.h>

#include "app/files/reading_fields.h"
#include "app/terminal.h"
#include "app/window/device_buttons.h"
#include "app/window/draw_field.h"
#include "app/window/result_files.h"
#include "app/window/scene_edits.h"
#include "app/work/behind_the_window.h"
#include "engine/base/stopwatch.h"
#include "render/plan/number_text.h"

namespace fettle::app {
namespace {

constexpr double kIdle_s = 0.1;   // between two frames while nothing happens
constexpr double kBusy_s = 0.03;  // ... while only figures change
constexpr auto kSaveSettingsEvery = std::chrono::seconds(1);
constexpr auto kMinimised = std::chrono::milliseconds(10);
constexpr auto kWithoutPicture = std::chrono::milliseconds(5);  // between two polls of the loop

std::string settingsPath(const char* file) {
  const std::string folder = settingsFolder();
  return folder.empty() ? std::string() : folder + file;
}

// Whether a worker runs whose progress is shown.
bool working(const Parts& p) {
  return p.files.busy() || p.marking.busy() || p.costs.busy() || p.opening.busy() ||
         p.saving.busy(p.document) || p.results.busy() || p.filters.computing() || p.filters.awaitsRest() ||
         p.filters.measuresNoise() || p.filters.applying() || p.suggester.busy() || p.devices.busy() ||
         p.form.busy() || p.measure.busy() || p.section.busy() || p.heights.busy() ||
         p.heights.awaitsRest() || p.removal.busy() || p.colours.busy() || p.compare.busy() || p.fit.busy() ||
         p.features.busy() || p.transform.busy() ||
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

engine::Result<std::unique_ptr<Workstation>> Workstation::create(const ViewOptions& options) {
  if (options.xr) render::Headset::silenceLoader();
  render::WindowOptions window = options.window;
  window.layout_file = settingsPath("/layout.ini");
  const Settings settings = Settings::load(settingsPath("/window.json"));
  if (window.scale <= 0.0) window.scale = settings.ui_scale;
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
  window_->poll(isActive(parts_, input_) ? 0.0 : working(parts_) ? kBusy_s : kIdle_s);
  whileWaiting();
  handleInput();
  followFlight();
  for (const std::string& path : window_->takeDrops()) {
    input_.countDrop();
    askToOpen(path);
  }
  releaseHandsWhenAsked();
  takeResults();
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
  while (const auto event = input_.next(parts_)) {
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

void Workstation::carryOut(PanelRequests requests) {
  if (requests.open) askToOpen(*requests.open);
  if (requests.sample) parts_.files.makeSample();
  if (requests.loop.rate_hz) setRate(*requests.loop.rate_hz);
  if (requests.loop.device) setDevice(*requests.loop.device);
  if (requests.answer) carryOut(*std::move(requests.answer));
}

void Workstation::carryOut(Answer answer) {
  using Kind = Question::Kind;
  using Choice = Answer::Choice;
  Parts& p = parts_;
  Question& question = answer.question;
  const bool confirmed = answer.choice == Choice::kConfirm;
  if (answer.choice == Choice::kBack) {
    // Back to the dialog in which the path was typed.
    if (question.kind == Kind::kImport) unconfirmed_.reset();
    if (question.typed)
      p.feedback.questions.ask({.kind = question.from,
                                .path = std::move(question.path),
                                .afterwards = std::move(question.afterwards)});
    return;
  }
  switch (question.kind) {
    case Kind::kOpen:
      dialog_path_ = question.path;
      if (confirmed)
        askToOpen(question.path);
      else
        p.feedback.questions.ask({.kind = Kind::kImport,
                                  .path = question.path,
                                  .reading = parts_.readingOf(question.path),
                                  .from = Kind::kOpen,
                                  .typed = true});
      break;
    case Kind::kImport:
      p.files.readings.note(question.path, *question.reading);
      if (question.guessed == nullptr)
        askToOpen(question.path, std::move(question.reading));
      else if (auto read = std::exchange(unconfirmed_, std::nullopt);
               read && scanOptionsText(*question.reading).empty())
        startDocument(*std::move(read));
      else
        load(question.path, Recovery::kLeave, question.reading);  // it was said where its work goes
      break;
    case Kind::kCompare:
      p.compare.compareWith(*p.document.client(), question.path, options_.reading);
      p.settings.panels["Compare"] = true;
      break;
    case Kind::kSaveAs:
    case Kind::kExport:
      p.saving.askToWrite(std::move(question), Saving::Typed::kYes, p.document, p.feedback);
      break;
    case Kind::kExportSections:
    case Kind::kExportReport:
    case Kind::kExportFits:
    case Kind::kExportFeatures:
      confirmResult(std::move(question), p);
      break;
    case Kind::kUnsaved:
      if (question.stop_asking) p.settings.ask_before_quitting = false;
      if (confirmed)
        p.saving.save(p.document, p.feedback, std::move(question.afterwards));
      else
        resumeAfterSave(question.afterwards);
      break;
    case Kind::kOpenScene:
    case Kind::kSaveScene:
    case Kind::kUnsavedScene:
      carryOutOfScene(std::move(answer));
      break;
    case Kind::kReplace:
      if (question.from == Kind::kSaveScene) return carryOutOfScene(std::move(answer));
      if (resultFileOf(question.from) != nullptr)
        writeResult(question.from, question.path, p);
      else
        p.saving.start(question.path, Saving::keepingOf(question.from), std::move(question.afterwards),
                       p.document, p.feedback);
      break;
    case Kind::kRecover:
      load(question.path, confirmed ? Recovery::kTake : Recovery::kLeave, question.reading);
      break;
    case Kind::kDevice:
      if (confirmed) setUpDevice(p.device_setup);
      break;
    case Kind::kShortcuts:
    case Kind::kMessage:
      break;
  }
}

void Workstation::carryOutOfScene(Answer answer) {
  using Kind = Question::Kind;
  Parts& p = parts_;
  Question& question = answer.question;
  LoopClient& client = *p.document.client();
  bool felt = false;  // the file is what is felt
  switch (question.kind) {
    case Kind::kOpenScene:
      felt = p.scene_files.open(question.path, client, p.feedback);
      break;
    case Kind::kUnsavedScene:
      if (question.stop_asking) p.settings.ask_before_quitting = false;
      if (answer.choice == Answer::Choice::kConfirm) {
        p.feedback.questions.ask({.kind = Kind::kSaveScene,
                                  .path = p.scenePathToSave(),
                                  .afterwards = std::move(question.afterwards)});
        return;
      }
      p.scene_files.leave(client);
      app::carryOut(Action::kQuit, p);
      return;
    case Kind::kReplace:
      felt = p.scene_files.save(question.path, client, p.feedback);
      break;
    default:
      felt = p.scene_files.askToSave(question, client, p.feedback);
      break;
  }
  if (!felt) return;
  // Of the next scan as well.
  options_.scene = client.scene();
  options_.scene_path = p.scene_files.path();
  if (question.afterwards.what == Afterwards::What::kQuit) app::carryOut(Action::kQuit, p);
}

void Workstation::askToOpen(const std::string& path, std::optional<ScanOptions> reading) {
  if (parts_.document.unsaved())
    parts_.feedback.questions.ask({.kind = Question::Kind::kUnsaved,
                                   .afterwards = {Afterwards::What::kOpen, path, std::move(reading)}});
  else
    open(path, reading);
}

// Continues with what waited for an answer, or for saving.
void Workstation::resumeAfterSave(const Afterwards& afterwards) {
  if (afterwards.what == Afterwards::What::kQuit) parts_.quit = Quit::kDone;
  if (afterwards.what == Afterwards::What::kOpen) open(afterwards.path, afterwards.reading);
}

void Workstation::open(const std::string& path, const std::optional<ScanOptions>& reading) {
  std::error_code error;
  const std::string recovery = isSessionPath(path) ? std::string() : recoveryPath(path);
  const SessionKeeper* const keeper = parts_.document.keeper();
  const bool own = keeper != nullptr && keeper->path() == recovery;
  if (!recovery.empty() && !own && std::filesystem::exists(recovery, error))
    parts_.feedback.questions.ask({.kind = Question::Kind::kRecover, .path = path, .reading = reading});
  else
    load(path, Recovery::kLeave, reading);
}

void Workstation::load(const std::string& path, Recovery recovery,
                       const std::optional<ScanOptions>& reading) {
  parts_.dropCoarse();
  unconfirmed_.reset();
  // The command line says how its scan and all scans are to be read, work is what it was begun on, and of some scans it
  // was said before.
  const bool said = reading || recovery == Recovery::kTake || path == options_.scan ||
                    !scanOptionsText(parts_.usual_reading).empty() || parts_.files.readings.find(path);
  parts_.opening.start(path, recovery, reading ? *reading : parts_.readingOf(path),
                       said ? Guesses::kTake : Guesses::kAsk, parts_.document.isOpen());
}

void Workstation::takeOpened() {
  if (unconfirmed_ && !parts_.feedback.questions.pending()) unconfirmed_.reset();  // nobody wants it
  auto done = parts_.opening.take();
  if (!done) return;
  parts_.picture.requestRedraw();
  if (*done) {
    Opened& opened = **done;
    if (opened.guessed == nullptr)
      startDocument(std::move(opened.document));
    else
      askHowToRead(std::move(opened));
    return;
  }
  parts_.dropCoarse();
  const engine::Error& error = done->error();
  if (error.kind == engine::ErrorKind::kCancelled) return;
  if (!parts_.document.isOpen() && parts_.opening.path() == options_.scan)
    end_ = tl::unexpected(error);  // named on the command line: its errors are the command's
  else
    parts_.feedback.message(inFieldWords(error.line()), "");
}

// It was read, and waits until somebody has said that what was guessed is right.
void Workstation::askHowToRead(Opened opened) {
  parts_.dropCoarse();
  parts_.feedback.questions.ask({.kind = Question::Kind::kImport,
                                 .path = opened.document.path,
                                 .reading = ScanOptions(),
                                 .guessed = std::move(opened.guessed),
                                 .from = Question::Kind::kOpen,
                                 .typed = std::exchange(dialog_path_, {}) == opened.document.path});
  unconfirmed_ = std::move(opened.document);
}

void Workstation::startDocument(Document document) {
  ++documents_;
  Parts& p = parts_;
  p.opening.noteRead(p.document.isOpen());
  p.closeDocument(SessionKeeper::Afterwards::kDiscard);
  const bool first = p.document.path().empty();
  options_.client.loudness = p.settings.loudness;
  options_.client.setups = p.settings.devices;
  if (const auto opened = p.document.open(document, options_.scene, options_.client); !opened) {
    p.dropCoarse();
    if (first)
      end_ = opened;
    else
      p.feedback.message(opened.error().line(), "");
    return;
  }
  LoopClient& client = *p.document.client();
  const engine::Grid& grid = document.original.grid();
  const bool looked_at = p.opening.coarse() != nullptr;
  p.dropCoarse();  // the coarse picture stays until the scan is read
  p.opening.noteTouched();
  p.reading = scanOptionsOf(document.scan.import);
  p.saving.begin(grid.samples());
  p.change.begin(client.original());
  p.settings.display.marks = true;
  p.steps_seen = client.history().number();
  tool_results_.begin(p);
  p.scene_files.begin(client, options_.scene ? options_.scene_path : std::string());
  // A view that was changed in the coarse picture is kept.
  const auto camera = document.notes.find("camera");
  if (!looked_at) p.view = camera != document.notes.end() ? viewOf(camera->second) : startView();
  restoreSections(document);
  if (const auto views = document.notes.find(Bookmarks::kNote); views != document.notes.end())
    p.bookmarks.restore(views->second);
  p.picture.clear();
  p.chooseTool(std::nullopt);
  p.recent.add(p.document.path());
  noteWarnings(document.warnings);
  if (options_.scene) noteWithoutForce(client, p.feedback.notices);
  if (document.scan.import.depth_camera && client.scene().invert)
    p.feedback.notices.push_back({"distances from a camera are shown upside down: what is near is high",
                                  "I shows them as they are stored"});
  if (document.recovered)
    p.feedback.notices.push_back(
        {fmt::format("{} unsaved steps were restored", client.history().number()), ""});
  p.feedback.status = fmt::format("{}: {} x {} samples, {:.4g} x {:.4g} {}", p.document.fileName(),
                                  grid.width, grid.height, grid.spacing_x * p.units.length.per_unit,
                                  grid.spacing_y * p.units.length.per_unit, p.units.length.name);
  window_->setTitle(p.document.fileName() + " - Fettle");
}

// What reading said, with the name of the file; where a person can say more, with the page for it.
void Workstation::noteWarnings(const std::vector<std::string>& warnings) {
  Parts& p = parts_;
  const bool scan = !isSessionPath(p.document.path());
  const auto said = scan ? p.files.readings.find(p.document.path()) : std::nullopt;
  const bool as_said = said && scanOptionsText(*said) == scanOptionsText(p.reading);
  if (const std::string text = as_said ? readingText(*said) : ""; !text.empty())
    p.feedback.notices.push_back(
        {fmt::format("{} is read as you said: {}", p.document.fileName(), text), "", "", 1, true, true});
  for (const std::string& warning : warnings) {
    // Who has seen the page and left it so does not want to be asked again.
    if (as_said && isGuess(warning)) continue;
    const std::string text = inFieldWords(warning);
    p.feedback.notices.push_back(
        {fmt::format("{}: {}", p.document.fileName(), text), "", "", 1, scan && text != warning});
  }
}

void Workstation::restoreSections(const Document& document) {
  const auto kept = document.notes.find(engine::kSectionsNote);
  if (kept == document.notes.end()) return;
  auto sections = sectionsOf(kept->second);
  if (sections)
    parts_.section.restore(*std::move(sections));
  else
    parts_.feedback.notices.push_back({sections.error().what, "the session is as it was otherwise"});
}

// For this device from now on, and when it is opened again.
void Workstation::setUpDevice(const DeviceSetup& setup) {
  LoopClient& client = *parts_.document.client();
  parts_.filters.cancel(client);  // as in setRate()
  const engine::Status set = client.setDeviceSetup(setup);
  if (client.finished()) {
    end_ = set;
  } else if (!set) {
    parts_.feedback.message(set.error().line(), "the device is used as before");
  } else {
    parts_.settings.devices[setupKey(client.device().profile())] = setup;
    saveSettingsNow();  // nobody measures twice because the program was ended
    parts_.feedback.status = "the device is set up, and will be when it is opened again";
  }
  parts_.picture.requestRedraw();
}

void Workstation::setRate(double hz) {
  LoopClient& client = *parts_.document.client();
  // Previews in progress belong to the loop that ends (LoopClient::setRate).
  parts_.filters.cancel(client);
  const engine::Status set = client.setRate(hz);
  options_.client.rate_hz = client.rate();
  // Without a loop no work is possible; the work is stored as at every end.
  if (client.finished())
    end_ = set;
  else if (!set)
    parts_.feedback.message(set.error().line(), "the loop continues as before");
  parts_.picture.requestRedraw();
}

// As setRate(); for the next scan as well.
void Workstation::setDevice(const std::string& words) {
  LoopClient& client = *parts_.document.client();
  parts_.releaseHands();
  parts_.filters.cancel(client);
  const engine::Status set = client.setDevice(words);
  options_.client.device = client.deviceWords();
  if (client.finished())
    end_ = set;
  else if (!set)
    parts_.feedback.message(set.error().line(), "the device is used as before");
  else
    parts_.feedback.status = fmt::format("the device is the {} now", client.device().profile().name);
  parts_.picture.requestRedraw();
}

// A lost graphics device - its driver restarted, it hung, it was unplugged, its memory ran out - loses only
// the picture: field, history, marks and camera belong to the document.
void Workstation::losePicture(const engine::Error& why) {
  parts_.picture.lose();
  parts_.drag.stop();
  const bool again = renewal_.lost(frames_, DeviceRenewal::Clock::now()) && !window_->displayLost();
  if (again) return;
  engine::Error end = why;
  if (parts_.document.isOpen()) {
    parts_.filters.finish(*parts_.document.client());
    end.remedy = parts_.document.rescue() + end.remedy;
  }
  end_ = tl::unexpected(std::move(end));
}

void Workstation::renewPicture() {
  if (window_->displayLost()) {
    losePicture(
        engine::failure("the connection to the display was lost", "window", "open the window again").value());
    return;
  }
  if (!renewal_.due(DeviceRenewal::Clock::now())) {
    std::this_thread::sleep_for(kWithoutPicture);
    return;
  }
  const std::string before = window_->device();
  renewal_.begin(frames_);
  engine::Status done = window_->renew();
  if (done) done = parts_.picture.make();
  if (!done) {
    losePicture(done.error());
    return;
  }
  std::vector<Notice>& notices = parts_.feedback.notices;
  std::erase_if(notices, [](const Notice& n) { return n.what.starts_with(kDeviceLost); });
  notices.push_back({before == window_->device()
                         ? fmt::format("{} and works again", kDeviceLost)
                         : fmt::format("{}; {} is used now", kDeviceLost, window_->device()),
                     "the field, its marks and its steps are unchanged"});
}

}  // namespace fettle::app
