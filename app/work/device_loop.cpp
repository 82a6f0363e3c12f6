#include "app/work/device_loop.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include <fmt/format.h>

#include "app/live/placement.h"
#include "engine/base/stopwatch.h"
#include "haptic/effects/mark_distance.h"
#include "haptic/scene/scene_numbers.h"

namespace fettle::app {

Notice noticeOf(const engine::Error& error) {
  return {engine::Error{error.kind, error.what, error.where, ""}.line(), error.remedy};
}

void addNotice(std::vector<Notice>& notices, Notice notice) {
  const auto same = std::ranges::find_if(notices, [&](const Notice& other) {
    return !notice.several.empty() && other.several == notice.several;
  });
  if (same == notices.end()) {
    notices.push_back(std::move(notice));
    return;
  }
  ++same->times;
  same->what = fmt::format("{} {}", same->times, same->several);
  same->remedy.clear();
}
namespace {

using haptic::CommandKind;
using haptic::LoopCommand;
using haptic::LoopState;

constexpr std::size_t kRecordedTicks = 1
                                       << 16;  // over a minute at 1 kHz, in which the window may stand still
constexpr std::int64_t kArmAgain_ns = 100'000'000;
constexpr std::int64_t kRateWindow_ns = 500'000'000;

double spacingMm(const engine::Grid& grid) {
  return std::max(grid.spacingXMm(), grid.spacingYMm());
}

// The highest place of an upright field as it is felt; 0 of holes alone.
double topMm(const engine::Version& field, const haptic::Scene& scene) {
  const engine::Version felt = scene.invert ? field.inverted() : field;
  const engine::HeightBounds bounds = felt.reader().bounds();
  return bounds.empty() ? 0.0 : static_cast<double>(bounds.max) * field.grid().height_unit.mm;
}

// A hand in a room cannot be led as finely as a cursor: on a table of 0.6 m (app/xr/room_table) this is 6 mm.
double handsUnitMm(const engine::Grid& grid) {
  const double side_mm =
      std::max((grid.width - 1) * grid.spacingXMm(), (grid.height - 1) * grid.spacingYMm());
  return std::max(spacingMm(grid), 0.01 * side_mm);
}

// A hand without force: its depth replaces it. Two units deep is pressing hard, at every scale of the field.
haptic::Scene fittedToDepth(haptic::Scene scene, double unit_mm) {
  scene.stiffness_n_per_mm = std::min(scene.force_limit_n / (2.0 * unit_mm), haptic::kMostStiffness);
  return scene;
}

haptic::MouseFeel feelFor(double unit_mm) {
  haptic::MouseFeel feel;
  feel.hover_mm = unit_mm;
  feel.press_mm = unit_mm;
  feel.wheel_step_mm = 0.1 * unit_mm;
  feel.deepest_mm = 4.0 * unit_mm;
  return feel;
}

}  // namespace

std::shared_ptr<haptic::ControllerLink> controllersBeside(const std::string& device) {
  const haptic::KnownDriver* const driver = haptic::driverNamed(device).driver;
  return driver != nullptr && driver->needs_window ? std::make_shared<haptic::ControllerLink>() : nullptr;
}

DeviceLoop::DeviceLoop(LoopClientOptions options, const engine::Grid& grid)
    : options_(std::move(options)), driver_(haptic::driverNamed(options_.device).driver), grid_(grid) {}

template <class Fitted>
void DeviceLoop::fit(haptic::Scene& scene, Fitted fitted) {
  std::optional<SceneFit>& last = options_.fitting.last;
  const haptic::Scene plain = last ? plainOf(scene, *last) : scene;
  const haptic::Scene pure = fitted(plain);
  scene = last ? withEdits(pure, scene, last->fitted) : pure;
  last = SceneFit{plain, pure};
}

haptic::Scene DeviceLoop::unlowered(const haptic::Scene& scene) const {
  const std::optional<SceneFit>& lowering = options_.fitting.lowering;
  return lowering ? withEdits(plainOf(scene, *lowering), scene, lowering->fitted) : scene;
}

void DeviceLoop::undoLowering(haptic::Scene& scene) {
  scene = unlowered(scene);
  options_.fitting.lowering.reset();
}

engine::Status DeviceLoop::openDevice(haptic::Scene& scene) {
  const engine::Grid& grid = grid_;
  if (driver_ != nullptr && driver_->needs_window) {
    if (options_.controllers) {
      auto hands =
          std::make_unique<haptic::ControllerStylus>(feelFor(handsUnitMm(grid)), options_.controllers);
      mouse_ = &hands->mouse();
      device_ = std::move(hands);
      if (options_.fitting.fits)
        fit(scene, [&](const haptic::Scene& plain) { return fittedToDepth(plain, handsUnitMm(grid)); });
      return {};
    }
    auto mouse = std::make_unique<haptic::MouseStylus>(feelFor(spacingMm(grid)));
    mouse_ = mouse.get();
    device_ = std::move(mouse);
    if (options_.fitting.fits)
      fit(scene, [&](const haptic::Scene& plain) {
        haptic::Scene fitted = fittedToDepth(plain, spacingMm(grid));
        // A cursor jumps up and down walls around which a hand would move, and a local search would stay behind
        // them.
        fitted.level = haptic::ContactLevel::kCertified;
        fitted.certified_radius_cells = 6;  // more than the four cells that it presses at most
        return fitted;
      });
    return {};
  }
  auto device = haptic::openDevice(options_.device, options_.rate_hz);
  if (!device) return tl::unexpected(device.error());
  device_ = std::move(*device);
  // Its millimetres are the field's: nothing of another device's fit stays.
  if (options_.fitting.fits && device_->profile().space == haptic::DeviceSpace::kField)
    fit(scene, [](const haptic::Scene& plain) { return plain; });
  if (const auto known = options_.setups.find(setupKey(device_->profile())); known != options_.setups.end())
    setup_ = known->second;
  return {};
}

engine::Status DeviceLoop::start(const Start& start, std::vector<Notice>& notices) {
  const double before_hz = std::exchange(options_.rate_hz, start.rate_hz);
  unsent_.clear();
  seen_ = {};
  view_azimuth_deg_ = 0.0;
  view_zoom_ = 1.0;
  rate_meter_ = {};
  armed_try_ns_ = 0;
  std::unique_ptr<haptic::Device> before;  // outlives the old loop, which startLoop() replaces
  engine::Status status;
  // Its virtual time is that of the loop's ticks: a new hand, at the start of its path.
  if (loop_ && simulatesHand()) {
    auto device = haptic::openDevice(options_.device, options_.rate_hz);
    if (device)
      before = std::exchange(device_, std::move(*device));
    else
      status = tl::unexpected(device.error());
  }
  if (status) status = startLoop(start, notices);
  if (status) return {};
  // The old loop and its device remain readable.
  if (before) device_ = std::move(before);
  options_.rate_hz = before_hz;
  return status;
}

engine::Status DeviceLoop::startOn(const std::string& device, const Start& start,
                                   std::vector<Notice>& notices) {
  const LoopClientOptions options_before = options_;
  const haptic::KnownDriver* const driver_before = driver_;
  const DeviceSetup setup_before = setup_;
  haptic::MouseStylus* const mouse_before = mouse_;
  // Outlives the loop that reads it, which startLoop() replaces.
  std::unique_ptr<haptic::Device> device_before = std::move(device_);
  options_.device = device;
  options_.fitting.lowers = true;
  options_.controllers.reset();  // of a headset: they are beside the mouse of the start alone
  driver_ = haptic::driverNamed(device).driver;
  setup_ = {};
  mouse_ = nullptr;
  undoLowering(*start.scene);
  engine::Status status = openDevice(*start.scene);
  if (status) status = this->start(start, notices);
  if (status) return status;
  device_ = std::move(device_before);
  options_ = options_before;
  driver_ = driver_before;
  setup_ = setup_before;
  mouse_ = mouse_before;
  return status;
}

engine::Status DeviceLoop::startLoop(const Start& start, std::vector<Notice>& notices) {
  const engine::Grid& grid = grid_;
  const haptic::DeviceProfile& profile = device_->profile();
  haptic::Scene& scene = *start.scene;
  const haptic::Scene before = scene;
  undoLowering(scene);  // another setup or rate may hold more
  haptic::HapticLoop::Settings settings;
  settings.rate_hz = options_.rate_hz;
  settings.sounds = start.sounds;
  settings.options.tool = start.tool;
  settings.options.limits = sessionLimits(profile);
  settings.options.edit_rule =
      profile.gives_force ? haptic::EditRule::kWhileForceIsGiven : haptic::EditRule::kAnytime;
  // One drag is one step: outside the surface the mouse's tip lifts, and its button stays held.
  if (mouse_ != nullptr) settings.options.stroke_gap_ticks = std::numeric_limits<std::uint32_t>::max();
  // With a large field the main thread is sometimes busy for longer than a frame.
  settings.options.event_capacity = 1024;
  settings.options.command_capacity = 1024;
  settings.options.record_capacity = start.records ? kRecordedTicks : 0;
  if (profile.space == haptic::DeviceSpace::kDesk) {
    top_mm_ = topMm(start.field, scene);
    const glm::dvec3 middle{0.5 * (grid.width - 1) * grid.spacingXMm(),
                            0.5 * (grid.height - 1) * grid.spacingYMm(), top_mm_};
    const haptic::DeviceProfile reached = setup_.in(profile);
    if (options_.fitting.fits)
      fit(scene,
          [&](const haptic::Scene& plain) { return fittedScene(plain, reached, grid, options_.rate_hz); });
    scale_at_start_ = scaleFor(scene);
    const glm::dvec3 hand = setup_.reach ? setup_.reach->middle() : glm::dvec3(0.0);
    settings.options.workspace = haptic::Workspace(scale_at_start_, middle - scale_at_start_ * hand);
    settings.options.clutch_buttons = setup_.clutch_buttons;
    settings.options.menu_buttons = setup_.menu_buttons;
  }
  if (const auto problem = stabilityProblem(scene, options_.rate_hz)) {
    haptic::Scene lowered = haptic::stableScene(scene, profile, options_.rate_hz, scale_at_start_,
                                                haptic::MarkDistance::longestReachMm(grid));
    // For a device that is never stable there is no such scene.
    if (!lowers() || stabilityProblem(lowered, options_.rate_hz))
      return engine::inputError(problem->what, "scene", problem->remedy);
    options_.fitting.lowering = SceneFit{scene, lowered};
    scene = std::move(lowered);
    // Not again where the same was lowered at the start before.
    if (scene != before) notices.push_back({problem->what, "lowered to " + problem->remedy});
  }
  if (const auto problem = feltProblem(scene))
    notices.push_back(
        {problem->what, fmt::format("fit it in the panel Haptics, or take {}", problem->remedy)});
  auto loop = haptic::HapticLoop::create(start.field, start.original, scene, *device_, settings);
  if (!loop) return tl::unexpected(loop.error());
  if (auto status = device_->start(); !status) return status;
  if (auto status = (*loop)->start(); !status) {
    device_->stop();
    return status;
  }
  loop_ = std::move(*loop);
  running_ = true;
  return {};
}

void DeviceLoop::stop() {
  running_ = false;
  static_cast<void>(loop_->stop());
  device_->stop();
}

void DeviceLoop::send(LoopCommand&& command) {
  // The ring is only full while the loop does not run; it leaves a command that it has no place for as it is.
  // NOLINTNEXTLINE(bugprone-use-after-move)
  if (!unsent_.empty() || !loop_->send(std::move(command))) unsent_.push_back(std::move(command));
}

double DeviceLoop::liftTo(const engine::Version& field, const haptic::Scene& scene) {
  if (device_->profile().space != haptic::DeviceSpace::kDesk) return 0.0;
  const double before = std::exchange(top_mm_, topMm(field, scene));
  return top_mm_ - before;
}

void DeviceLoop::poll(std::vector<Notice>& notices) {
  while (!unsent_.empty() && loop_->send(std::move(unsent_.front()))) unsent_.erase(unsent_.begin());
  const LoopState state = loop_->state();
  armByItself(state);
  rate_meter_.measure(state);
  watch(state, notices);
}

void DeviceLoop::arm() {
  disarmed_ = false;
  send(loop_->armCommand());
}

void DeviceLoop::disarm() {
  disarmed_ = true;
  loop_->disarm();
}

bool DeviceLoop::armsItself() const {
  return !device_->profile().gives_force || simulatesHand();
}

bool DeviceLoop::atRest() {
  const LoopState& state = loop_->state();
  return unsent_.empty() && state.given_n == glm::dvec3(0.0) &&
         state.safety != haptic::SafetyState::kActive && state.safety != haptic::SafetyState::kRamping;
}

void DeviceLoop::setView(double azimuth_deg, double zoom) {
  if (device_->profile().space != haptic::DeviceSpace::kDesk) return;
  if (std::abs(std::remainder(azimuth_deg - view_azimuth_deg_, 360.0)) < 0.5 &&
      std::abs(zoom / view_zoom_ - 1.0) < 0.01)
    return;
  view_azimuth_deg_ = azimuth_deg;
  view_zoom_ = zoom;
  LoopCommand command;
  command.kind = CommandKind::kView;
  // Never stiffer than at the start, where the whole field was within reach or the device was at its limit.
  command.scale = scale_at_start_ / std::max(zoom, 1.0);
  command.turn_rad = azimuth_deg * std::numbers::pi / 180.0;
  send(std::move(command));
}

std::optional<haptic::StabilityProblem> DeviceLoop::stabilityProblem(const haptic::Scene& scene,
                                                                     double rate_hz) const {
  const haptic::DeviceProfile& profile = device_->profile();
  if (!profile.gives_force) return std::nullopt;
  return haptic::stabilityProblem(scene, profile, rate_hz, scale_at_start_,
                                  haptic::MarkDistance::longestReachMm(grid_));
}

double DeviceLoop::scaleFor(const haptic::Scene& scene) const {
  const haptic::DeviceProfile reached = setup_.in(device_->profile());
  return setup_.motion * (options_.fitting.fits ? wholeFieldScale(reached, grid_)
                                                : fittedScale(reached, grid_, scene, options_.rate_hz));
}

bool DeviceLoop::movesOtherwise(const haptic::Scene& scene) const {
  if (device_->profile().space != haptic::DeviceSpace::kDesk) return false;
  return scale_at_start_ !=
         setup_.motion * fittedScale(setup_.in(device_->profile()), grid_, scene, options_.rate_hz);
}

std::optional<FeltProblem> DeviceLoop::feltProblem(const haptic::Scene& scene) const {
  if (options_.fitting.fits) return std::nullopt;
  return app::feltProblem(scene, setup_.in(device_->profile()), grid_, options_.rate_hz,
                          scale_at_start_ / setup_.motion);
}

std::optional<double> DeviceLoop::largestStiffness(const haptic::Scene& scene) const {
  const haptic::DeviceProfile& profile = device_->profile();
  if (!profile.gives_force) return std::nullopt;
  return haptic::largestStiffness(scene, profile, options_.rate_hz, scale_at_start_);
}

void DeviceLoop::armByItself(const LoopState& state) {
  // After a disarm by the user only the user arms again, whatever the device does meanwhile.
  if (disarmed_ || !armsItself()) return;
  const bool waits =
      state.safety == haptic::SafetyState::kUncalibrated || state.safety == haptic::SafetyState::kFault;
  const std::int64_t now = engine::steadyNs();
  if (!waits || state.link != haptic::LinkState::kConnected || now - armed_try_ns_ < kArmAgain_ns) return;
  armed_try_ns_ = now;
  arm();
}

void DeviceLoop::RateMeter::measure(const LoopState& state) {
  if (time_ns != 0) {
    if (state.time_ns - time_ns < kRateWindow_ns) return;
    hz = static_cast<double>(state.tick - tick) * 1e9 / static_cast<double>(state.time_ns - time_ns);
  }
  time_ns = state.time_ns;
  tick = state.tick;
}

void DeviceLoop::watch(const LoopState& state, std::vector<Notice>& notices) {
  if (state.tick == 0) return;
  if (device_->profile().gives_force) {
    if (state.safety_counters.faults > seen_.safety_counters.faults)
      notices.push_back({fmt::format("fault, {}", haptic::name(state.cause)), "press A to arm again"});
    if (state.safety_counters.arms_refused > seen_.safety_counters.arms_refused)
      notices.push_back({"not armed", "the device must be connected, calibrated and sending input"});
    // Of one that is armed the fault says it.
    const bool armed =
        seen_.safety == haptic::SafetyState::kActive || seen_.safety == haptic::SafetyState::kRamping;
    if (seen_.tick > 0 && state.link != seen_.link && state.link == haptic::LinkState::kDisconnected &&
        !armed)
      notices.push_back({"the device was unplugged", "plug it in again"});
    if (seen_.tick > 0 && state.link != seen_.link && state.link == haptic::LinkState::kUncalibrated)
      notices.push_back({"the device is not calibrated", "hold the stylus in its home pose and calibrate"});
  }
  if (state.refused_edits > seen_.refused_edits)
    notices.push_back({"memory for edits was not available in time", "part of a stroke was not done"});
  choices_.tools += state.tool_choices - seen_.tool_choices;
  choices_.tips += state.tip_choices - seen_.tip_choices;
  choices_.menus += state.menu_choices - seen_.menu_choices;
  seen_ = state;
}

}  // namespace fettle::app
