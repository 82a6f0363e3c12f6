// Sources of what is relied on here: the Force Dimension SDK's reference, and independent bindings that agree on
// it (docs/decisions/makers-libraries.md).

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cmath>
#include <exception>
#include <memory>
#include <mutex>
#include <optional>
#include <utility>

#include <fmt/format.h>
#include <glm/vec3.hpp>

#include "engine/base/stopwatch.h"
#include "haptic/devices/known_devices.h"
#include "haptic/devices/vendor/linked_device.h"
#include "haptic/devices/vendor/made_devices.h"
#include "haptic/devices/vendor/stylus_orientation.h"
#include "haptic/devices/vendor/vendor_library.h"

namespace fettle::haptic {

namespace {

constexpr LibraryPlaces kDhdPlaces{"libdhd.so", "FETTLE_LIBDHD", "",
                                   "the Force Dimension SDK (forcedimension.com/software/sdk)"};

// The calls of libdhd.so that are used here, by their documented C types. Negative = failed.
struct DhdCalls {
  int (*get_device_count)() = nullptr;
  int (*open_id)(char) = nullptr;
  int (*close)(char) = nullptr;
  const char* (*get_system_name)(char) = nullptr;
  int (*get_position)(double*, double*, double*, char) = nullptr;  // m
  int (*get_button)(int, char) = nullptr;
  int (*enable_force)(unsigned char, char) = nullptr;
  int (*set_force)(double, double, double, char) = nullptr;  // N; 1 = skipped, too soon after the last
  const char* (*error_get_last_str)() = nullptr;
  // Null in a library that lacks them: then a device has no wrist, and states no number.
  bool (*has_wrist)(char) = nullptr;
  int (*get_orientation_frame)(double (*)[3], char) = nullptr;  // by rows
  int (*get_serial_number)(unsigned short*, char) = nullptr;
};

struct ForceDimension {
  VendorLibrary library;
  DhdCalls calls;
};

std::shared_ptr<const ForceDimension> loadForceDimension() {
  auto loaded = std::make_shared<ForceDimension>(ForceDimension{VendorLibrary(kDhdPlaces), {}});
  VendorLibrary& l = loaded->library;
  DhdCalls& c = loaded->calls;
  if (!l.loaded()) return loaded;
  l.find("dhdGetDeviceCount", c.get_device_count);
  l.find("dhdOpenID", c.open_id);
  l.find("dhdClose", c.close);
  l.find("dhdGetSystemName", c.get_system_name);
  l.find("dhdGetPosition", c.get_position);
  l.find("dhdGetButton", c.get_button);
  l.find("dhdEnableForce", c.enable_force);
  l.find("dhdSetForce", c.set_force);
  l.find("dhdErrorGetLastStr", c.error_get_last_str);
  l.findOptional("dhdHasWrist", c.has_wrist);
  l.findOptional("dhdGetOrientationFrame", c.get_orientation_frame);
  l.findOptional("dhdGetSerialNumber", c.get_serial_number);
  return loaded;
}

std::shared_ptr<const ForceDimension> forceDimension() {
  static std::mutex mutex;
  static std::shared_ptr<const ForceDimension> found;
  const std::lock_guard lock(mutex);
  if (!found || !found->library.loaded()) found = loadForceDimension();
  return found;
}

// SDK: x towards the person, y right, z up; 0 in the middle of the workspace. Desk: x right, y away, z up.
glm::dvec3 fromSdk(const glm::dvec3& p) noexcept {
  return {p.y, -p.x, p.z};
}
glm::dvec3 toSdk(const glm::dvec3& f) noexcept {
  return {-f.y, f.x, f.z};
}

// Of a frame by rows; its x runs along the stylus, away from the tip.
std::optional<glm::dquat> stylusFromSdk(const double (&by_rows)[3][3]) noexcept {
  glm::dmat3 desk;
  // The stylus' axes x, y, z are the frame's y, z, x.
  for (int axis = 0; axis < 3; ++axis) {
    const int column = (axis + 1) % 3;
    desk[axis] = fromSdk({by_rows[0][column], by_rows[1][column], by_rows[2][column]});
  }
  return rotationOf(desk);
}

std::string sdkText(const char* words) {
  return words == nullptr ? "" : words;
}

std::string lowerCase(std::string name) {
  std::ranges::transform(name, name.begin(), [](unsigned char c) { return std::tolower(c); });
  return name;
}

// It has no absolute encoders: its pose is not known before it was moved through its whole range.
bool isFalcon(const std::string& name) {
  return lowerCase(name).find("falcon") != std::string::npos;
}

// A device without a row - sigma, lambda - has the limits of an unknown one: the library states none.
DeviceProfile sdkProfile(const std::string& name) {
  const std::string lower = lowerCase(name);
  const char* const known = isFalcon(name)                             ? "falcon"
                            : lower.find("omega") != std::string::npos ? "omega.3"
                            : lower.find("delta") != std::string::npos ? "delta.3"
                                                                       : "";
  DeviceProfile profile = knownProfile(known).value_or(DeviceProfile{});
  profile.name = name.empty() ? "Force Dimension" : name;
  profile.space = DeviceSpace::kDesk;
  profile.gives_force = true;
  return profile;
}

class ForceDimensionCounterpart final : public Counterpart {
 public:
  ForceDimensionCounterpart(std::shared_ptr<const ForceDimension> library, int number, double max_force_n)
      : library_(std::move(library)),
        calls_(library_->calls),
        id_(static_cast<char>(number)),
        max_force_n_(max_force_n) {}

  void serve(ExchangeSlots& slots) noexcept override;

 private:
  enum class Outcome : std::uint8_t { kGood, kFailed };
  [[nodiscard]] Outcome sendForce(ExchangeSlots& slots) const noexcept;
  [[nodiscard]] Outcome readPose(ExchangeSlots& slots) const noexcept;
  [[nodiscard]] std::optional<glm::dquat> readOrientation() const noexcept;
  void exchangeUntilGone(ExchangeSlots& slots) const noexcept;
  void sendLastZero() const noexcept;

  const std::shared_ptr<const ForceDimension> library_;
  const DhdCalls& calls_;
  const char id_;
  const double max_force_n_;
  bool has_wrist_ = false;  // the open device
};

ForceDimensionCounterpart::Outcome ForceDimensionCounterpart::sendForce(ExchangeSlots& slots) const noexcept {
  const glm::dvec3 force = toSdk(slots.forceToSend());
  const int result = calls_.set_force(force.x, force.y, force.z, id_);
  if (result < 0) {
    slots.notSent();
    return Outcome::kFailed;
  }
  constexpr int kSkipped = 1;
  if (result == kSkipped)
    slots.deferred();
  else
    slots.sent();
  return Outcome::kGood;
}

ForceDimensionCounterpart::Outcome ForceDimensionCounterpart::readPose(ExchangeSlots& slots) const noexcept {
  glm::dvec3 position{NAN};
  if (calls_.get_position(&position.x, &position.y, &position.z, id_) < 0) {
    slots.badInput();
    return Outcome::kFailed;
  }
  std::uint32_t buttons = 0;
  for (int k = 0; k < 4; ++k)
    if (calls_.get_button(k, id_) > 0) buttons |= 1U << static_cast<unsigned>(k);
  slots.takeInput(1000.0 * fromSdk(position), buttons, readOrientation());
  return Outcome::kGood;
}

std::optional<glm::dquat> ForceDimensionCounterpart::readOrientation() const noexcept {
  double frame[3][3] = {};
  if (!has_wrist_ || calls_.get_orientation_frame(frame, id_) < 0) return std::nullopt;
  return stylusFromSdk(frame);
}

void ForceDimensionCounterpart::exchangeUntilGone(ExchangeSlots& slots) const noexcept {
  // A disturbed transfer fails once or twice; a device that was unplugged fails from then on.
  constexpr int kFailuresOfAGoneDevice = 20;
  constexpr std::int64_t kLongestPauseNs = 1'000'000;
  int failures = 0;
  while (!slots.stopping() && failures < kFailuresOfAGoneDevice) {
    const std::int64_t start = engine::steadyNs();
    const Outcome sent = sendForce(slots);
    const Outcome read = readPose(slots);
    failures = sent == Outcome::kGood && read == Outcome::kGood ? 0 : failures + 1;
    // The person has moved a Falcon through its range.
    if (slots.state() == LinkState::kUncalibrated && slots.takeCalibrationRequest())
      slots.setState(LinkState::kConnected);
    // With the loop's next force, or after a millisecond without one.
    slots.waitForForce(start + kLongestPauseNs);
  }
}

void ForceDimensionCounterpart::sendLastZero() const noexcept {
  for (int i = 0; i < 20; ++i) {
    const int result = calls_.set_force(0.0, 0.0, 0.0, id_);
    if (result <= 0) break;  // 1: skipped, too soon after the last; each call waits for a part of a tick
  }
}

void ForceDimensionCounterpart::serve(ExchangeSlots& slots) noexcept {
  if (calls_.get_device_count() <= id_ || calls_.open_id(id_) < 0) return;
  const char* const name = calls_.get_system_name(id_);
  bool falcon = false;
  try {
    falcon = isFalcon(sdkText(name));
  } catch (const std::exception&) {  // no memory for a name
    calls_.close(id_);
    return;
  }
  if (calls_.enable_force(1, id_) >= 0) {
    has_wrist_ =
        calls_.has_wrist != nullptr && calls_.get_orientation_frame != nullptr && calls_.has_wrist(id_);
    slots.opened(falcon ? LinkState::kUncalibrated : LinkState::kConnected, max_force_n_);
    exchangeUntilGone(slots);
    sendLastZero();
    calls_.enable_force(0, id_);
  }
  calls_.close(id_);
}

MadeDevice describeById(const DhdCalls& calls, int number) {
  MadeDevice d;
  d.argument = fmt::format("{}", number);
  d.name = fmt::format("Force Dimension device {}", number);
  d.profile = sdkProfile("");
  const char id = static_cast<char>(number);
  if (calls.open_id(id) < 0) {
    d.problem = sdkText(calls.error_get_last_str());
    if (d.problem.empty()) d.problem = "it cannot be opened";
    d.remedy = "close the program that uses it, and allow this user the device's USB port (the SDK's manual)";
    return d;
  }
  const std::string name = sdkText(calls.get_system_name(id));
  unsigned short serial = 0;
  if (calls.get_serial_number != nullptr && calls.get_serial_number(&serial, id) >= 0)
    d.serial = fmt::format("{}", serial);
  calls.close(id);
  if (!name.empty()) d.name = name;
  d.profile = sdkProfile(name);
  d.profile.serial = d.serial;
  if (isFalcon(name)) d.remedy = "move it through its whole range by hand, then press c in a session";
  return d;
}

}  // namespace

MadeDevices listForceDimension() {
  const std::shared_ptr<const ForceDimension> sdk = forceDimension();
  MadeDevices made;
  made.problem = sdk->library.problem();
  made.source = sdk->library.path();
  if (!made.problem.empty()) {
    made.remedy = sdk->library.remedy();
    return made;
  }
  const int count = std::min(sdk->calls.get_device_count(), 16);
  for (int i = 0; i < count; ++i) made.devices.push_back(describeById(sdk->calls, i));
  return made;
}

engine::Result<std::unique_ptr<Device>> openForceDimension(const std::string& which) {
  std::shared_ptr<const ForceDimension> sdk = forceDimension();
  if (!sdk->library.problem().empty())
    return engine::inputError(sdk->library.problem(), "forcedimension", sdk->library.remedy());
  int number = 0;
  const char* const end = which.data() + which.size();
  if (!which.empty()) {
    const auto [after, error] = std::from_chars(which.data(), end, number);
    if (error != std::errc{} || after != end || number < 0 || number > 15)
      return engine::inputError("a Force Dimension device is named by its number, 0 to 15",
                                "forcedimension:" + which, "see fettle devices");
  }
  const bool there = sdk->calls.get_device_count() > number;
  DeviceProfile profile = there ? describeById(sdk->calls, number).profile : sdkProfile("");
  const double max_force_n = profile.max_force_n;
  return std::make_unique<LinkedDevice>(
      std::move(profile), std::make_unique<ForceDimensionCounterpart>(std::move(sdk), number, max_force_n));
}

}  // namespace fettle::haptic
