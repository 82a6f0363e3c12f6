#include "app/work/loop_client.h"

#include <chrono>
#include <cstdlib>
#include <thread>

#include <fmt/format.h>

#include "app/texts/texts.h"
#include "engine/field/difference.h"
#include "engine/measure/form_kind.h"
#include "engine/session/form_codec.h"
#include "haptic/journal/mark_codec.h"
#include "haptic/loop/pacer.h"
#include "haptic/safety/last_resort.h"

namespace fettle::app {
namespace {

using haptic::CommandKind;
using haptic::EventKind;
using haptic::LoopCommand;
using namespace std::chrono_literals;

// Of a form that is moved to the newest field on the main thread: some milliseconds.
constexpr std::int64_t kMostTilesMoved = 256;
constexpr auto kPollInterval = 1ms;  // between two reads of the state while a force fades
// The loop takes commands at its next tick; one that has stood still for so long is not waited for.
constexpr auto kLongestAnswer = 50ms;
constexpr auto kAnswerInterval = 200us;
constexpr auto kLongestFade = 100ms;  // a disarmed force has faded after peak / slew = 5 ms

}  // namespace

LoopClient::LoopClient(engine::History history, FormOriginals originals, const haptic::Scene& scene,
                       const LoopClientOptions& options, haptic::SessionSink* sink)
    : originals_(std::move(originals)),
      scene_(scene),
      steps_(std::move(history), sink),
      sound_(options.loudness),
      loop_(options, originals_.scan().grid()) {}

engine::Result<std::unique_ptr<LoopClient>> LoopClient::start(engine::History history,
                                                              FormOriginals originals,
                                                              const haptic::Scene& scene,
                                                              const LoopClientOptions& options,
                                                              haptic::SessionSink* sink) {
  engine::JobControl job;
  if (auto made = originals.makeAll(history, job); !made) return tl::unexpected(made.error());
  std::unique_ptr<LoopClient> client(
      new LoopClient(std::move(history), std::move(originals), scene, options, sink));
  if (auto status = haptic::LastResort::install(); !status) return tl::unexpected(status.error());
  // The exit path when the display is lost (render/window/window.cpp).
  static const int at_quick_exit = std::at_quick_exit([] { haptic::LastResort::fire(); });
  static_cast<void>(at_quick_exit);
  if (auto status = client->loop_.openDevice(client->scene_); !status) return tl::unexpected(status.error());
  if (auto status = client->startLoop(options.rate_hz); !status) return tl::unexpected(status.error());
  for (const std::string& missing : client->realTime().missing)
    client->notices_.push_back(
        {.what = textOf("the system did not grant the loop everything"), .remedy = missing, .once = true});
  return client;
}

LoopClient::~LoopClient() {
  finish();
}

// Starts from the history's state. The data of the previous loop is reset.
engine::Status LoopClient::startLoop(double rate_hz, const std::string& device) {
  field_ = scene_.invert ? history().current().inverted() : history().current();
  path_ = StrokePath(field_.grid());
  place_ = {};
  restores_open_ = 0;
  offer_open_ = false;
  latency_.restart();
  DeviceLoop::Start start;
  start.field = history().current();
  start.original = originals_.at(start.field);
  sent_form_ = start.field.formOver();
  start.scene = &scene_;
  start.tool = tool_;
  start.records = steps_.journal().records();
  start.rate_hz = rate_hz;
  hear();
  start.sounds = sound_.ring();
  engine::Status status =
      device.empty() ? loop_.start(start, notices_) : loop_.startOn(device, start, notices_);
  if (!status) return status;
  steps_.begin(scene_);
  return {};
}

void LoopClient::hear() {
  if (const engine::Status status = sound_.follow(scene_); !status)
    notices_.push_back({status.error().what, status.error().remedy});
}

engine::Status LoopClient::setRate(double rate_hz) {
  if (finished() || rate_hz == rate()) return {};
  if (!(rate_hz >= haptic::Pacer::kLowestRate_hz && rate_hz <= haptic::Pacer::kHighestRate_hz))
    return engine::inputError("a loop runs at 1000 to 10000 ticks per second", "rate");
  // What is lowered at a start is not refused before it.
  if (const auto problem = loop_.stabilityProblem(scene_, rate_hz); problem && !loop_.lowers())
    return engine::inputError(problem->what, "rate", "first take " + problem->remedy);
  const bool disarmed = loop_.disarmed();
  const double before_hz = rate();
  endForAnother();
  engine::Status status = startLoop(rate_hz);
  if (!status) static_cast<void>(startLoop(before_hz));
  loop_.setDisarmed(disarmed);
  if (status) noteDisarmed(trFormat("the loop runs at {:g} Hz now, without force", rate_hz));
  return status;
}

engine::Status LoopClient::setDeviceSetup(const DeviceSetup& setup) {
  if (finished() || setup == loop_.setup()) return {};
  const bool disarmed = loop_.disarmed();
  const DeviceSetup before = loop_.setup();
  const double same_hz = rate();
  endForAnother();
  loop_.setSetup(setup);
  engine::Status status = startLoop(same_hz);
  if (!status) {
    loop_.setSetup(before);
    static_cast<void>(startLoop(same_hz));
  }
  loop_.setDisarmed(disarmed);
  if (status) noteDisarmed(tr("the device is used as you said, without force"));
  return status;
}

engine::Status LoopClient::openScene(const haptic::Scene& scene) {
  if (const auto problem = haptic::sceneProblem(scene)) return engine::inputError(*problem, "scene");
  if (!loop_.movesOtherwise(scene)) {
    engine::Status set = setScene(scene);
    if (set) loop_.setFitting({.fits = false});
    return set;
  }
  return startWith(scene, {.fits = false});
}

engine::Status LoopClient::fitScene() {
  return startWith(loop_.unlowered(scene_), {.fits = true, .lowers = true});
}

engine::Status LoopClient::startWith(const haptic::Scene& scene, const SceneFitting& fitting) {
  if (finished()) return {};
  const bool disarmed = loop_.disarmed();
  const haptic::Scene before = scene_;
  const SceneFitting fitting_before = loop_.fitting();
  const double same_hz = rate();
  endForAnother();
  scene_ = scene;
  loop_.setFitting(fitting);
  engine::Status status = startLoop(same_hz);
  if (!status) {
    scene_ = before;
    loop_.setFitting(fitting_before);
    static_cast<void>(startLoop(same_hz));
  }
  loop_.setDisarmed(disarmed);
  if (status) noteDisarmed(tr("the scene is felt at another scale, without force"));
  return status;
}

engine::Status LoopClient::setDevice(const std::string& words) {
  if (finished() || words == deviceWords()) return {};
  const bool disarmed = loop_.disarmed();
  const haptic::Scene before = scene_;
  const double same_hz = rate();
  endForAnother();
  engine::Status status = startLoop(same_hz, words);
  if (!status) {
    scene_ = before;
    static_cast<void>(startLoop(same_hz));
  }
  // What armed itself does so again; whoever holds another device has not disarmed it.
  loop_.setDisarmed(!status && disarmed);
  if (status) noteDisarmed(trFormat("the device is the {} now, without force", device().profile().name));
  return status;
}

void LoopClient::endForAnother() {
  if (haptic::MouseStylus* mouse = loop_.mouse()) {
    mouse->release();
    mouse->leave();
  }
  finish();
}

void LoopClient::noteDisarmed(const std::string& what) {
  if (device().profile().gives_force && !loop_.armsItself())
    notices_.push_back({what, textOf("press A to arm again")});
}

void LoopClient::finish() {
  closePort();
  if (finished()) return;
  disarm();
  const auto latest = std::chrono::steady_clock::now() + kLongestFade;
  while (device().profile().gives_force && std::chrono::steady_clock::now() < latest) {
    poll();
    if (loop_.atRest()) break;
    std::this_thread::sleep_for(kPollInterval);
  }
  loop_.stop();
  // The loop's last events; its ring still contains all of them.
  for (haptic::LoopEvent event; loop_.loop().poll(event);) held_.push_back(std::move(event));
  takeTicks();
  for (; !held_.empty(); held_.pop_front()) take(std::move(held_.front()));
  keepStroke();
  steps_.journal().flush();
}

bool LoopClient::strokeRuns() const noexcept {
  return restores_open_ == 0 && steps_.differs(upright(field_));
}

// A running stroke becomes a step with its edits so far.
void LoopClient::keepStroke() {
  if (strokeRuns()) steps_.keepStroke(upright(field_), place_);
}

void LoopClient::poll() {
  if (finished()) return;
  loop_.poll(notices_);
  for (haptic::LoopEvent event; loop_.loop().poll(event);) held_.push_back(std::move(event));
  takeTicks();
  for (; !held_.empty() && steps_.journal().reached(held_.front()); held_.pop_front())
    take(std::move(held_.front()));
  sendQuestion();
  steps_.journal().flushWhenDue();
  // One that was undone is often meant to be made again in another manner; several may be work.
  if (const std::int64_t replaced = steps_.takeReplaced(); replaced > 1)
    notices_.push_back(
        {trFormat("the new step took the place of {} that were undone", replaced), "", "", 1, false, true});
}

template <class Open>
void LoopClient::pollWhile(const Open& open) {
  poll();
  const auto latest = std::chrono::steady_clock::now() + kLongestAnswer;
  while (open() && !finished() && std::chrono::steady_clock::now() < latest) {
    std::this_thread::sleep_for(kAnswerInterval);
    poll();
  }
}

void LoopClient::catchUp() {
  pollWhile([this] { return offer_open_; });
}

void LoopClient::awaitRestored() {
  pollWhile([this] { return restores_open_ > 0; });
}

void LoopClient::takeTicks() {
  const bool none = path_.empty();
  const bool lost = steps_.journal().takeTicks(loop_.loop(), path_);
  if (none && !path_.empty()) path_base_ = history().current();
  if (lost)
    notices_.push_back({textOf("the window did not respond for too long to record every tick"),
                        textOf("the work is kept; the journal cannot replay beyond this point")});
}

void LoopClient::take(haptic::LoopEvent&& event) {
  // Not of the tool that is chosen by now: one that Shift or Ctrl took for a stroke is given back when the button is up.
  steps_.strokeIsOf(event.tool);
  // The history is already where the loop will be after its answer.
  const bool replaced = restores_open_ > 0;
  // A stroke running when a filter's result was adopted is a separate step before it.
  if (event.kind == EventKind::kAdopted && !event.before.empty() && !steps_.adopting() && !replaced)
    steps_.keepStroke(upright(event.before), place_);
  steps_.journal().answered(event);
  if (!event.version.empty()) {
    field_ = event.version;
    place_ = {event.tick, isAnswer(event.kind)};
  }
  switch (event.kind) {
    case EventKind::kEdited:
      latency_.noteEdit(event, loop_.loop().state(), rate());
      break;
    case EventKind::kStrokeEnded:
      if (replaced) break;
      endPath(event);
      if (event.rect.empty() || !steps_.differs(upright(event.version))) break;
      latency_.noteEdit(event, loop_.loop().state(), rate());
      steps_.endStroke(upright(event.version),
                       {event.rect.column, event.rect.row, event.rect.columns, event.rect.rows}, place_);
      break;
    case EventKind::kSnapshot:
      mailbox_.answer(event.version, false);
      break;
    case EventKind::kAdopted:
      offer_open_ = false;
      if (!replaced) steps_.adopted(upright(event.version), place_);
      mailbox_.answer(event.version, true);
      break;
    case EventKind::kAdoptRefused:
      offer_open_ = false;
      mailbox_.answer(event.version.empty() ? field_ : event.version, false);
      break;
    case EventKind::kRestored:
      if (restores_open_ > 0) --restores_open_;
      path_.dropBefore(event.tick);  // the loop has ended the stroke
      steps_.restored(upright(event.version));
      break;
    case EventKind::kSceneChanged:
      break;
  }
  latency_.noteEvent(event);
  // What the event still holds is freed here, off the loop.
}

// The event comes before the step of the stroke, if it makes one.
void LoopClient::endPath(const haptic::LoopEvent& event) {
  for (StrokePath::Ended& ended : path_.endAt(event.tick))
    mark_strokes_.push_back({ended.tool, std::move(ended.pieces), path_base_, upright(event.version)});
}

void LoopClient::setTool(haptic::Tool tool) {
  tool_ = tool;
  LoopCommand command;
  command.kind = CommandKind::kTool;
  command.tool = tool;
  loop_.send(std::move(command));
}

engine::Status LoopClient::setScene(const haptic::Scene& scene) {
  // First, as its largest value is the smaller one.
  if (const auto problem = stabilityProblem(scene))
    return engine::inputError(problem->what, "scene", problem->remedy);
  if (const auto problem = haptic::sceneProblem(scene)) return engine::inputError(*problem, "scene");
  scene_ = scene;
  hear();
  LoopCommand command;
  command.kind = CommandKind::kScene;
  command.id = next_id_++;
  command.scene = std::make_unique<haptic::PreparedScene>(scene_, originals_.at(newest()), sound_.ring());
  steps_.journal().sceneSent(command.id, scene_);
  loop_.send(std::move(command));
  return {};
}

void LoopClient::restore(const engine::Version& version) {
  LoopCommand command;
  command.kind = CommandKind::kRestore;
  command.id = next_id_++;
  command.version = scene_.invert ? version.inverted() : version;
  // Changes are limited by the original under the same form from the same tick on. A filter that is being adopted was
  // computed under another.
  if (const engine::FieldForm& form = version.formOver(); form != sent_form_) {
    sent_form_ = form;
    command.scene = std::make_unique<haptic::PreparedScene>(scene_, originals_.at(version), sound_.ring());
    command.lift_mm = loop_.liftTo(version, scene_);
    closePort();
  }
  ++restores_open_;
  steps_.restoreRequested(command.id);
  loop_.send(std::move(command));
}

void LoopClient::undo() {
  catchUp();
  keepStroke();
  mark_strokes_.clear();
  if (const auto version = steps_.undo()) restore(*version);
}

void LoopClient::redo() {
  catchUp();
  if (!canRedo()) return;
  mark_strokes_.clear();
  if (const auto version = steps_.redo()) restore(*version);
}

void LoopClient::goTo(std::int64_t state) {
  catchUp();
  keepStroke();
  mark_strokes_.clear();
  if (state == history().number()) return;
  if (const auto version = steps_.goTo(state)) restore(*version);
}

bool LoopClient::change(const engine::Version& base, const engine::Version& changed, std::string name,
                        const std::optional<TakenEdges>& edges) {
  catchUp();
  keepStroke();
  const engine::Version& now = history().current();  // field() may lag behind an undo
  const bool lines = base.lines() != changed.lines();
  if (lines && base.lines() != now.lines()) return false;
  std::string data = lines ? haptic::packLineChange(base, changed) : haptic::packMarkChanges(base, changed);
  auto after = base == now ? engine::Result<engine::Version>(changed)
               : lines     ? haptic::applyLineChange(now, data)
                           : haptic::applyMarkChanges(now, data);
  if (!after) {
    notices_.push_back({after.error().what, after.error().remedy});
    return true;
  }
  StepKeeper::HandChange change{std::move(data), {}};
  if (edges && engine::sameHeights(edges->searched, now)) change.suggested = edges->numbers;
  steps_.change(std::move(name), lines ? engine::StepKind::kLines : engine::StepKind::kMark, *after, place_,
                std::move(change));
  restore(*after);
  return true;
}

bool LoopClient::changeForm(FormChange& change) {
  catchUp();
  keepStroke();
  const engine::Version& now = history().current();
  if (!(now == change.base)) {
    if (engine::measureChange(change.base, now).tiles > kMostTilesMoved) return false;
    engine::JobControl job;
    if (auto moved = change.moveTo(now, job); !moved) {
      notices_.push_back({moved.error().what, moved.error().remedy});
      return true;
    }
  }
  originals_.add(change.original);
  StepKeeper::HandChange made;
  made.data = engine::packForm(change.form);
  made.heights = change.step == FormStep::kMakeHeights;
  if (change.choice)
    made.fitted = haptic::journal::FormFitted{std::string(engine::infoOf(change.choice->kind).word),
                                              std::string(engine::wordOf(change.choice->region)),
                                              change.choice->robust, change.choice->through};
  const engine::Version after = change.changed;
  steps_.change(change.name, engine::StepKind::kForm, after, place_, std::move(made));
  restore(after);
  originals_.keepFor(history(), field_);
  return true;
}

bool LoopClient::changeHeights(const engine::Version& base, const engine::Version& changed, std::string name,
                               const haptic::HeightsMaker& maker) {
  catchUp();
  keepStroke();
  if (!(base == history().current())) return false;
  StepKeeper::HandChange made;
  made.maker = maker;
  steps_.change(std::move(name), engine::StepKind::kFilter, changed, place_, std::move(made));
  restore(changed);
  return true;
}

void LoopClient::prepend(engine::Step step, const engine::Version& original) {
  originals_.add(original);
  steps_.prepend(std::move(step));
}

void LoopClient::noteFilterBegun(std::uint64_t base, const engine::FilterSpec& spec, std::string name) {
  steps_.nameAdoption(std::move(name));
  steps_.journal().filterBegun(base, spec);
}

void LoopClient::allowPort() {
  mailbox_.open();
  steps_.endAdoption();
}

void LoopClient::sendQuestion() {
  std::optional<LoopCommand> command = mailbox_.takeCommand(next_id_);
  if (!command) return;
  if (command->kind == CommandKind::kAdopt) {
    steps_.journal().offerMade();
    offer_open_ = true;
  }
  loop_.send(std::move(*command));
}

}  // namespace fettle::app
