#include "haptic/devices/hid/hid_port.h"

#include <hidapi.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <fstream>
#include <iterator>
#include <mutex>

#include "haptic/devices/codecs/wooden_codec.h"
#include "haptic/devices/emergency_zero.h"

namespace fettle::haptic {

namespace {

constexpr std::uint16_t kWoodenVendor = 0x1234;
constexpr std::uint16_t kWoodenProduct = 0x0006;
constexpr std::uint16_t kWoodenPage = 0xFFAB;
constexpr std::uint16_t kWoodenUsage = 0x0200;

constexpr std::uint16_t kLogitech = 0x046d;  // made 3Dconnexion's devices until 2013
constexpr std::uint16_t k3Dconnexion = 0x256f;
constexpr std::array<std::uint16_t, 12> kOldMice{0xc603, 0xc605, 0xc606, 0xc621, 0xc623, 0xc625,
                                                 0xc626, 0xc627, 0xc628, 0xc629, 0xc62b, 0xc640};
constexpr std::array<std::uint16_t, 10> kNewMice{0xc62e, 0xc62f, 0xc631, 0xc632, 0xc633,
                                                 0xc635, 0xc636, 0xc638, 0xc63a, 0xc652};
constexpr std::uint16_t kDesktopPage = 1;
constexpr std::uint16_t kMultiAxis = 8;

std::mutex& hidapiMutex() {
  static std::mutex mutex;
  return mutex;
}

struct CloseHid {
  void operator()(hid_device* device) const noexcept {
    const std::lock_guard lock(hidapiMutex());  // hid_close sets the global error
    hid_close(device);
  }
};
using HidHandle = std::unique_ptr<hid_device, CloseHid>;

// hidapi returns wide strings; invalid characters (lone surrogates, beyond Unicode) are dropped.
std::string utf8(const wchar_t* wide) {
  std::string out;
  for (; wide != nullptr && *wide != L'\0'; ++wide) {
    const auto c = static_cast<char32_t>(*wide);
    const auto tail = [&](unsigned shift) { out += static_cast<char>(0x80U | ((c >> shift) & 0x3FU)); };
    if (c < 0x80) {
      out += static_cast<char>(c);
    } else if (c < 0x800) {
      out += static_cast<char>(0xC0U | (c >> 6U));
      tail(0);
    } else if (c < 0x10000 && (c < 0xD800 || c > 0xDFFF)) {
      out += static_cast<char>(0xE0U | (c >> 12U));
      tail(6);
      tail(0);
    } else if (c >= 0x10000 && c < 0x110000) {
      out += static_cast<char>(0xF0U | (c >> 18U));
      tail(12);
      tail(6);
      tail(0);
    }
  }
  return out;
}

// The kernel provides the report descriptor of each hidraw node in sysfs; hidapi 0.13 has no call for it.
void addSizes(HidInterface& interface) {
  const std::size_t slash = interface.path.rfind('/');
  const std::string node = slash == std::string::npos ? interface.path : interface.path.substr(slash + 1);
  if (!node.starts_with("hidraw")) return;
  std::ifstream file("/sys/class/hidraw/" + node + "/device/report_descriptor", std::ios::binary);
  if (!file) return;
  const std::vector<char> bytes{std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
  const ReportSizes sizes = reportSizes({reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()});
  interface.input_bytes = sizes.input_bytes;
  interface.output_bytes = sizes.output_bytes;
  interface.numbered_reports = sizes.numbered;
}

class HidPort final : public ReportPort {
 public:
  HidPort(HidHandle handle, std::string path) : handle_(std::move(handle)), path_(std::move(path)) {}
  ~HidPort() override { disarmEmergencyZero(emergency_); }

  ReadOutcome read(std::span<std::uint8_t> buffer, std::chrono::milliseconds timeout) noexcept override {
    const int n =
        hid_read_timeout(handle_.get(), buffer.data(), buffer.size(), static_cast<int>(timeout.count()));
    if (n < 0) return {PortRead::kGone, 0};
    if (n == 0) return {PortRead::kTimeout, 0};
    return {PortRead::kReport, static_cast<std::size_t>(n)};
  }

  PortWrite write(std::span<const std::uint8_t> report) noexcept override {
    std::array<std::uint8_t, kWoodenLongest + 1> bytes;
    if (report.size() + 1 > bytes.size()) return PortWrite::kFailed;
    bytes[0] = 0;  // hidapi expects the report id first; 0 = the device has none, and it is not sent
    if (devicesHeldAtZero())
      std::fill_n(bytes.begin() + 1, report.size(), std::uint8_t{0});
    else
      std::copy(report.begin(), report.end(), bytes.begin() + 1);
    if (emergency_bytes_ != report.size() + 1) {  // the first output, or the form has become known
      emergency_bytes_ = report.size() + 1;
      const std::array<std::uint8_t, kWoodenLongest + 1> zero{};  // no current, in every HID form
      disarmEmergencyZero(emergency_);
      emergency_ = armEmergencyZero(path_.c_str(), {zero.data(), emergency_bytes_});
    }
    errno = 0;
    if (hid_write(handle_.get(), bytes.data(), report.size() + 1) >= 0) return PortWrite::kDone;
    // A stalled device times out and may recover; a missing one does not.
    return errno == ENODEV || errno == EPIPE || errno == ENOTCONN ? PortWrite::kGone : PortWrite::kFailed;
  }

 private:
  HidHandle handle_;
  std::string path_;
  int emergency_ = -1;
  std::size_t emergency_bytes_ = 0;
};

template <std::size_t N>
bool contains(const std::array<std::uint16_t, N>& ids, std::uint16_t id) noexcept {
  return std::find(ids.begin(), ids.end(), id) != ids.end();
}

bool fits(std::uint16_t known, std::uint16_t expected) noexcept {
  return known == 0 || known == expected;
}

}  // namespace

std::vector<HidInterface> hidInterfaces() {
  const std::lock_guard lock(hidapiMutex());
  std::vector<HidInterface> found;
  struct FreeList {
    void operator()(hid_device_info* list) const noexcept { hid_free_enumeration(list); }
  };
  const std::unique_ptr<hid_device_info, FreeList> list(hid_enumerate(0, 0));
  for (const hid_device_info* d = list.get(); d != nullptr; d = d->next) {
    if (d->path == nullptr) continue;
    HidInterface i;
    i.path = d->path;
    i.vendor = d->vendor_id;
    i.product = d->product_id;
    i.usage_page = d->usage_page;
    i.usage = d->usage;
    i.interface_number = d->interface_number;
    i.manufacturer = utf8(d->manufacturer_string);
    i.product_name = utf8(d->product_string);
    i.serial = utf8(d->serial_number);
    addSizes(i);
    found.push_back(std::move(i));
  }
  return found;
}

HidKind hidKind(const HidInterface& i) noexcept {
  if (i.vendor == kWoodenVendor && i.product == kWoodenProduct) {
    const bool size = i.input_bytes == 0 || woodenFormOfSize(i.input_bytes).has_value();
    return size && fits(i.usage_page, kWoodenPage) && fits(i.usage, kWoodenUsage) ? HidKind::kWoodenHaptics
                                                                                  : HidKind::kNone;
  }
  const bool mouse = (i.vendor == kLogitech && contains(kOldMice, i.product)) ||
                     (i.vendor == k3Dconnexion && contains(kNewMice, i.product));
  return mouse && fits(i.usage_page, kDesktopPage) && fits(i.usage, kMultiAxis) ? HidKind::kSpaceMouse
                                                                                : HidKind::kNone;
}

std::optional<OpenedPorts> HidSource::open() noexcept {
  try {
    for (const HidInterface& i : hidInterfaces()) {
      if (hidKind(i) != kind_) continue;
      if (!path_.empty() && i.path != path_ && i.serial != path_) continue;
      OpenedPorts ports;
      const auto handle = [&] {
        const std::lock_guard lock(hidapiMutex());
        return HidHandle(hid_open_path(i.path.c_str()));
      };
      HidHandle reading = handle();
      if (!reading) continue;
      ports.reading = std::make_unique<HidPort>(std::move(reading), i.path);
      if (kind_ == HidKind::kWoodenHaptics) {
        HidHandle writing = handle();
        if (!writing) continue;
        ports.writing = std::make_unique<HidPort>(std::move(writing), i.path);
      }
      ports.input_bytes = i.input_bytes;
      return ports;
    }
  } catch (const std::bad_alloc&) {
    // No memory at present: not opened; the link tries again.
  }
  return std::nullopt;
}

}  // namespace fettle::haptic
