#include "haptic/devices/enumerate.h"

#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "haptic/devices/hid/hid_port.h"
#include "haptic/devices/hid/space_mouse.h"
#include "haptic/devices/vendor/made_devices.h"
#include "haptic/devices/virtual/mouse_stylus.h"
#include "haptic/devices/virtual/replay_device.h"
#include "haptic/devices/wooden/serial_port.h"
#include "haptic/devices/wooden/wooden_haptics.h"

namespace fettle::haptic {

namespace {

// The user's file where there is one: an invalid file is an error, so that motors are never driven with other
// parameters.
engine::Result<WoodenConfig> userConfig() {
  const std::string path = defaultWoodenConfigPath();
  std::error_code error;
  if (!path.empty() && std::filesystem::exists(path, error)) return readWoodenConfig(path);
  return wooden("woody_v2015");
}

DeviceProfile profileOf(DeviceKind kind) {
  if (kind == DeviceKind::kSpaceMouse)
    return SpaceMouse(std::make_unique<HidSource>(HidKind::kSpaceMouse)).profile();
  if (kind == DeviceKind::kOther) return {};
  const engine::Result<WoodenConfig> config = userConfig();
  return config ? woodenProfile(*config) : DeviceProfile{};
}

// Null for kOther.
const KnownDriver* driverOf(DeviceKind kind);

DeviceInfo describe(const HidInterface& i) {
  DeviceInfo d;
  switch (hidKind(i)) {
    case HidKind::kWoodenHaptics:
      d.kind = DeviceKind::kWoodenHaptics;
      break;
    case HidKind::kSpaceMouse:
      d.kind = DeviceKind::kSpaceMouse;
      break;
    case HidKind::kNone:
      break;
  }
  d.path = i.path;
  if (i.manufacturer.empty() && i.product_name.empty())
    d.name = fmt::format("{:04x}:{:04x}", i.vendor, i.product);
  else if (i.manufacturer.empty() || i.product_name.empty())
    d.name = i.manufacturer.empty() ? i.product_name : i.manufacturer;
  else
    d.name = fmt::format("{} {}", i.manufacturer, i.product_name);
  d.serial = i.serial;
  d.vendor = i.vendor;
  d.product = i.product;
  d.usage_page = i.usage_page;
  d.usage = i.usage;
  d.input_bytes = i.input_bytes;
  d.output_bytes = i.output_bytes;
  const KnownDriver* const driver = driverOf(d.kind);
  d.gives_position = driver != nullptr;
  d.gives_force = driver != nullptr && driver->gives_force;
  if (d.gives_force) {
    if (const auto form = woodenFormOfSize(i.input_bytes)) d.form = *form == WoodenForm::kW8 ? "W8" : "P14";
  }
  d.profile = profileOf(d.kind);
  return d;
}

engine::Result<std::unique_ptr<Device>> openWooden(std::unique_ptr<ReportSource> source,
                                                   std::optional<WoodenForm> form, std::string serial) {
  const engine::Result<WoodenConfig> config = userConfig();
  if (!config) return tl::unexpected(config.error());
  return std::make_unique<WoodenHaptics>(*config, std::move(source), form, OutputTimes{}, std::move(serial));
}

// Of the interface that HidSource opens; empty when none is there, or it states none.
std::string serialOf(HidKind kind, const std::string& which) {
  for (const HidInterface& i : hidInterfaces())
    if (hidKind(i) == kind && (which.empty() || i.path == which || i.serial == which)) return i.serial;
  return {};
}

using Opened = engine::Result<std::unique_ptr<Device>>;

// Of hardware: a path or a serial number, else the first that is found.
Opened openWoodenHid(const std::string& which, double) {
  return openWooden(std::make_unique<HidSource>(HidKind::kWoodenHaptics, which), std::nullopt,
                    serialOf(HidKind::kWoodenHaptics, which));
}

Opened openWoodenSerial(const std::string& path, double) {
  return openWooden(std::make_unique<SerialSource>(path), WoodenForm::kS, {});
}

Opened openSpaceMouse(const std::string& which, double) {
  return std::make_unique<SpaceMouse>(std::make_unique<HidSource>(HidKind::kSpaceMouse, which));
}

// Follows the positions of a strokes file, with its tools; without one it rests at (0, 0, 0).
Opened openHand(const std::string& file, double loop_rate_hz) {
  if (file.empty()) return std::make_unique<SimulatedHand>(std::vector<HandTarget>{HandTarget{}}, HandSpec{});
  const auto strokes = readStrokes(file);
  if (!strokes) return tl::unexpected(strokes.error());
  std::vector<HandTarget> path = handPath(*strokes);
  if (path.empty())
    return engine::inputError("the strokes contain no valid position", file, "give a recorded session");
  HandSpec spec;
  spec.rate_hz = loop_rate_hz;
  return std::make_unique<SimulatedHand>(std::move(path), spec);
}

Opened openReplay(const std::string& file, double) {
  if (file.empty()) return engine::inputError("no strokes are named", "replay", "give replay:STROKES");
  auto strokes = readStrokes(file);
  if (!strokes) return tl::unexpected(strokes.error());
  return std::make_unique<ReplayDevice>(std::move(*strokes));
}

// A name of the maker's set-up, a number, an id; else the first that is found.
Opened openTouch(const std::string& which, double) {
  return openOpenHaptics(which);
}

Opened openOmega(const std::string& which, double) {
  return openForceDimension(which);
}

Opened openHaply(const std::string& which, double) {
  return openInverse3(which);
}

Opened openMouse(const std::string&, double) {
  return std::make_unique<MouseStylus>();
}

constexpr KnownDriver kDrivers[] = {
    {"woodenhaptics", "", "WoodenHaptics, AluHaptics, Polhem (mbed boards, HID)", DeviceKind::kWoodenHaptics,
     true, false, openWoodenHid},
    {"serial", "", "the same family, current boards (USB serial)", DeviceKind::kWoodenSerial, true, false,
     openWoodenSerial},
    {"spacemouse", "", "3Dconnexion SpaceMouse", DeviceKind::kSpaceMouse, false, false, openSpaceMouse},
    {"touch", "", "3D Systems Touch, Phantom (OpenHaptics)", DeviceKind::kOpenHaptics, true, false,
     openTouch},
    {"forcedimension", "", "Force Dimension omega, delta, sigma; Novint Falcon", DeviceKind::kForceDimension,
     true, false, openOmega},
    {"inverse3", "", "Haply Inverse3", DeviceKind::kInverse3, true, false, openHaply},
    {"mouse", "", "mouse as a stylus", DeviceKind::kOther, false, true, openMouse},
    {"hand", "STROKES", "simulated hand in closed loop, on the way of a strokes file", DeviceKind::kOther,
     true, false, openHand, true},
    {"replay", "STROKES", "strokes file in real time", DeviceKind::kOther, false, false, openReplay},
};

const KnownDriver* driverOf(DeviceKind kind) {
  const auto* const row = std::ranges::find(kDrivers, kind, &KnownDriver::kind);
  return kind == DeviceKind::kOther ? nullptr : row;
}

}  // namespace

std::span<const KnownDriver> knownDrivers() noexcept {
  return kDrivers;
}

NamedDriver driverNamed(std::string_view words) {
  const std::size_t colon = words.find(':');
  const bool has_argument = colon != std::string_view::npos;
  const auto* const row = std::ranges::find(kDrivers, words.substr(0, colon), &KnownDriver::word);
  if (row == std::end(kDrivers) || (has_argument && colon + 1 == words.size())) return {};
  return {row, std::string(has_argument ? words.substr(colon + 1) : "")};
}

std::string driverWords() {
  std::string words;
  for (const KnownDriver& driver : kDrivers)
    words += fmt::format("{}{}{}{}", words.empty() ? "" : ", ", driver.word,
                         driver.argument.empty() ? "" : ":", driver.argument);
  return words;
}

std::vector<std::string> driversAlone() {
  std::vector<std::string> words;
  for (const KnownDriver& driver : kDrivers)
    if (driver.argument.empty()) words.emplace_back(driver.word);
  return words;
}

std::string_view deviceKindName(DeviceKind kind) noexcept {
  switch (kind) {
    case DeviceKind::kOther:
      return "other";
    case DeviceKind::kWoodenHaptics:
      return "woodenhaptics";
    case DeviceKind::kWoodenSerial:
      return "woodenhaptics-serial";
    case DeviceKind::kSpaceMouse:
      return "spacemouse";
    case DeviceKind::kOpenHaptics:
      return "touch";
    case DeviceKind::kForceDimension:
      return "forcedimension";
    case DeviceKind::kInverse3:
      return "inverse3";
  }
  return "other";
}

std::vector<DeviceInfo> listDevices() {
  std::vector<DeviceInfo> devices;
  for (const HidInterface& i : hidInterfaces()) devices.push_back(describe(i));
  for (const SerialBoard& board : serialBoards()) {
    DeviceInfo d;
    d.kind = DeviceKind::kWoodenSerial;
    d.path = board.path;
    d.name = board.name;
    d.gives_position = true;
    d.gives_force = true;
    d.form = "S";
    d.profile = profileOf(d.kind);
    devices.push_back(std::move(d));
  }
  for (DeviceInfo& d : devices) {
    d.readable = ::access(d.path.c_str(), R_OK | W_OK) == 0;
    d.open_error = d.readable ? 0 : errno;
  }
  std::stable_partition(devices.begin(), devices.end(),
                        [](const DeviceInfo& d) { return d.kind != DeviceKind::kOther; });
  return devices;
}

std::vector<MakerInfo> listMakers() {
  constexpr std::pair<DeviceKind, MadeDevices (*)()> kMakers[] = {
      {DeviceKind::kOpenHaptics, listOpenHaptics},
      {DeviceKind::kForceDimension, listForceDimension},
      {DeviceKind::kInverse3, listInverse3},
  };
  std::vector<MakerInfo> makers;
  for (const auto& [kind, list] : kMakers) {
    const KnownDriver& driver = *driverOf(kind);
    MadeDevices made = list();
    MakerInfo maker{kind,
                    driver.word,
                    driver.title,
                    std::move(made.problem),
                    std::move(made.remedy),
                    std::move(made.source),
                    {}};
    for (MadeDevice& m : made.devices) {
      DeviceInfo d;
      d.kind = kind;
      d.path = m.argument.empty() ? std::string(driver.word) : fmt::format("{}:{}", driver.word, m.argument);
      d.name = std::move(m.name);
      d.serial = std::move(m.serial);
      d.readable = m.problem.empty();
      d.gives_position = true;
      d.gives_force = true;
      d.profile = std::move(m.profile);
      d.answer = std::move(m.problem);
      d.advice = std::move(m.remedy);
      maker.devices.push_back(std::move(d));
    }
    makers.push_back(std::move(maker));
  }
  return makers;
}

std::vector<HandTarget> handPath(std::span<const StrokeSample> strokes) {
  std::vector<HandTarget> path;
  double first = 0.0;
  for (const StrokeSample& s : strokes) {
    if (!std::isfinite(s.t + s.tip_mm.x + s.tip_mm.y + s.tip_mm.z)) continue;
    if (path.empty()) first = s.t;
    if (!path.empty() && s.t - first <= path.back().t) continue;
    path.push_back({s.t - first, s.tip_mm, s.tool});
  }
  return path;
}

DeviceProblem deviceProblem(int open_error) {
  switch (open_error) {
    case 0:
      return {};
    case EACCES:
    case EPERM:
      return {
          "no permission",
          "install the udev rules: sudo cp assets/udev/70-fettle.rules /etc/udev/rules.d/ && sudo udevadm "
          "control --reload && sudo udevadm trigger, then plug the device in again"};
    case EBUSY:
      return {"busy", "close the program that uses it"};
    case ENOENT:
    case ENODEV:
    case ENXIO:
      return {"unplugged", "plug it in again"};
    default:
      return {std::strerror(open_error), "plug it in again; see the kernel's log (dmesg)"};
  }
}

engine::Result<std::unique_ptr<Device>> openDevice(const std::string& word, double loop_rate_hz) {
  if (const NamedDriver named = driverNamed(word); named.driver != nullptr)
    return named.driver->open(named.argument, loop_rate_hz);
  for (const DeviceInfo& d : listDevices()) {
    if (d.path != word) continue;
    if (const KnownDriver* const driver = driverOf(d.kind)) return driver->open(word, loop_rate_hz);
    return engine::inputError("there is no driver for this device", word, "see fettle devices");
  }
  return engine::inputError("there is no such device", word,
                            fmt::format("use {} or a path that fettle devices shows", driverWords()));
}

}  // namespace fettle::haptic
