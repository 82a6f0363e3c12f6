// A drop-in for libhidapi-hidraw.so.0: the same calls, with sockets underneath instead of the kernel. What it
// imitates of the real one (0.13): read gives -1 on an unplugged device; write blocks until the device has
// taken the report, for 5 s at most, and then fails with ETIMEDOUT; each handle and the library as a whole
// keep a last error without a lock, so that the thread sanitizer sees a handle shared by two threads.
#include <hidapi.h>

#include <fcntl.h>
#include <poll.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <cwchar>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "tests/haptic/devices/fake_hidapi/wire.h"

struct hid_device_ {
  int in = -1;
  int out = -1;
  std::uint32_t number = 0;
  int last_error = 0;
};

namespace {

int global_error = 0;

constexpr int kWriteTimeoutMs = 5000;

// From UTF-8.
wchar_t* wide(const std::string& text) {
  auto* copy = static_cast<wchar_t*>(std::calloc(text.size() + 1, sizeof(wchar_t)));
  wchar_t* end = copy;
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if (byte < 0x80)
      *end++ = byte;
    else if (byte >= 0xC0)
      *end++ = byte & (byte >= 0xF0 ? 0x07 : byte >= 0xE0 ? 0x0F : 0x1F);
    else if (end != copy)
      end[-1] = end[-1] << 6 | (byte & 0x3F);
  }
  return copy;
}

int connectTo(const std::string& path) {
  const int file = ::socket(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0);
  const sockaddr_un address = fettle::fake::addressOf(path);
  if (file >= 0 && ::connect(file, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0)
    return file;
  if (file >= 0) ::close(file);
  return -1;
}

hid_device_info* describe(const std::filesystem::path& file) {
  std::ifstream in(file);
  std::vector<std::string> lines(6);
  for (std::string& line : lines) std::getline(in, line);
  unsigned vendor = 0;
  unsigned product = 0;
  unsigned page = 0;
  unsigned usage = 0;
  if (std::sscanf(lines[0].c_str(), "%x %x", &vendor, &product) != 2) return nullptr;
  if (std::sscanf(lines[1].c_str(), "%x %x", &page, &usage) != 2) return nullptr;
  auto* info = static_cast<hid_device_info*>(std::calloc(1, sizeof(hid_device_info)));
  info->path = ::strdup(file.parent_path().append(file.stem().string()).c_str());
  info->vendor_id = static_cast<unsigned short>(vendor);
  info->product_id = static_cast<unsigned short>(product);
  info->usage_page = static_cast<unsigned short>(page);
  info->usage = static_cast<unsigned short>(usage);
  info->interface_number = std::atoi(lines[2].c_str());
  info->manufacturer_string = wide(lines[3]);
  info->product_string = wide(lines[4]);
  info->serial_number = wide(lines[5]);
  return info;
}

}  // namespace

extern "C" {

int hid_init() {
  return 0;
}

int hid_exit() {
  return 0;
}

hid_device_info* hid_enumerate(unsigned short vendor, unsigned short product) {
  global_error = 0;
  const char* folder = std::getenv(fettle::fake::kFolderVariable);
  if (folder == nullptr) return nullptr;
  std::vector<std::filesystem::path> files;
  std::error_code error;
  for (auto it = std::filesystem::directory_iterator(folder, error);
       !error && it != std::filesystem::directory_iterator(); it.increment(error))
    if (it->path().extension() == ".hid") files.push_back(it->path());
  std::sort(files.begin(), files.end());
  hid_device_info* first = nullptr;
  hid_device_info** next = &first;
  for (const auto& file : files) {
    hid_device_info* info = describe(file);
    if (info == nullptr) continue;
    if ((vendor != 0 && vendor != info->vendor_id) || (product != 0 && product != info->product_id)) {
      hid_free_enumeration(info);
      continue;
    }
    *next = info;
    next = &info->next;
  }
  return first;
}

void hid_free_enumeration(hid_device_info* list) {
  while (list != nullptr) {
    hid_device_info* next = list->next;
    std::free(list->path);
    std::free(list->serial_number);
    std::free(list->manufacturer_string);
    std::free(list->product_string);
    std::free(list);
    list = next;
  }
}

hid_device* hid_open_path(const char* path) {
  global_error = 0;
  const int in = connectTo(std::string(path) + ".in");
  const int out = connectTo(std::string(path) + ".out");
  if (in < 0 || out < 0) {
    global_error = errno;
    if (in >= 0) ::close(in);
    if (out >= 0) ::close(out);
    return nullptr;
  }
  auto* device = new hid_device_;
  device->in = in;
  device->out = out;
  return device;
}

hid_device* hid_open(unsigned short vendor, unsigned short product, const wchar_t*) {
  hid_device_info* list = hid_enumerate(vendor, product);
  hid_device* device = list == nullptr ? nullptr : hid_open_path(list->path);
  hid_free_enumeration(list);
  return device;
}

int hid_write(hid_device* device, const unsigned char* data, size_t length) {
  device->last_error = 0;
  const auto fail = [&](int code) {
    device->last_error = errno = code;
    return -1;
  };
  std::vector<unsigned char> packet(4 + length);
  const std::uint32_t number = ++device->number;
  std::memcpy(packet.data(), &number, 4);
  std::memcpy(packet.data() + 4, data, length);
  if (::send(device->out, packet.data(), packet.size(), MSG_NOSIGNAL) < 0) return fail(ENODEV);
  for (;;) {
    pollfd p{.fd = device->out, .events = POLLIN, .revents = 0};
    const int ready = ::poll(&p, 1, kWriteTimeoutMs);
    if (ready < 0 && errno == EINTR) continue;
    if (ready <= 0) return fail(ETIMEDOUT);
    std::uint32_t taken = 0;
    const ssize_t n = ::recv(device->out, &taken, sizeof taken, 0);
    if (n < 0 && errno == EINTR) continue;
    if (n != sizeof taken) return fail(ENODEV);
    if (taken == number) return static_cast<int>(length);  // older: of a write that had given up
  }
}

int hid_read_timeout(hid_device* device, unsigned char* data, size_t length, int milliseconds) {
  device->last_error = 0;
  pollfd p{.fd = device->in, .events = POLLIN, .revents = 0};
  const int ready = ::poll(&p, 1, milliseconds);
  if (ready == 0 || (ready < 0 && errno == EINTR)) return 0;
  const ssize_t n = ready < 0 ? -1 : ::recv(device->in, data, length, 0);
  if (n <= 0) {  // 0: the device hung up; it sends no empty reports
    device->last_error = EIO;
    return -1;
  }
  return static_cast<int>(n);
}

int hid_read(hid_device* device, unsigned char* data, size_t length) {
  return hid_read_timeout(device, data, length, -1);
}

void hid_close(hid_device* device) {
  global_error = 0;
  if (device == nullptr) return;
  ::close(device->in);
  ::close(device->out);
  delete device;
}

const wchar_t* hid_error(hid_device* device) {
  return (device == nullptr ? global_error : device->last_error) == 0 ? L"Success" : L"failed";
}

int hid_set_nonblocking(hid_device*, int) {
  return 0;
}

const hid_api_version* hid_version() {
  static const hid_api_version version{0, 13, 1};
  return &version;
}

const char* hid_version_str() {
  return "0.13.1-fake";
}

}  // extern "C"
