#include "haptic/devices/wooden/wooden_haptics.h"

#include <algorithm>
#include <utility>

#include "engine/base/stopwatch.h"
#include "haptic/devices/wooden/wooden_kinematics.h"

namespace fettle::haptic {

namespace {

DeviceProfile withSerial(DeviceProfile profile, std::string serial) {
  profile.serial = std::move(serial);
  return profile;
}

}  // namespace

WoodenHaptics::WoodenHaptics(const WoodenConfig& config, std::unique_ptr<ReportSource> source,
                             std::optional<WoodenForm> form, const OutputTimes& times, std::string serial)
    : config_(config),
      profile_(withSerial(woodenProfile(config), std::move(serial))),
      fixed_form_(form),
      home_{static_cast<std::int16_t>(config.calibrate_enc[0]),
            static_cast<std::int16_t>(config.calibrate_enc[1]),
            static_cast<std::int16_t>(config.calibrate_enc[2])},
      link_(std::move(source), *this, times) {}

WoodenHaptics::~WoodenHaptics() {
  link_.stop();
}

DeviceInput WoodenHaptics::read() noexcept {
  state_.take();
  DeviceInput input = state_.latest().input;
  const std::int64_t since = link_.writingSinceNs();
  input.output_waits_ns = since == 0 ? 0 : std::max<std::int64_t>(engine::steadyNs() - since, 0);
  input.output_pending = link_.outputPending();
  return input;
}

void WoodenHaptics::write(const glm::dvec3& force_n) noexcept {
  const State& state = state_.latest();
  if (state.input.link != LinkState::kConnected) {
    link_.write(glm::dvec3{0.0});
    return;
  }
  const glm::dvec3 torques = woodenTorques(config_, state.angles, deskToWooden(force_n));
  const LimitedCurrents limited = limitCurrents(config_, woodenCurrents(config_, torques));
  if (limited.scale < 1.0) scaled_forces_.fetch_add(1, std::memory_order_relaxed);
  link_.write(limited.ma);
}

engine::Status WoodenHaptics::start() {
  return link_.start();
}

void WoodenHaptics::stop() noexcept {
  link_.stop();
}

void WoodenHaptics::calibrate() noexcept {
  calibration_requested_.store(true, std::memory_order_relaxed);
}

DeviceCounters WoodenHaptics::counters() const noexcept {
  DeviceCounters c = link_.counters();
  c.scaled_forces = scaled_forces_.load(std::memory_order_relaxed);
  c.faults = faults_.load(std::memory_order_relaxed);
  c.lost_inputs = lost_inputs_.load(std::memory_order_relaxed);
  return c;
}

void WoodenHaptics::setForm(std::optional<WoodenForm> form) noexcept {
  form_ = form;
  form_seen_.store(form ? static_cast<int>(*form) : -1, std::memory_order_relaxed);
  calibration_.reset();
  if (!form) return;
  using Method = WoodenCalibration::Method;
  calibration_.emplace(*form == WoodenForm::kP14 ? Method::kDevice : Method::kHost, home_);
}

Pacing WoodenHaptics::pacing() const noexcept {
  // Not known yet: a W8 sends a report within a millisecond, a P14 may be waiting for a reply that the
  // previous host never sent; the zeros that lock-step sends without input make it continue.
  return form_ == WoodenForm::kW8 ? Pacing::kFree : Pacing::kLockStep;
}

Pacing WoodenHaptics::onOpen(std::size_t input_bytes) noexcept {
  setForm(fixed_form_ ? fixed_form_ : woodenFormOfSize(input_bytes));
  counter_.reset();
  calibration_requested_.store(false, std::memory_order_relaxed);  // requested before there was a device
  preset_requested_.store(false, std::memory_order_relaxed);
  newest_.input.link = LinkState::kUncalibrated;
  newest_.input.buttons = 0;
  state_.publish(newest_);
  return pacing();
}

bool WoodenHaptics::onReport(std::span<const std::uint8_t> report, std::int64_t arrival_ns) noexcept {
  if (!form_) setForm(woodenFormOfSize(report.size()));
  if (!form_) return false;
  const std::optional<WoodenReport> r = decodeWooden(*form_, report);
  if (!r) return false;
  if (r->fault != 0) faults_.fetch_add(1, std::memory_order_relaxed);
  if (counter_ && r->counter != 0) {  // 0: old firmware does not count
    const auto step = static_cast<std::uint16_t>(r->counter - *counter_);
    if (step > 1) lost_inputs_.fetch_add(step - 1U, std::memory_order_relaxed);
  }
  counter_ = r->counter;

  const bool asked = calibration_requested_.load(std::memory_order_relaxed) &&
                     calibration_requested_.exchange(false, std::memory_order_relaxed);
  calibration_->onReport(*r, asked, presets_sent_.load(std::memory_order_relaxed));
  preset_requested_.store(calibration_->presetRequested(), std::memory_order_relaxed);
  newest_.input.buttons = r->stylus_button ? kPrimaryButton : 0;
  newest_.input.arrival_ns = arrival_ns;
  return true;
}

Pacing WoodenHaptics::onCaughtUp(std::uint64_t inputs) noexcept {
  newest_.input.sequence = inputs;
  const bool calibrated = calibration_->calibrated();
  newest_.input.link = calibrated ? LinkState::kConnected : LinkState::kUncalibrated;
  if (calibrated) {
    newest_.angles = woodenAngles(config_, calibration_->counts());
    newest_.input.position_mm = 1000.0 * woodenToDesk(woodenPosition(config_, newest_.angles));
  }
  state_.publish(newest_);
  may_give_force_.store(calibrated, std::memory_order_relaxed);
  return pacing();
}

void WoodenHaptics::onLost() noexcept {
  may_give_force_.store(false, std::memory_order_relaxed);
  newest_.input.link = LinkState::kDisconnected;
  newest_.input.buttons = 0;
  state_.publish(newest_);
}

std::size_t WoodenHaptics::encode(const glm::dvec3& currents_ma, std::span<std::uint8_t> report) noexcept {
  const int form = form_seen_.load(std::memory_order_relaxed);
  if (report.size() < kWoodenLongest) return 0;
  WoodenCommand command;
  if (form < 0) return encodeWooden(WoodenForm::kP14, command, report.first<kWoodenLongest>());
  // Currents computed for a pose before an unplug must not reach a device that is not calibrated.
  if (may_give_force_.load(std::memory_order_relaxed)) command.ma = currents_ma;
  if (preset_requested_.load(std::memory_order_relaxed)) {
    command.preset = home_;
    presets_sent_.fetch_add(1, std::memory_order_relaxed);
  }
  return encodeWooden(static_cast<WoodenForm>(form), command, report.first<kWoodenLongest>());
}

}  // namespace fettle::haptic
