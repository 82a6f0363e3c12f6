// Sources of what is relied on here: the OpenHaptics programmer's guide, and independent bindings that agree on
// it (docs/decisions/makers-libraries.md).

#include <cstdlib>

#include <algorithm>
#include <atomic>
#include <cctype>
#include <cmath>
#include <filesystem>
#include <optional>
#include <utility>

#include <fmt/format.h>
#include <glm/vec3.hpp>

#include "engine/base/stopwatch.h"
#include "haptic/devices/known_devices.h"
#include "haptic/devices/vendor/linked_device.h"
#include "haptic/devices/vendor/made_devices.h"
#include "haptic/devices/vendor/open_haptics_calls.h"
#include "haptic/devices/vendor/stylus_orientation.h"

namespace fettle::haptic {

namespace {

// HDAPI: x right, y up, z towards the person. Desk: x right, y away, z up.
glm::dvec3 fromHd(const glm::dvec3& p) noexcept {
  return {p.x, -p.z, p.y};
}
glm::dvec3 toHd(const glm::dvec3& f) noexcept {
  return {f.x, f.z, -f.y};
}
// Of the current transform; its z runs along the stylus, away from the tip.
std::optional<glm::dquat> stylusFromHd(const double (&by_columns)[16]) noexcept {
  const double* const m = by_columns;
  const auto turn = rotationOf(glm::dmat3(m[0], m[1], m[2], m[4], m[5], m[6], m[8], m[9], m[10]));
  if (!turn) return std::nullopt;
  return kLaidDown * *turn;
}

struct HdWorkspace {
  glm::dvec3 centre{0.0};
  double radius_mm = 0.0;  // of the ball in it; 0 = the device states none that makes sense
};

HdWorkspace usableWorkspace(const OpenHapticsCalls& calls) {
  double box[6] = {};
  calls.get_doublev(hd::kUsableWorkspace, box);
  HdWorkspace w;
  double radius = 1e9;
  for (int axis = 0; axis < 3; ++axis) {
    const double low = box[axis];
    const double high = box[axis + 3];
    if (!std::isfinite(low) || !std::isfinite(high) || high - low < 10.0 || high - low > 2000.0) return {};
    w.centre[axis] = 0.5 * (low + high);
    radius = std::min(radius, 0.5 * (high - low));
  }
  w.radius_mm = radius;
  return w;
}

// Reads the whole stack of errors, the newest last; code 0 where there is none.
hd::ErrorInfo newestError(const OpenHapticsCalls& calls) {
  hd::ErrorInfo newest{};
  for (int i = 0; i < 32; ++i) {
    const hd::ErrorInfo error = calls.get_error();
    if (error.code == 0) break;
    newest = error;
  }
  return newest;
}

std::string errorWords(const OpenHapticsCalls& calls, const hd::ErrorInfo& error) {
  const char* const text = calls.get_error_string == nullptr ? nullptr : calls.get_error_string(error.code);
  return fmt::format("{}{}error {:#06x}, internal {}", text == nullptr ? "" : text,
                     text == nullptr ? "" : ": ", error.code, error.internal_code);
}

std::string stringOf(const OpenHapticsCalls& calls, unsigned int parameter) {
  const char* const text = calls.get_string(parameter);
  return text == nullptr ? "" : text;
}

// The limits of the table for the model, and never more than the device states itself.
DeviceProfile modelProfile(const std::string& model, double max_force_n, const HdWorkspace& workspace) {
  std::string lower = model;
  std::ranges::transform(lower, lower.begin(), [](unsigned char c) { return std::tolower(c); });
  const char* const known = lower.find("omni") != std::string::npos      ? "omni"
                            : lower.find("desktop") != std::string::npos ? "phantom_desktop"
                            : lower.find("touch") != std::string::npos   ? "touch"
                                                                         : "";
  DeviceProfile profile = knownProfile(known).value_or(DeviceProfile{});
  profile.name = model.empty() ? "3D Systems Touch" : model;
  profile.space = DeviceSpace::kDesk;
  profile.gives_force = true;
  if (std::isfinite(max_force_n) && max_force_n >= 0.0)
    profile.max_force_n = std::min(profile.max_force_n, max_force_n);
  if (workspace.radius_mm > 0.0)
    profile.workspace_radius_mm = std::min(profile.workspace_radius_mm, workspace.radius_mm);
  return profile;
}

double statedMaxForce(const OpenHapticsCalls& calls) {
  double newtons = 0.0;
  calls.get_doublev(hd::kMaxForce, &newtons);
  return newtons;
}

hd::Handle initDevice(const OpenHapticsCalls& calls, const std::string& name) {
  static_cast<void>(newestError(calls));  // of earlier calls
  return calls.init_device(name.empty() ? nullptr : name.c_str());
}

class OpenHapticsCounterpart final : public Counterpart {
 public:
  OpenHapticsCounterpart(std::shared_ptr<const OpenHaptics> library, std::string name)
      : library_(std::move(library)), calls_(library_->calls), name_(std::move(name)) {}

  void serve(ExchangeSlots& slots) noexcept override;

 private:
  static unsigned int servo(void* self) { return static_cast<OpenHapticsCounterpart*>(self)->tick(); }
  unsigned int tick() noexcept;
  void updateCalibration() noexcept;
  enum class Frame : std::uint8_t { kGood, kBroken, kGone };
  [[nodiscard]] Frame takeErrors() noexcept;

  const std::shared_ptr<const OpenHaptics> library_;
  const OpenHapticsCalls& calls_;
  const std::string name_;

  // Set before the servo runs, then its own.
  ExchangeSlots* slots_ = nullptr;
  hd::Handle device_ = hd::kNoDevice;
  glm::dvec3 centre_{0.0};
  int calibration_style_ = 0;

  // Servo to link thread; relaxed: independent, looked at every some milliseconds.
  std::atomic<bool> gone_{false};
  std::atomic<bool> zero_at_stop_{false};
};

// The library's own thread, at 1 kHz: no allocation, no lock of ours, no wait.
unsigned int OpenHapticsCounterpart::tick() noexcept {
  if (gone_.load(std::memory_order_relaxed)) return hd::kDone;
  updateCalibration();
  glm::dvec3 position{NAN};
  double transform[16] = {};  // a device without a measured wrist leaves it so
  int buttons = 0;
  calls_.begin_frame(device_);
  calls_.get_doublev(hd::kPosition, &position.x);
  calls_.get_doublev(hd::kTransform, transform);
  calls_.get_integerv(hd::kButtons, &buttons);
  const bool stopping = slots_->stopping();
  const glm::dvec3 force = toHd(slots_->forceToSend());
  calls_.set_doublev(hd::kForce, &force.x);
  calls_.end_frame(device_);
  const Frame frame = takeErrors();
  if (frame == Frame::kGone) {
    slots_->notSent();
    gone_.store(true, std::memory_order_relaxed);
    return hd::kDone;
  }
  if (frame == Frame::kBroken) {
    slots_->notSent();
    slots_->badInput();
    return hd::kContinue;
  }
  slots_->sent();
  slots_->takeInput(fromHd(position - centre_), static_cast<std::uint32_t>(buttons), stylusFromHd(transform));
  if (stopping) zero_at_stop_.store(true, std::memory_order_relaxed);
  return hd::kContinue;
}

// Calls of the calibration take effect only on the servo's thread. A device that calibrates itself, or in its
// inkwell, does so when the library asks for it; one whose encoders are reset does so when the user says that the
// stylus is in its place.
void OpenHapticsCounterpart::updateCalibration() noexcept {
  constexpr int kEncoderReset = 1;
  constexpr int kAuto = 2;
  constexpr int kInkwell = 4;
  if (calls_.check_calibration == nullptr) return;
  const unsigned int status = calls_.check_calibration();
  const bool asked = slots_->state() == LinkState::kUncalibrated && slots_->takeCalibrationRequest();
  if (calls_.update_calibration != nullptr) {
    if (status == hd::kNeedsUpdate && (calibration_style_ & (kAuto | kInkwell)) != 0)
      calls_.update_calibration((calibration_style_ & kAuto) != 0 ? kAuto : kInkwell);
    else if (asked)
      calls_.update_calibration((calibration_style_ & kInkwell) != 0 ? kInkwell : kEncoderReset);
  }
  slots_->setState(status == hd::kCalibrated ? LinkState::kConnected : LinkState::kUncalibrated);
}

// A force error (warm motors, too fast) is the device's own protection: counted, and it goes on. An error of the
// frame occurs in the first ones after the start; their pose is a default, not the stylus'.
OpenHapticsCounterpart::Frame OpenHapticsCounterpart::takeErrors() noexcept {
  Frame frame = Frame::kGood;
  for (int i = 0; i < 8; ++i) {
    const hd::ErrorInfo error = calls_.get_error();
    if (error.code == 0) break;
    const unsigned int kind = error.code & 0xFF00U;
    if (kind == hd::kDeviceErrors) return Frame::kGone;
    if (kind == hd::kForceErrors) slots_->fault();
    if (kind == hd::kFrameErrors) frame = Frame::kBroken;
  }
  return frame;
}

void OpenHapticsCounterpart::serve(ExchangeSlots& slots) noexcept {
  device_ = initDevice(calls_, name_);
  if (device_ == hd::kNoDevice) return;
  if (newestError(calls_).code != 0) {
    calls_.disable_device(device_);
    return;
  }
  slots_ = &slots;
  centre_ = usableWorkspace(calls_).centre;
  calibration_style_ = 0;
  if (calls_.check_calibration != nullptr) calls_.get_integerv(hd::kCalibrationStyle, &calibration_style_);
  calls_.enable(hd::kForceOutput);
  calls_.enable(hd::kForceClamping);
  const bool calibrates = calls_.check_calibration != nullptr;
  slots.opened(calibrates ? LinkState::kUncalibrated : LinkState::kConnected, statedMaxForce(calls_));
  static_cast<void>(newestError(calls_));  // of properties that this model does not have
  gone_.store(false, std::memory_order_relaxed);
  zero_at_stop_.store(false, std::memory_order_relaxed);
  const unsigned long scheduled = calls_.schedule_asynchronous(&servo, this, hd::kHighestPriority);
  calls_.start_scheduler();
  const unsigned int failed = newestError(calls_).code & 0xFF00U;
  if (failed != hd::kDeviceErrors && failed != hd::kSchedulerErrors) {
    // The servo runs; this thread only watches it.
    while (!gone_.load(std::memory_order_relaxed) && slots.waitWhileRunning(10'000'000)) {
    }
    // One more frame, with zero force: slots.stopping() makes it so. Not from a servo that stands still.
    const std::int64_t until = engine::steadyNs() + 50'000'000;
    while (slots.stopping() && !gone_.load(std::memory_order_relaxed) &&
           !zero_at_stop_.load(std::memory_order_relaxed) && engine::steadyNs() < until)
      slots.waitForForce(engine::steadyNs() + 1'000'000);
  }
  calls_.stop_scheduler();
  calls_.unschedule(scheduled);
  calls_.disable(hd::kForceOutput);
  calls_.disable_device(device_);
  device_ = hd::kNoDevice;
}

// Opens the device for its properties alone: the scheduler does not run, so no force is given.
MadeDevice describeByName(const OpenHapticsCalls& calls, const std::string& name) {
  MadeDevice d;
  d.argument = name;
  d.name = name.empty() ? "default device of OpenHaptics" : name;
  d.profile = modelProfile("", 3.0, {});
  const hd::Handle device = initDevice(calls, name);
  const hd::ErrorInfo error = newestError(calls);
  if (device == hd::kNoDevice || error.code != 0) {
    d.problem = errorWords(calls, error);
    d.remedy =
        "set the device up with the maker's own program (Touch_Setup, Touch_Diagnostic) until that one "
        "moves; a "
        "device that another program uses cannot be opened";
    if (device != hd::kNoDevice) calls.disable_device(device);
    return d;
  }
  const std::string model = stringOf(calls, hd::kModel);
  const std::string maker = stringOf(calls, hd::kVendor);
  d.name = maker.empty() ? model : fmt::format("{} {}", maker, model);
  d.serial = stringOf(calls, hd::kSerial);
  d.profile = modelProfile(model, statedMaxForce(calls), usableWorkspace(calls));
  d.profile.serial = d.serial;
  calls.disable_device(device);
  static_cast<void>(newestError(calls));
  return d;
}

// The names that the maker's set-up program has stored, one file each; the library has no call that lists them.
std::vector<std::string> configuredNames() {
  const char* const home = std::getenv("GTDD_HOME");
  const std::filesystem::path folder =
      std::filesystem::path(home != nullptr && *home != '\0' ? home : "/usr/share/3DSystems") / "config";
  std::vector<std::string> names;
  std::error_code error;
  for (auto it = std::filesystem::directory_iterator(folder, error);
       !error && it != std::filesystem::directory_iterator(); it.increment(error))
    if (it->path().extension() == ".config") names.push_back(it->path().stem().string());
  std::ranges::sort(names);
  return names;
}

}  // namespace

MadeDevices listOpenHaptics() {
  const std::shared_ptr<const OpenHaptics> library = openHaptics();
  MadeDevices made;
  made.problem = library->library.problem();
  made.source = library->library.path();
  if (!made.problem.empty()) {
    made.remedy = library->library.remedy();
    return made;
  }
  std::vector<std::string> names = configuredNames();
  if (names.empty()) names.emplace_back();
  for (const std::string& name : names) made.devices.push_back(describeByName(library->calls, name));
  return made;
}

engine::Result<std::unique_ptr<Device>> openOpenHaptics(const std::string& which) {
  std::shared_ptr<const OpenHaptics> library = openHaptics();
  if (!library->library.problem().empty())
    return engine::inputError(library->library.problem(), "touch", library->library.remedy());
  DeviceProfile profile = describeByName(library->calls, which).profile;
  return std::make_unique<LinkedDevice>(std::move(profile),
                                        std::make_unique<OpenHapticsCounterpart>(std::move(library), which));
}

}  // namespace fettle::haptic
