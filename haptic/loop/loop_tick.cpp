#include "haptic/loop/loop_tick.h"

#include <cmath>
#include <limits>
#include <utility>

#include "haptic/safety/last_resort.h"

namespace fettle::haptic {

namespace {

bool hasAnswer(CommandKind kind) noexcept {
  return kind == CommandKind::kScene || kind == CommandKind::kSnapshot || kind == CommandKind::kAdopt ||
         kind == CommandKind::kRestore;
}

}  // namespace

LoopTick::LoopTick(std::unique_ptr<PreparedScene> scene, engine::Version start, Device& device,
                   LoopChannels& channels, const LoopOptions& options, TilePrefetcher* tile_prefetcher)
    : scene_(std::move(scene)),
      device_(device),
      channels_(channels),
      options_(options),
      guard_(options.limits),
      workspace_(options.workspace),
      tool_(options.tool),
      tile_prefetcher_(tile_prefetcher) {
  static_cast<void>(scene_->field.adopt(scene_->scene.invert ? start.inverted() : std::move(start)));
  scene_->tick.fieldChanged();
  published_ = scene_->field.snapshot();
  if (tile_prefetcher_ != nullptr) tile_prefetcher_->replaced();
}

engine::SampleRect LoopTick::wholeField() const noexcept {
  const engine::Grid& grid = scene_->field.grid();
  return {0, 0, grid.width, grid.height};
}

LoopEvent LoopTick::eventNow(EventKind kind, std::uint64_t id) noexcept {
  LoopEvent event;
  event.kind = kind;
  event.id = id;
  event.tick = state_.tick;
  event.stroke = state_.stroke;
  event.tool = edited_with_;
  event.merged = std::exchange(merged_, 0);
  event.rect = std::exchange(dirty_, {});
  event.before = std::move(published_);
  event.version = scene_->field.snapshot();
  published_ = event.version;
  since_publish_ = 0;
  return event;
}

// Only called when the ring is known to have a place.
void LoopTick::send(LoopEvent&& event) noexcept {
  const bool sent = channels_.events.push(std::move(event));
  assert(sent);
  static_cast<void>(sent);
}

void LoopTick::takeDisarm(std::uint64_t times) noexcept {
  if (times == disarms_) return;
  disarms_ = times;
  guard_.disarm();
}

void LoopTick::takeCommands() noexcept {
  // Acquire: pairs with LoopChannels::disarm().
  takeDisarm(channels_.disarms.load(std::memory_order_acquire));
  for (int i = 0; i < kMostCommands; ++i) {
    if (!has_waiting_ && !channels_.commands.pop(waiting_)) return;
    has_waiting_ = hasAnswer(waiting_.kind) && channels_.events.freePlaces() == 0;
    if (has_waiting_) return;
    take(waiting_);
    // One swap of versions per tick, which bounds its cost.
    if (hasAnswer(waiting_.kind)) return;
  }
}

void LoopTick::take(LoopCommand& command) noexcept {
  switch (command.kind) {
    case CommandKind::kTool:
      // Each stroke, a step of undo, has one tool.
      tool_replaced_ |= stroke_.running() && command.tool != tool_;
      tool_ = command.tool;
      break;
    case CommandKind::kWorkspace:
      workspace_ = command.workspace;
      disturbance_ = Disturbance::kSurfaceReplaced;
      break;
    case CommandKind::kView:
      workspace_.setView(command.scale, command.turn_rad, motion_.position());
      disturbance_ = Disturbance::kSurfaceReplaced;
      break;
    case CommandKind::kArm:
      if (command.id < disarms_) break;  // superseded
      takeDisarm(command.id);            // it may include one after this tick's read
      guard_.arm();
      break;
    case CommandKind::kScene:
      swapScene(command);
      break;
    case CommandKind::kSnapshot: {
      LoopEvent event = eventNow(EventKind::kSnapshot, command.id);
      event.retired_base = since_snapshot_.begin(event.version, command.id);
      send(std::move(event));
      break;
    }
    case CommandKind::kAdopt:
      adopt(command);
      break;
    case CommandKind::kRestore:
      restore(command);
      break;
  }
}

void LoopTick::swapScene(LoopCommand& command) noexcept {
  PreparedScene& next = *command.scene;
  const bool turn = next.scene.invert != scene_->scene.invert;
  // The live state moves over; the two fields are exchanged. The local copy of the live state is not the last
  // one, so destroying it frees nothing.
  {
    engine::Version placeholder = next.field.adopt(scene_->field.snapshot());
    const engine::Version live = scene_->field.adopt(std::move(placeholder));
  }
  refused_before_ += static_cast<std::uint64_t>(scene_->tick.counters().refused_edits);
  if (turn) next.field.invert();
  next.tick.fieldChanged();
  std::swap(scene_, command.scene);
  if (tile_prefetcher_ != nullptr) tile_prefetcher_->replaced();  // the original may have changed
  disturbance_ = Disturbance::kSurfaceReplaced;
  LoopEvent event = eventNow(EventKind::kSceneChanged, command.id);
  event.retired_scene = std::move(command.scene);
  if (turn) event.rect = wholeField();
  send(std::move(event));
}

void LoopTick::adopt(LoopCommand& command) noexcept {
  engine::LiveField& field = scene_->field;
  const float sign = field.reader().sign();
  bool done = false;
  if (since_snapshot_.covers(command.id)) {
    engine::Version live = field.adopt(std::move(command.version));
    const int carried = since_snapshot_.carryInto(field, live);
    done = carried >= 0;
    if (done) {
      if (field.reader().sign() != sign) field.invert();
      command.version = std::move(live);
      ++state_.adopted;
      state_.carried += static_cast<std::uint64_t>(carried);
    } else {
      command.version = field.adopt(std::move(live));
    }
    scene_->tick.fieldChanged();
    if (tile_prefetcher_ != nullptr) tile_prefetcher_->replaced();
  }
  LoopEvent event = eventNow(done ? EventKind::kAdopted : EventKind::kAdoptRefused, command.id);
  event.retired = std::move(command.version);
  if (done) {
    event.rect = wholeField();
    event.retired_base = since_snapshot_.end();
    disturbance_ = Disturbance::kSurfaceReplaced;
  }
  send(std::move(event));
}

void LoopTick::restore(LoopCommand& command) noexcept {
  const bool another = command.scene != nullptr;
  if (another) {
    refused_before_ += static_cast<std::uint64_t>(scene_->tick.counters().refused_edits);
    std::swap(scene_, command.scene);
    workspace_.lift(command.lift_mm);
  }
  engine::LiveField& field = scene_->field;
  const float sign = field.reader().sign();
  command.version = field.adopt(std::move(command.version));
  // The placeholder is held by the scene as well: it is not freed here.
  if (another) command.version = command.scene->field.snapshot();
  if (field.reader().sign() != sign) field.invert();
  scene_->tick.fieldChanged();
  if (tile_prefetcher_ != nullptr) tile_prefetcher_->replaced();
  disturbance_ = Disturbance::kSurfaceReplaced;
  since_snapshot_.drop();
  stroke_.reset();
  LoopEvent event = eventNow(EventKind::kRestored, command.id);
  event.retired = std::move(command.version);
  event.retired_scene = std::move(command.scene);
  event.rect = wholeField();
  send(std::move(event));
}

Tool LoopTick::toolInEffect(const DeviceInput& input, double age_s) const noexcept {
  // No editing without recent input.
  if (input.link != LinkState::kConnected || age_s >= options_.limits.silence_s) return Tool::kFeel;
  if (options_.edit_rule == EditRule::kWhileForceIsGiven && guard_.state() != SafetyState::kRamping &&
      guard_.state() != SafetyState::kActive)
    return Tool::kFeel;
  if (input.tool) return *input.tool;
  const bool on = options_.tool_switch == ToolSwitch::kAlways || buttons_.stroke();
  return on && !tool_replaced_ ? tool_ : Tool::kFeel;
}

std::optional<glm::dvec3> LoopTick::stylusAxis(const DeviceInput& input) const noexcept {
  if (!input.orientation || input.link != LinkState::kConnected) return std::nullopt;
  const glm::dvec3 axis = *input.orientation * glm::dvec3(0.0, 0.0, 1.0);
  return device_.profile().space == DeviceSpace::kField ? axis : workspace_.directionToField(axis);
}

Touched LoopTick::touched(const ForceSample& force, std::int64_t now_ns) const noexcept {
  if (!force.contact) return {};
  const bool armed = guard_.state() == SafetyState::kRamping || guard_.state() == SafetyState::kActive;
  const double share = glm::length(force.force_n) / scene_->scene.force_limit_n;
  return {true, force.proxy_mm, force.force_n, armed && share > 0.0 ? std::min(share, 1.0) : 0.0, now_ns};
}

void LoopTick::record(const StrokeSample& input, const ForceSample& force, std::int64_t since_ns) noexcept {
  if (options_.record_capacity == 0) return;
  if (!channels_.records.push({input, guard_.force(), since_ns, force.contact})) ++state_.lost_records;
}

// A full ring: nothing plays, and the stream that empties it begins with the newest ticks.
void LoopTick::sound(std::int64_t since_ns) noexcept {
  const SoundTick* const heard = scene_->tick.heard();
  if (heard == nullptr || scene_->sounds == nullptr) return;
  SoundTick tick = *heard;
  tick.seconds = static_cast<float>(1e-9 * static_cast<double>(since_ns));
  static_cast<void>(scene_->sounds->push(SoundTick(tick)));
}

// A tick may read samples around the tip, the previous tip and the proxy.
bool LoopTick::samplesArePrefetched(const glm::dvec3& tip_mm) noexcept {
  if (!finite(tip_mm)) return true;  // no input reads nothing
  const engine::Grid& grid = scene_->field.grid();
  const auto sample = [](double mm, double spacing_mm, std::int32_t side) {
    return static_cast<std::int32_t>(std::clamp(std::floor(mm / spacing_mm), 0.0, side - 1.0));
  };
  const std::int32_t column = sample(tip_mm.x, grid.spacingXMm(), grid.width);
  const std::int32_t row = sample(tip_mm.y, grid.spacingYMm(), grid.height);
  const glm::dvec3 before = finite(state_.endpoint_mm) ? state_.endpoint_mm : tip_mm;
  const glm::dvec3 proxy = finite(state_.proxy_mm) ? state_.proxy_mm : tip_mm;
  engine::SampleRect rect{column, row, 1, 1};
  // Only a tick with contact continues from the previous position.
  if (was_prefetched_ && state_.tick > 0)
    for (const glm::dvec3& p : {before, proxy})
      rect = rect.joined(
          {sample(p.x, grid.spacingXMm(), grid.width), sample(p.y, grid.spacingYMm(), grid.height), 1, 1});
  const std::int32_t c0 = std::max(rect.column - TilePrefetcher::kMargin, 0);
  const std::int32_t r0 = std::max(rect.row - TilePrefetcher::kMargin, 0);
  rect = {c0, r0, std::min(rect.column + rect.columns + TilePrefetcher::kMargin, grid.width) - c0,
          std::min(rect.row + rect.rows + TilePrefetcher::kMargin, grid.height) - r0};
  const bool ready = tile_prefetcher_->ready(scene_->field, scene_->original, rect, column, row);
  if (ready != was_prefetched_) disturbance_ = Disturbance::kSurfaceReplaced;
  was_prefetched_ = ready;
  return ready;
}

void LoopTick::noteEdit(const ForceSample& force, Tool tool) noexcept {
  if (!force.contact || !scene_->tick.effects().edits(tool)) {
    stroke_.rested(tool == Tool::kFeel, options_.stroke_gap_ticks);
    return;
  }
  edited_with_ = tool;
  const auto reach = static_cast<std::int32_t>(std::floor(scene_->scene.*brushRadiusOf(tool)));
  const CellIndex centre = scene_->tick.contact().proxy.cell;
  const engine::Grid& grid = scene_->field.grid();
  const std::int32_t c0 = std::max(centre.column - reach, 0);
  const std::int32_t r0 = std::max(centre.row - reach, 0);
  const engine::SampleRect rect{c0, r0, std::min(centre.column + reach + 1, grid.width) - c0,
                                std::min(centre.row + reach + 1, grid.height) - r0};
  dirty_ = dirty_.joined(rect);
  since_snapshot_.add(rect);
  if (stroke_.edited(rect)) ++state_.stroke;
}

void LoopTick::publish() noexcept {
  ++since_publish_;
  const bool due = since_publish_ >= options_.publish_ticks && !dirty_.empty();
  if (!due && !stroke_.hasEnded()) return;
  if (!stroke_.hasEnded() && published_ == scene_->field.snapshot()) {
    // The root is still shared with the published version, so nothing was written since.
    dirty_ = {};
    since_publish_ = 0;
    return;
  }
  if (channels_.events.freePlaces() <= kAnswerPlaces) {
    if (since_publish_ < options_.publish_ticks) return;
    since_publish_ = 0;
    ++merged_;
    ++state_.merged;
    return;
  }
  LoopEvent event = eventNow(stroke_.hasEnded() ? EventKind::kStrokeEnded : EventKind::kEdited, 0);
  if (stroke_.hasEnded()) event.rect = event.rect.joined(stroke_.takeEnded());
  send(std::move(event));
}

void LoopTick::run(std::int64_t now_ns, std::int64_t since_ns) noexcept {
  disturbance_ = Disturbance::kNone;
  tool_replaced_ = false;
  takeCommands();
  if (LastResort::fired()) guard_.lastResort();

  const DeviceInput input = device_.read();
  const double age_s = 1e-9 * static_cast<double>(std::max<std::int64_t>(now_ns - input.arrival_ns, 0));
  motion_.note(input);
  const bool in_field = device_.profile().space == DeviceSpace::kField;
  const std::uint32_t clutch_buttons = in_field ? 0U : options_.clutch_buttons;
  buttons_.note(input, {clutch_buttons, options_.menu_buttons}, now_ns);
  const bool clutched = (input.buttons & clutch_buttons) != 0;
  if (clutched != clutched_) disturbance_ = Disturbance::kSurfaceReplaced;
  clutched_ = clutched;
  workspace_.setClutch(clutched ? Workspace::Clutch::kHeld : Workspace::Clutch::kReleased, input.position_mm);
  const glm::dvec3 tip_mm = in_field ? input.position_mm : workspace_.toField(input.position_mm);
  const Tool tool = clutched ? Tool::kFeel : toolInEffect(input, age_s);

  if (first_ns_ < 0) first_ns_ = now_ns;
  StrokeSample sample{1e-9 * static_cast<double>(now_ns - first_ns_), tip_mm, tool};
  if (input.link != LinkState::kConnected) sample.tip_mm.x = std::numeric_limits<double>::quiet_NaN();
  if (tile_prefetcher_ != nullptr && !samplesArePrefetched(sample.tip_mm)) {
    sample.tip_mm.x = std::numeric_limits<double>::quiet_NaN();
    ++state_.not_prefetched;
  }
  const ForceSample force = scene_->tick.run(sample);

  const glm::dvec3 command = in_field ? force.force_n : workspace_.forceToDevice(force.force_n);
  const glm::dvec3 weight = scene_->tick.weight();
  const glm::dvec3 at_rest = in_field ? weight : workspace_.forceToDevice(weight);
  const glm::dvec3 given = guard_.step(
      {1e-9 * static_cast<double>(since_ns), age_s, input.link, command, motion_.velocity(), disturbance_,
       1e-9 * static_cast<double>(input.output_waits_ns), at_rest, input.output_pending});
  device_.write(given);
  device_.show(touched(force, now_ns));

  sound(since_ns);
  ++state_.tick;
  record(sample, force, since_ns);
  noteEdit(force, tool);
  publish();

  state_.time_ns = now_ns;
  if (finite(tip_mm)) {
    state_.endpoint_mm = tip_mm;
    state_.proxy_mm = force.contact ? force.proxy_mm : tip_mm;
  }
  state_.force_n = force.force_n;
  state_.given_n = given;
  state_.contact = force.contact;
  state_.device_mm = input.position_mm;
  state_.stylus_axis = stylusAxis(input);
  state_.tool = tool;
  state_.buttons = input.buttons;
  state_.tool_choices = buttons_.tools();
  state_.tip_choices = buttons_.tips();
  state_.menu_choices = buttons_.menus();
  state_.link = input.link;
  state_.safety = guard_.state();
  state_.cause = guard_.cause();
  state_.refused_edits = refused_before_ + static_cast<std::uint64_t>(scene_->tick.counters().refused_edits);
  state_.counters = scene_->tick.counters();
  state_.safety_counters = guard_.counters();
  channels_.state.publish(state_);
}

void LoopTick::stop() noexcept {
  guard_.disarm();
  device_.write(glm::dvec3(0.0));
  device_.show({});
  stroke_.end();
  since_publish_ = options_.publish_ticks;
  publish();
}

}  // namespace fettle::haptic
