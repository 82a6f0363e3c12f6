#include "haptic/devices/vendor/force_dimension.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <system_error>
#include <utility>

#include <fmt/format.h>

#include "engine/base/lower_case.h"
#include "engine/base/stopwatch.h"
#include "haptic/devices/emergency_zero.h"
#include "haptic/devices/known_devices.h"
#include "haptic/devices/link_thread.h"

namespace fettle::haptic {

namespace {

constexpr std::int64_t kDhdTick = 1'000'000;          // longest wait for a force
constexpr std::int64_t kDhdPlugWait = 1'000'000'000;  // between attempts to open it
constexpr int kFailuresThatLose = 10;  // one after the other: unplugged, not a call that failed

// The library's axes to DeviceSpace::kDesk and back, [m] to [mm]: a quarter turn about z.
glm::dvec3 dhdToDesk(const std::array<double, 3>& m) noexcept {
  return 1000.0 * glm::dvec3{m[1], -m[0], m[2]};
}
glm::dvec3 deskToDhd(const glm::dvec3& n) noexcept {
  return {-n.y, n.x, n.z};
}

std::string lastError(const Dhd& dhd) {
  const char* const text = dhd.dhdErrorGetLastStr();
  return text == nullptr ? "no reason given" : text;
}

// By the name's beginning; sigma and lambda move like a delta, but their reach is not known: limits of an unknown device.
DeviceProfile dhdProfile(const Dhd& dhd, char id) {
  const char* const text = dhd.dhdGetSystemName(id);
  const std::string name = text == nullptr ? "" : text;
  const std::string lower = engine::lowerCase(name);
  DeviceProfile profile;
  for (const auto& [begins, known] :
       {std::pair{"omega", "omega.3"}, {"delta", "delta.3"}, {"falcon", "falcon"}, {"novint", "falcon"}})
    if (lower.starts_with(begins)) profile = *knownProfile(known);
  profile.name = name.empty() ? "Force Dimension device" : name;
  profile.space = DeviceSpace::kDesk;
  profile.gives_force = true;
  return profile;
}

engine::Result<DeviceProfile> probedDhd(const Dhd& dhd, char index) {
  const int id = dhd.dhdOpenID(index);
  if (id < 0)
    return engine::failure(fmt::format("Force Dimension's library opens no device: {}", lastError(dhd)),
                           fmt::format("{}", int{index}),
                           "close the program that uses it, or give the user rights to its USB device");
  DeviceProfile profile = dhdProfile(dhd, static_cast<char>(id));
  dhd.dhdClose(static_cast<char>(id));
  return profile;
}

}  // namespace

engine::Result<std::vector<DeviceProfile>> ForceDimension::probe() {
  const auto calls = dhd();
  if (!calls) return tl::unexpected(calls.error());
  std::vector<DeviceProfile> found;
  const int count = (*calls)->dhdGetDeviceCount();
  for (int i = 0; i < std::min(count, 16); ++i) {
    auto profile = probedDhd(**calls, static_cast<char>(i));
    if (!profile) return tl::unexpected(profile.error());
    found.push_back(*std::move(profile));
  }
  return found;
}

engine::Result<std::unique_ptr<Device>> ForceDimension::open(const std::string& index) {
  const auto calls = dhd();
  if (!calls) return tl::unexpected(calls.error());
  int number = 0;
  if (!index.empty()) {
    const auto [end, problem] = std::from_chars(index.data(), index.data() + index.size(), number);
    if (problem != std::errc() || end != index.data() + index.size() || number < 0 || number > 15)
      return engine::inputError("the library numbers devices 0 to 15", index,
                                "give one that fettle devices shows, as forcedimension:0");
  }
  DeviceProfile unknown;
  unknown.name = "Force Dimension device";
  unknown.gives_force = true;
  return std::make_unique<ForceDimension>(**calls, static_cast<char>(number),
                                          probedDhd(**calls, static_cast<char>(number)).value_or(unknown));
}

ForceDimension::ForceDimension(const Dhd& dhd, char index, const DeviceProfile& profile)
    : dhd_(dhd), index_(index), profile_(profile) {}

ForceDimension::~ForceDimension() {
  stop();
}

engine::Status ForceDimension::start() {
  if (thread_.joinable()) return {};
  stopping_.store(false, std::memory_order_relaxed);
  try {
    thread_ = std::thread([this] { run(); });
  } catch (const std::system_error&) {
    return engine::failure("no thread can be started for the device", "", "free memory or raise ulimit -u");
  }
  return {};
}

void ForceDimension::stop() noexcept {
  stopping_.store(true, std::memory_order_relaxed);
  stopped_.post();
  if (thread_.joinable()) thread_.join();
}

void ForceDimension::run() noexcept {
  becomeLinkThread("fettle-dhd");
  const OwnZeros own_zeros;
  while (!stopping_.load(std::memory_order_relaxed)) {
    const int opened = dhd_.dhdOpenID(index_);
    if (opened < 0) {
      stopped_.waitFor(kDhdPlugWait);
      continue;
    }
    const char id = static_cast<char>(opened);
    dhd_.dhdEnableForce(1, id);
    serve(id);
    exchange_.setLink(LinkState::kDisconnected);
    dhd_.dhdSetForce(0.0, 0.0, 0.0, id);
    dhd_.dhdEnableForce(0, id);
    dhd_.dhdClose(id);
  }
}

bool ForceDimension::readPose(char id) noexcept {
  std::array<double, 3> position{};
  if (dhd_.dhdGetPosition(&position[0], &position[1], &position[2], id) < 0) return false;
  std::uint32_t buttons = 0;
  for (int i = 0; i < 2; ++i)
    if (dhd_.dhdGetButton(i, id) == 1) buttons |= 1U << static_cast<unsigned>(i);
  // Garbage is left out, as a report that did not come: the guard sees for how long.
  if (exchange_.received(dhdToDesk(position), buttons, engine::steadyNs()))
    exchange_.setLink(LinkState::kConnected);
  return true;
}

void ForceDimension::serve(char id) noexcept {
  int failures = 0;
  while (!stopping_.load(std::memory_order_relaxed)) {
    const bool read = readPose(id);
    const glm::dvec3 force = deskToDhd(exchange_.force(engine::steadyNs()));
    const bool accepted = dhd_.dhdSetForce(force.x, force.y, force.z, id) >= 0;
    exchange_.sent(accepted);
    failures = read && accepted ? 0 : failures + 1;
    if (failures > 0) exchange_.fault();
    if (failures >= kFailuresThatLose) return;
    exchange_.waitForForce(kDhdTick);
  }
}

}  // namespace fettle::haptic
