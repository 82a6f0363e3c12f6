#include "app/work/touch.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <condition_variable>
#include <cstdlib>
#include <limits>
#include <mutex>
#include <numbers>
#include <thread>

#include <fmt/format.h>

#include "app/live/placement.h"
#include "haptic/devices/enumerate.h"
#include "haptic/journal/mark_codec.h"
#include "haptic/loop/pacer.h"
#include "haptic/safety/last_resort.h"

namespace fettle::app {
namespace {

using haptic::CommandKind;
using haptic::EventKind;
using haptic::LoopCommand;
using haptic::Tool;
using namespace std::chrono_literals;

constexpr auto kLook = 1ms;           // between two looks at the state while a force fades
constexpr auto kLongestFade = 100ms;  // a disarmed force is gone after peak / slew = 5 ms
constexpr std::size_t kRecordedTicks = 1
                                       << 16;  // over a minute at 1 kHz, in which the window may stand still
constexpr std::int64_t kArmAgain_ns = 100'000'000;
constexpr std::int64_t kRateWindow_ns = 500'000'000;

std::int64_t nowNs() {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(
             std::chrono::steady_clock::now().time_since_epoch())
      .count();
}

double spacingMm(const engine::Grid& grid) {
  return std::max(grid.spacingXMm(), grid.spacingYMm());
}

// A mouse knows no force: its depth stands for it. Two cells deep is pressing hard, on a coin as on a valley.
haptic::Scene fitted(haptic::Scene scene, const engine::Grid& grid) {
  // A cursor jumps up and down walls that a hand would go round, and would leave a local search behind them.
  scene.level = haptic::ContactLevel::kCertified;
  scene.certified_radius_cells = 6;  // more than the four cells that it presses at most
  scene.stiffness_n_per_mm = std::clamp(scene.force_limit_n / (2.0 * spacingMm(grid)), 1e-6, 1000.0);
  return scene;
}

haptic::MouseFeel feelFor(const engine::Grid& grid) {
  const double cell = spacingMm(grid);
  haptic::MouseFeel feel;
  feel.hover_mm = cell;
  feel.press_mm = cell;
  feel.wheel_step_mm = 0.1 * cell;
  feel.deepest_mm = 4.0 * cell;
  return feel;
}

std::string stepName(Tool tool) {
  switch (tool) {
    case Tool::kSmooth:
      return "Smooth";
    case Tool::kMark:
      return "Mark";
    case Tool::kUnmark:
      return "Unmark";
    case Tool::kFeel:
      break;
  }
  return "Stroke";
}

bool isAnswer(EventKind kind) {
  return kind != EventKind::kEdited && kind != EventKind::kStrokeEnded;
}

engine::StepKind stepKind(Tool tool) {
  return tool == Tool::kMark || tool == Tool::kUnmark ? engine::StepKind::kMark : engine::StepKind::kStroke;
}

}  // namespace

// One question at a time from a worker; the main thread carries it to the loop and the answer back.
struct Touch::Mailbox {
  enum class Question : std::uint8_t { kNone, kSnapshot, kAdopt };
  std::mutex mutex;
  std::condition_variable answered;
  Question question = Question::kNone;
  bool sent = false;
  bool ready = false;
  bool closed = false;
  std::uint64_t id = 0;     // of the newest snapshot: an adoption carries the same
  engine::Version version;  // of the question or the answer
  bool adopted = false;

  engine::Result<engine::Version> ask(Question what, engine::Version given, bool& was_adopted) {
    std::unique_lock lock(mutex);
    if (closed) return engine::cancelled();
    question = what;
    sent = ready = false;
    version = std::move(given);
    answered.wait(lock, [&] { return ready || closed; });
    if (!ready) {
      question = Question::kNone;
      return engine::cancelled();
    }
    question = Question::kNone;
    was_adopted = adopted;
    return std::exchange(version, {});
  }
  void answer(engine::Version given, bool was_adopted) {
    {
      const std::scoped_lock lock(mutex);
      if (question == Question::kNone) return;
      version = std::move(given);
      adopted = was_adopted;
      ready = true;
    }
    answered.notify_all();
  }
};

Touch::Touch(engine::History history, const engine::Version& original, const haptic::Scene& scene,
             const TouchOptions& options, haptic::SessionSink* sink)
    : options_(options),
      history_(std::move(history)),
      original_(original),
      scene_(scene),
      sink_(sink),
      mailbox_(std::make_unique<Mailbox>()) {
  committed_ = history_.current();
  field_ = scene_.invert ? committed_.inverted() : committed_;
}

engine::Result<std::unique_ptr<Touch>> Touch::start(engine::History history, const engine::Version& original,
                                                    const haptic::Scene& scene, const TouchOptions& options,
                                                    haptic::SessionSink* sink) {
  std::unique_ptr<Touch> touch(new Touch(std::move(history), original, scene, options, sink));
  if (auto status = haptic::LastResort::install(); !status) return tl::unexpected(status.error());
  // The way out when the display is lost (render/window/window.cpp).
  static const int at_quick_exit = std::at_quick_exit([] { haptic::LastResort::fire(); });
  static_cast<void>(at_quick_exit);
  if (auto status = touch->openDevice(); !status) return tl::unexpected(status.error());
  if (auto status = touch->startLoop(); !status) return tl::unexpected(status.error());
  for (const std::string& missing : touch->loop_->realTime().missing)
    touch->notices_.push_back({"the loop got less than it asked for", missing});
  return touch;
}

engine::Status Touch::openDevice() {
  const engine::Grid& grid = original_.grid();
  if (options_.device == "mouse") {
    auto mouse = std::make_unique<haptic::MouseStylus>(feelFor(grid));
    mouse_ = mouse.get();
    device_ = std::move(mouse);
    if (options_.fit_spring) scene_ = fitted(scene_, grid);
    return {};
  }
  auto device = haptic::openDevice(options_.device, options_.rate_hz);
  if (!device) return tl::unexpected(device.error());
  device_ = std::move(*device);
  return {};
}

// From the history's state on, with the device there is, which is started with the loop.
engine::Status Touch::startLoop() {
  const engine::Grid& grid = original_.grid();
  const haptic::DeviceProfile& profile = device_->profile();
  haptic::HapticLoop::Settings settings;
  settings.rate_hz = options_.rate_hz;
  settings.options.tool = tool_;
  settings.options.limits = sessionLimits(profile);
  settings.options.edit_rule =
      profile.gives_force ? haptic::EditRule::kWhileForceIsGiven : haptic::EditRule::kAnytime;
  // One drag, one step: off the surface the mouse's tip lifts, and its button stays held.
  if (mouse_ != nullptr) settings.options.stroke_gap_ticks = std::numeric_limits<std::uint32_t>::max();
  // A view of a large field keeps the main thread away for longer than a frame at times.
  settings.options.event_capacity = 1024;
  settings.options.command_capacity = 1024;
  settings.options.record_capacity = sink_ != nullptr ? kRecordedTicks : 0;
  if (profile.space == haptic::DeviceSpace::kDesk) {
    const glm::dvec3 middle{
        0.5 * (grid.width - 1) * grid.spacingXMm(), 0.5 * (grid.height - 1) * grid.spacingYMm(),
        field_.reader().bounds().empty() ? 0.0 : field_.reader().bounds().max * grid.height_unit.mm};
    scale_at_start_ = fittedScale(profile, grid, scene_, options_.rate_hz);
    settings.options.workspace = haptic::Workspace(scale_at_start_, middle);
  }
  if (const auto problem = stabilityProblem(scene_)) {
    haptic::Scene lowered = haptic::stableScene(scene_, profile, options_.rate_hz, scale_at_start_);
    // A device that holds nothing at all has no such scene.
    if (!options_.lower_scene || stabilityProblem(lowered))
      return engine::inputError(problem->what, "scene", problem->remedy);
    scene_ = std::move(lowered);
    notices_.push_back({problem->what, "lowered to " + problem->remedy});
  }
  auto loop = haptic::HapticLoop::create(committed_, original_, scene_, *device_, settings);
  if (!loop) return tl::unexpected(loop.error());
  if (auto status = device_->start(); !status) return status;
  if (auto status = (*loop)->start(); !status) {
    device_->stop();
    return status;
  }
  loop_ = std::move(*loop);
  finished_ = false;
  if (sink_ != nullptr) recorder_.add(haptic::journal::Begin{history_.number(), scene_});
  return {};
}

engine::Status Touch::setRate(double rate_hz) {
  if (!loop_ || finished_ || rate_hz == options_.rate_hz) return {};
  if (!(rate_hz >= haptic::Pacer::kLowestRate_hz && rate_hz <= haptic::Pacer::kHighestRate_hz))
    return engine::inputError("a loop runs at 1000 to 10000 ticks a second", "rate");
  if (const auto problem = stabilityProblem(scene_, rate_hz))
    return engine::inputError(problem->what, "rate", "first take " + problem->remedy);
  const bool disarmed = disarmed_;
  if (mouse_ != nullptr) {
    mouse_->release();
    mouse_->leave();
  }
  finish();
  // All that belonged to the loop that ended.
  committed_ = history_.current();
  field_ = scene_.invert ? committed_.inverted() : committed_;
  place_ = {};
  unsent_.clear();
  scenes_.clear();
  restores_open_ = 0;
  adoption_begun_ = false;
  recorder_ = haptic::Recorder();
  recorded_ = lost_ = last_event_tick_ = 0;
  seen_ = {};
  view_azimuth_deg_ = 0.0;
  view_zoom_ = 1.0;
  rate_tick_ = 0;
  rate_ns_ = armed_try_ns_ = 0;
  measured_rate_ = 0.0;
  // The old loop and its device stay what one can look at should no other start.
  const double before_hz = std::exchange(options_.rate_hz, rate_hz);
  engine::Status status = restartLoop();
  if (!status) {
    options_.rate_hz = before_hz;
    static_cast<void>(restartLoop());
  }
  disarmed_ = disarmed;
  if (!finished_ && status && device_->profile().gives_force && !armsItself())
    notices_.push_back(
        {fmt::format("the loop runs at {:g} Hz now, without force", rate_hz), "press A to arm again"});
  return status;
}

engine::Status Touch::restartLoop() {
  std::unique_ptr<haptic::Device> before;  // outlives the old loop, which startLoop() replaces
  // Its virtual time goes by the loop's ticks: another hand, at the beginning of its way.
  if (options_.device.rfind("hand:", 0) == 0) {
    auto device = haptic::openDevice(options_.device, options_.rate_hz);
    if (!device) return tl::unexpected(device.error());
    before = std::exchange(device_, std::move(*device));
  }
  engine::Status status = startLoop();
  if (!status && before) device_ = std::move(before);
  return status;
}

Touch::~Touch() {
  finish();
}

void Touch::finish() {
  closePort();
  if (!loop_ || finished_) return;
  disarm();
  const auto latest = std::chrono::steady_clock::now() + kLongestFade;
  while (device_->profile().gives_force && std::chrono::steady_clock::now() < latest) {
    poll();
    const haptic::LoopState state = loop_->state();
    if (unsent_.empty() && state.given_n == glm::dvec3(0.0) && state.safety != haptic::SafetyState::kActive &&
        state.safety != haptic::SafetyState::kRamping)
      break;
    std::this_thread::sleep_for(kLook);
  }
  finished_ = true;
  static_cast<void>(loop_->stop());
  device_->stop();
  // What the loop said last; its ring has been waiting with all of it.
  for (haptic::LoopEvent event; loop_->poll(event);) held_.push_back(std::move(event));
  takeRecords();
  for (; !held_.empty(); held_.pop_front()) take(std::move(held_.front()));
  keepStroke();
  if (sink_ != nullptr && !recorder_.empty()) sink_->note(recorder_.take());
}

bool Touch::strokeRuns() const noexcept {
  return restores_open_ == 0 && !(upright(field_) == committed_);
}

void Touch::send(LoopCommand&& command) {
  // In order: what waits goes first. The ring is only full while the loop stands still.
  if (!unsent_.empty() || !loop_->send(std::move(command))) unsent_.push_back(std::move(command));
}

void Touch::poll() {
  if (finished_) return;
  while (!unsent_.empty() && loop_->send(std::move(unsent_.front()))) unsent_.erase(unsent_.begin());
  for (haptic::LoopEvent event; loop_->poll(event);) held_.push_back(std::move(event));
  takeRecords();
  // A journal has an event after all ticks before it and before the tick that took it.
  const auto recorded = [&](const haptic::LoopEvent& event) {
    return sink_ == nullptr || recorded_ >= event.tick + (isAnswer(event.kind) ? 1 : 0);
  };
  for (; !held_.empty() && recorded(held_.front()); held_.pop_front()) take(std::move(held_.front()));
  answerPort();
  armByItself();
  measureRate();
  watch();
  if (sink_ != nullptr && recorder_.due()) sink_->note(recorder_.take());
}

void Touch::takeRecords() {
  if (sink_ == nullptr) return;
  for (haptic::TickRecord record; loop_->pollRecord(record); ++recorded_) recorder_.tick(record.input);
  const std::uint64_t lost = loop_->state().lost_records;
  if (lost == lost_) return;
  recorder_.add(haptic::journal::Lost{static_cast<std::int64_t>(lost - lost_)});
  notices_.push_back({"the window stood still for too long to record every tick",
                      "the work is kept; the journal cannot replay beyond this point"});
  recorded_ += lost - lost_;
  lost_ = lost;
}

void Touch::noteEdit(const haptic::LoopEvent& event) {
  // Made after the event before was published, and at the earliest one period of publication ago for each
  // publication that this one took along.
  const haptic::LoopState state = loop_->state();
  const double period_ns = 1e9 / options_.rate_hz;
  const auto periods = static_cast<std::uint64_t>(8) * (event.merged + 1);
  const std::uint64_t first = std::max(last_event_tick_, event.tick > periods ? event.tick - periods : 0);
  const double ago = state.tick > first ? static_cast<double>(state.tick - first) * period_ns : 0.0;
  const std::int64_t made = state.time_ns - static_cast<std::int64_t>(ago);
  if (!unshown_ns_ || made < *unshown_ns_) unshown_ns_ = made;
}

// What a journal must tell of an answer, in the order of the answers.
void Touch::journalAnswer(const haptic::LoopEvent& event) {
  if (sink_ == nullptr) return;
  const haptic::LoopPlace at{event.tick, true};
  switch (event.kind) {
    case EventKind::kSnapshot:
      recorder_.add(haptic::journal::Snapshot{at});
      break;
    case EventKind::kAdopted:
    case EventKind::kAdoptRefused:
      recorder_.offerAnswered({at, event.kind == EventKind::kAdopted});
      break;
    case EventKind::kRestored:
      recorder_.add(haptic::journal::Restored{event.id, at});
      break;
    case EventKind::kSceneChanged:
      while (!scenes_.empty() && scenes_.front().first != event.id) scenes_.pop_front();
      if (!scenes_.empty()) recorder_.add(haptic::journal::SceneSet{at, scenes_.front().second});
      break;
    case EventKind::kEdited:
    case EventKind::kStrokeEnded:
      break;
  }
}

void Touch::take(haptic::LoopEvent&& event) {
  // A stroke under way when a filter's result came is a step of its own, made before it.
  if (event.kind == EventKind::kAdopted && !event.before.empty() && !(upright(event.before) == committed_) &&
      !adoption_begun_)
    push(stepName(stroke_tool_), stepKind(stroke_tool_), upright(event.before), place_);
  journalAnswer(event);
  if (!event.version.empty()) {
    field_ = event.version;
    place_ = {event.tick, isAnswer(event.kind)};
  }
  switch (event.kind) {
    case EventKind::kEdited:
      noteEdit(event);
      stroke_tool_ = tool_;
      break;
    case EventKind::kStrokeEnded:
      if (!event.rect.empty() && !(upright(event.version) == committed_)) {
        noteEdit(event);
        last_rect_ = {event.rect.column, event.rect.row, event.rect.columns, event.rect.rows};
        push(stepName(stroke_tool_), stepKind(stroke_tool_), upright(event.version), place_);
      }
      break;
    case EventKind::kSnapshot:
      mailbox_->answer(event.version, false);
      break;
    case EventKind::kAdopted: {
      // Further rounds belong to the same step.
      if (adoption_begun_ && history_.canUndo()) {
        static_cast<void>(history_.undo());
        if (sink_ != nullptr) sink_->moveTo(history_.number(), {});
      }
      push(adoption_name_, engine::StepKind::kFilter, upright(event.version), place_);
      adoption_begun_ = true;
      mailbox_->answer(event.version, true);
      break;
    }
    case EventKind::kAdoptRefused:
      mailbox_->answer(event.version.empty() ? field_ : event.version, false);
      break;
    case EventKind::kRestored:
      if (restores_open_ > 0) --restores_open_;
      committed_ = upright(event.version);
      break;
    case EventKind::kSceneChanged:
      break;
  }
  last_event_tick_ = std::max(last_event_tick_, event.tick);
  // What the event still holds is freed here, off the loop.
}

void Touch::push(const std::string& name, engine::StepKind kind, const engine::Version& after,
                 const haptic::LoopPlace& at, Source source, std::string data) {
  engine::StepInfo info;
  info.name = name;
  info.kind = kind;
  info.time = engine::stepTimeNow();
  const bool made = history_.push(std::move(info), after);
  committed_ = after;
  if (!made) return;
  const std::int64_t number = history_.number();
  if (kind == engine::StepKind::kFilter || source == Source::kMarks) last_rect_ = history_.info(number).rect;
  if (sink_ == nullptr) return;
  recorder_.add(haptic::journal::StepMade{number, name, kind, at, source == Source::kMarks}, std::move(data));
  sink_->commit(number, history_.step(number), recorder_.take());
}

// A stroke that runs becomes a step as far as it has got.
void Touch::keepStroke() {
  if (strokeRuns()) push(stepName(stroke_tool_), stepKind(stroke_tool_), upright(field_), place_);
}

void Touch::setTool(Tool tool) {
  tool_ = tool;
  LoopCommand command;
  command.kind = CommandKind::kTool;
  command.tool = tool;
  send(std::move(command));
}

std::optional<haptic::StabilityProblem> Touch::stabilityProblem(const haptic::Scene& scene,
                                                                double rate_hz) const {
  const haptic::DeviceProfile& profile = device_->profile();
  if (!profile.gives_force) return std::nullopt;
  return haptic::stabilityProblem(scene, profile, rate_hz, scale_at_start_);
}

std::optional<haptic::StabilityProblem> Touch::stabilityProblem(const haptic::Scene& scene) const {
  return stabilityProblem(scene, options_.rate_hz);
}

std::optional<double> Touch::largestStiffness() const {
  const haptic::DeviceProfile& profile = device_->profile();
  if (!profile.gives_force) return std::nullopt;
  return haptic::largestStiffness(scene_, profile, options_.rate_hz, scale_at_start_);
}

engine::Status Touch::setScene(const haptic::Scene& scene) {
  // First, as its largest value is the smaller one.
  if (const auto problem = stabilityProblem(scene))
    return engine::inputError(problem->what, "scene", problem->remedy);
  if (const auto problem = haptic::sceneProblem(scene)) return engine::inputError(*problem, "scene");
  scene_ = scene;
  LoopCommand command;
  command.kind = CommandKind::kScene;
  command.id = next_id_++;
  command.scene = std::make_unique<haptic::PreparedScene>(scene_, original_);
  if (sink_ != nullptr) scenes_.emplace_back(command.id, scene_);
  send(std::move(command));
  return {};
}

void Touch::restore(const engine::Version& version) {
  LoopCommand command;
  command.kind = CommandKind::kRestore;
  command.id = next_id_++;
  command.version = scene_.invert ? version.inverted() : version;
  ++restores_open_;
  adoption_begun_ = false;
  if (sink_ != nullptr) {
    recorder_.add(haptic::journal::RestoreAsked{command.id, history_.number()});
    sink_->moveTo(history_.number(), recorder_.take());
  }
  send(std::move(command));
}

void Touch::undo() {
  poll();
  keepStroke();
  if (const auto version = history_.undo()) restore(*version);
}

void Touch::redo() {
  poll();
  if (!canRedo()) return;
  if (const auto version = history_.redo()) restore(*version);
}

void Touch::goTo(std::int64_t state) {
  poll();
  keepStroke();
  if (state == history_.number()) return;
  if (const auto version = history_.goTo(state)) restore(*version);
}

void Touch::replaceMarks(const engine::Version& base, const engine::Version& marked, std::string name) {
  poll();
  keepStroke();
  std::string changes = haptic::packMarkChanges(base, marked);
  const engine::Version& now = history_.current();  // field() may lag behind an undo
  auto after = base == now ? engine::Result<engine::Version>(marked) : haptic::applyMarkChanges(now, changes);
  if (!after) {
    notices_.push_back({after.error().what, after.error().remedy});
    return;
  }
  push(name, engine::StepKind::kMark, *after, place_, Source::kMarks, std::move(changes));
  restore(*after);
}

std::uint64_t Touch::noteFilterBase() {
  const std::uint64_t id = ++filters_;
  if (sink_ != nullptr) recorder_.add(haptic::journal::FilterBase{id, place_});
  return id;
}

void Touch::noteFilterBegun(std::uint64_t base, const engine::FilterSpec& spec, std::string name) {
  adoption_name_ = std::move(name);
  if (sink_ != nullptr) recorder_.beginFilter({base, spec});
}

void Touch::arm() {
  disarmed_ = false;
  send(loop_->armCommand());
}
void Touch::disarm() {
  disarmed_ = true;
  loop_->disarm();
}
void Touch::calibrate() {
  device_->calibrate();
}

void Touch::setView(double azimuth_deg, double zoom) {
  if (device_->profile().space != haptic::DeviceSpace::kDesk) return;
  if (std::abs(std::remainder(azimuth_deg - view_azimuth_deg_, 360.0)) < 0.5 &&
      std::abs(zoom / view_zoom_ - 1.0) < 0.01)
    return;
  view_azimuth_deg_ = azimuth_deg;
  view_zoom_ = zoom;
  LoopCommand command;
  command.kind = CommandKind::kView;
  // Never stiffer than at the start, where the whole field was within reach or the device at its limit.
  command.scale = scale_at_start_ / std::max(zoom, 1.0);
  command.turn_rad = azimuth_deg * std::numbers::pi / 180.0;
  send(std::move(command));
}

engine::Result<engine::Version> Touch::snapshot() {
  bool unused = false;
  return mailbox_->ask(Mailbox::Question::kSnapshot, {}, unused);
}

engine::Result<Touch::Answer> Touch::adopt(engine::Version version) {
  Answer answer;
  auto live = mailbox_->ask(Mailbox::Question::kAdopt, std::move(version), answer.adopted);
  if (!live) return tl::unexpected(live.error());
  answer.version = std::move(*live);
  return answer;
}

void Touch::pause() {
  std::this_thread::sleep_for(20ms);
}

void Touch::closePort() {
  {
    const std::scoped_lock lock(mailbox_->mutex);
    mailbox_->closed = true;
  }
  mailbox_->answered.notify_all();
}

void Touch::allowPort() {
  const std::scoped_lock lock(mailbox_->mutex);
  mailbox_->closed = false;
  adoption_begun_ = false;
}

void Touch::answerPort() {
  LoopCommand command;
  {
    const std::scoped_lock lock(mailbox_->mutex);
    if (mailbox_->question == Mailbox::Question::kNone || mailbox_->sent) return;
    if (mailbox_->question == Mailbox::Question::kSnapshot) {
      command.kind = CommandKind::kSnapshot;
      mailbox_->id = next_id_++;
    } else {
      command.kind = CommandKind::kAdopt;
      command.version = std::move(mailbox_->version);
      recorder_.offerMade();
    }
    command.id = mailbox_->id;
    mailbox_->sent = true;
  }
  send(std::move(command));
}

// Only a device that cannot push: one that does is armed by the person who holds it.
bool Touch::armsItself() const {
  return !device_->profile().gives_force || options_.device.rfind("hand", 0) == 0;
}

void Touch::armByItself() {
  // Who disarmed wants no force until they say otherwise, whatever the device does meanwhile.
  if (disarmed_) return;
  if (!armsItself()) return;
  const haptic::LoopState state = loop_->state();
  const bool waits =
      state.safety == haptic::SafetyState::kUncalibrated || state.safety == haptic::SafetyState::kFault;
  const std::int64_t now = nowNs();
  if (!waits || state.link != haptic::LinkState::kConnected || now - armed_try_ns_ < kArmAgain_ns) return;
  armed_try_ns_ = now;
  arm();
}

void Touch::measureRate() {
  const haptic::LoopState state = loop_->state();
  if (rate_ns_ == 0) {
    rate_ns_ = state.time_ns;
    rate_tick_ = state.tick;
    return;
  }
  if (state.time_ns - rate_ns_ < kRateWindow_ns) return;
  measured_rate_ =
      static_cast<double>(state.tick - rate_tick_) * 1e9 / static_cast<double>(state.time_ns - rate_ns_);
  rate_ns_ = state.time_ns;
  rate_tick_ = state.tick;
}

void Touch::watch() {
  const haptic::LoopState state = loop_->state();
  if (state.tick == 0) return;
  if (device_->profile().gives_force) {
    if (state.safety_counters.faults > seen_.safety_counters.faults)
      notices_.push_back({fmt::format("fault, {}", haptic::name(state.cause)), "press A to arm again"});
    if (state.safety_counters.arms_refused > seen_.safety_counters.arms_refused)
      notices_.push_back({"not armed", "the device must be connected, calibrated and heard of"});
    if (seen_.tick > 0 && state.link != seen_.link && state.link == haptic::LinkState::kUncalibrated)
      notices_.push_back({"the device is not calibrated", "hold the stylus in its home pose and calibrate"});
  }
  if (state.refused_edits > seen_.refused_edits)
    notices_.push_back({"memory for edits came too late", "part of a stroke was not done"});
  seen_ = state;
}

void Touch::noteShown(std::int64_t edit_ns, std::int64_t shown_ns) {
  latency_.add(shown_ns - edit_ns);
  last_latency_ms_ = 1e-6 * static_cast<double>(shown_ns - edit_ns);
}

}  // namespace fettle::app
