#include "haptic/devices/vendor/open_haptics.h"

#include <algorithm>
#include <array>
#include <system_error>
#include <utility>

#include <fmt/format.h>

#include "engine/base/stopwatch.h"
#include "haptic/devices/emergency_zero.h"
#include "haptic/devices/known_devices.h"

namespace fettle::haptic {

namespace {

constexpr std::int64_t kServoSecond = 1'000'000'000;
constexpr std::int64_t kTouchPlugWait =
    kServoSecond;  // opening a device that is not there takes the library a while
constexpr std::int64_t kZeroWait = kServoSecond / 10;  // for the servo thread to send the last zero
constexpr std::int64_t kRest = kServoSecond;           // of motors that are too warm

// The library's axes to DeviceSpace::kDesk and back: a quarter turn about x.
glm::dvec3 touchToDesk(const glm::dvec3& v) noexcept {
  return {v.x, -v.z, v.y};
}
glm::dvec3 deskToTouch(const glm::dvec3& v) noexcept {
  return {v.x, v.z, -v.y};
}

void takeErrors(const Hdapi& hd) noexcept {
  for (int i = 0; i < 16 && hd.hdGetError().code != 0; ++i) {
  }
}

// Opened, the current device; or the library's error.
engine::Result<unsigned> opened(const Hdapi& hd, const std::string& name) {
  takeErrors(hd);
  const unsigned device = hd.hdInitDevice(name.empty() ? nullptr : name.c_str());
  const Hdapi::Error error = hd.hdGetError();
  if (device != Hdapi::kInvalidDevice && error.code == 0) {
    hd.hdMakeCurrentDevice(device);
    return device;
  }
  if (device != Hdapi::kInvalidDevice) hd.hdDisableDevice(device);
  return engine::failure(fmt::format("OpenHaptics opens no device (its error 0x{:04X}, internal {})",
                                     error.code, error.internal),
                         name, "plug it in and switch it on; the maker's setup program lists its name");
}

struct Reach {
  glm::dvec3 centre_mm{0.0};
  double radius_mm = 0.0;
};

// Of the current device; nothing where it states none.
Reach reachOf(const Hdapi& hd) noexcept {
  std::array<double, 6> box{};
  hd.hdGetDoublev(Hdapi::kUsableWorkspace, box.data());
  const glm::dvec3 low{box[0], box[1], box[2]}, high{box[3], box[4], box[5]};
  const glm::dvec3 size = high - low;
  const double smallest = std::min({size.x, size.y, size.z});
  if (!(smallest > 1.0) || !(smallest < 2000.0)) return {};
  return {0.5 * (low + high), 0.5 * smallest};
}

// The table's limits by the model's name, and never more force than the device itself states.
DeviceProfile touchProfile(const Hdapi& hd) {
  const char* const model = hd.hdGetString(Hdapi::kModel);
  const std::string name = model == nullptr ? "" : model;
  DeviceProfile profile;
  if (name.find("Omni") != std::string::npos || name.find("Touch") != std::string::npos)
    profile = *knownProfile("touch");
  if (name.find("Desktop") != std::string::npos || name.find("Touch X") != std::string::npos)
    profile = *knownProfile("phantom_desktop");
  if (!name.empty()) profile.name = name;
  profile.space = DeviceSpace::kDesk;
  profile.gives_force = true;
  double most = 0.0;
  hd.hdGetDoublev(Hdapi::kNominalMaxForce, &most);
  if (most > 0.0) profile.max_force_n = std::min(profile.max_force_n, most);
  if (const Reach reach = reachOf(hd); reach.radius_mm > 0.0) profile.workspace_radius_mm = reach.radius_mm;
  return profile;
}

}  // namespace

engine::Result<DeviceProfile> OpenHaptics::probe(const std::string& name) {
  const auto hd = hdapi();
  if (!hd) return tl::unexpected(hd.error());
  const auto device = opened(**hd, name);
  if (!device) return tl::unexpected(device.error());
  DeviceProfile profile = touchProfile(**hd);
  (*hd)->hdDisableDevice(*device);
  return profile;
}

engine::Result<std::unique_ptr<Device>> OpenHaptics::open(const std::string& name) {
  const auto hd = hdapi();
  if (!hd) return tl::unexpected(hd.error());
  DeviceProfile unknown;
  unknown.name = "OpenHaptics device";
  unknown.gives_force = true;
  return std::make_unique<OpenHaptics>(**hd, name, probe(name).value_or(unknown));
}

OpenHaptics::OpenHaptics(const Hdapi& hd, std::string name, const DeviceProfile& profile)
    : hd_(hd), name_(std::move(name)), profile_(profile) {}

OpenHaptics::~OpenHaptics() {
  stop();
}

engine::Status OpenHaptics::start() {
  if (supervisor_.joinable()) return {};
  stopping_.store(false, std::memory_order_relaxed);
  try {
    supervisor_ = std::thread([this] { supervise(); });
  } catch (const std::system_error&) {
    return engine::failure("no thread can be started for the device", "", "free memory or raise ulimit -u");
  }
  return {};
}

void OpenHaptics::stop() noexcept {
  stopping_.store(true, std::memory_order_relaxed);
  wake_.post();
  if (supervisor_.joinable()) supervisor_.join();
}

void OpenHaptics::supervise() noexcept {
  const OwnZeros own_zeros;
  const auto stopping = [this] { return stopping_.load(std::memory_order_relaxed); };
  while (!stopping()) {
    if (!connect()) {
      wake_.waitFor(kTouchPlugWait);
      continue;
    }
    while (!stopping() && !lost_.load(std::memory_order_relaxed)) wake_.waitFor(kServoSecond);
    disconnect();
  }
}

bool OpenHaptics::connect() noexcept {
  const auto device = opened(hd_, name_);
  if (!device) return false;
  device_ = *device;
  centre_mm_ = reachOf(hd_).centre_mm;
  lost_.store(false, std::memory_order_relaxed);
  ending_.store(false, std::memory_order_relaxed);
  zero_sent_.store(false, std::memory_order_relaxed);
  rests_until_ns_ = 0;
  hd_.hdEnable(Hdapi::kForceOutput);
  takeErrors(hd_);
  exchange_.setLink(LinkState::kConnected);
  scheduled_ = hd_.hdScheduleAsynchronous(
      [](void* self) -> unsigned { return static_cast<OpenHaptics*>(self)->tick() ? 1 : 0; }, this,
      Hdapi::kHighestPriority);
  hd_.hdStartScheduler();
  return true;
}

void OpenHaptics::disconnect() noexcept {
  // An explicit zero first: where the servo thread stands it is not waited for long.
  const std::int64_t until = engine::steadyNs() + kZeroWait;
  ending_.store(true, std::memory_order_relaxed);
  while (!zero_sent_.load(std::memory_order_relaxed) && !lost_.load(std::memory_order_relaxed)) {
    const std::int64_t left = until - engine::steadyNs();
    if (left <= 0) break;
    wake_.waitFor(left);
  }
  hd_.hdStopScheduler();
  hd_.hdUnschedule(scheduled_);
  hd_.hdMakeCurrentDevice(device_);
  hd_.hdDisable(Hdapi::kForceOutput);
  hd_.hdDisableDevice(device_);
  device_ = Hdapi::kInvalidDevice;
  exchange_.setLink(LinkState::kDisconnected);
}

bool OpenHaptics::tick() noexcept {
  hd_.hdBeginFrame(device_);
  std::array<double, 3> position{};
  int buttons = 0;
  hd_.hdGetDoublev(Hdapi::kPosition, position.data());
  hd_.hdGetIntegerv(Hdapi::kButtons, &buttons);
  const std::int64_t now = engine::steadyNs();
  // Garbage is left out, as a report that did not come: the guard sees for how long.
  exchange_.received(touchToDesk(glm::dvec3{position[0], position[1], position[2]} - centre_mm_),
                     static_cast<std::uint32_t>(buttons) & (kPrimaryButton | kSecondaryButton), now);
  const bool ending = ending_.load(std::memory_order_relaxed);
  const glm::dvec3 wanted = exchange_.force(now);
  const bool gives = !ending && now >= rests_until_ns_;
  const glm::dvec3 force = gives ? deskToTouch(wanted) : glm::dvec3{0.0};
  const std::array<double, 3> sent{force.x, force.y, force.z};
  hd_.hdSetDoublev(Hdapi::kForce, sent.data());
  hd_.hdEndFrame(device_);
  const Hdapi::Error error = hd_.hdGetError();
  // A force that was held back did not reach the device: the guard lets it rise anew, or takes it for a device that does not respond.
  exchange_.sent(error.code == 0 && gives);
  if (ending) {
    zero_sent_.store(true, std::memory_order_relaxed);
    wake_.post();
  }
  if (error.code == 0) return true;
  exchange_.fault();
  // A force that the library refused, or motors that are too warm: zero for a second, then again.
  if ((error.code & Hdapi::kKind) == Hdapi::kForceErrors) {
    rests_until_ns_ = now + kRest;
    return true;
  }
  lost_.store(true, std::memory_order_relaxed);
  wake_.post();
  return false;
}

}  // namespace fettle::haptic
