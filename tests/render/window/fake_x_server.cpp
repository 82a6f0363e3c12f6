#include "tests/render/window/fake_x_server.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <stdexcept>
#include <utility>

#include <sys/socket.h>
#include <unistd.h>

#include <xcb/xinput.h>

namespace fettle::tests {
namespace {

constexpr std::uint8_t kExtension = 131;
constexpr std::uint32_t kRoot = 0x2c0;

class Wire {
 public:
  template <class T>
  Wire& add(T value) {
    const auto* const from = reinterpret_cast<const std::uint8_t*>(&value);
    bytes_.insert(bytes_.end(), from, from + sizeof value);
    return *this;
  }
  Wire& fixed(double value) {
    const double whole = std::floor(value);
    return add(static_cast<std::int32_t>(whole))
        .add(static_cast<std::uint32_t>(std::ldexp(value - whole, 32)));
  }
  Wire& text(const std::string& text) {
    bytes_.insert(bytes_.end(), text.begin(), text.end());
    return pad();
  }
  Wire& pad(std::size_t to = 4) {
    while (bytes_.size() % to != 0) bytes_.push_back(0);
    return *this;
  }
  Wire& zeros(std::size_t count) {
    bytes_.insert(bytes_.end(), count, 0);
    return *this;
  }
  [[nodiscard]] std::vector<std::uint8_t> take() { return std::move(bytes_); }
  [[nodiscard]] std::size_t size() const { return bytes_.size(); }

 private:
  std::vector<std::uint8_t> bytes_;
};

template <class T>
T at(const std::vector<std::uint8_t>& bytes, std::size_t offset) {
  T value{};
  if (offset + sizeof value <= bytes.size()) std::memcpy(&value, bytes.data() + offset, sizeof value);
  return value;
}

bool readAll(int socket, std::uint8_t* to, std::size_t count) {
  while (count > 0) {
    const ssize_t got = ::read(socket, to, count);
    if (got <= 0) return false;
    to += got;
    count -= static_cast<std::size_t>(got);
  }
  return true;
}

// What a server says of itself first: one screen, no formats.
std::vector<std::uint8_t> setup() {
  const std::string vendor = "fake";
  xcb_screen_t screen{};
  screen.root = kRoot;
  xcb_setup_t all{};
  all.status = 1;
  all.protocol_major_version = 11;
  all.resource_id_base = 0x200000;
  all.resource_id_mask = 0x1fffff;
  all.vendor_len = static_cast<std::uint16_t>(vendor.size());
  all.maximum_request_length = 0xffff;
  all.roots_len = 1;
  all.length = static_cast<std::uint16_t>((sizeof all - 8 + vendor.size() + sizeof screen) / 4);
  return Wire().add(all).text(vendor).add(screen).take();
}

}  // namespace

std::vector<std::uint8_t> wireOf(const FakeEvent& event) {
  std::uint32_t which = 0;
  for (const auto& [number, value] : event.values) which |= 1U << static_cast<unsigned>(number);
  xcb_input_button_press_event_t head{};
  head.response_type = XCB_GE_GENERIC;
  head.extension = kExtension;
  head.length = static_cast<std::uint32_t>(12 + 1 + 1 + 2 * event.values.size());
  head.event_type = event.type;
  head.deviceid = event.device;
  head.sourceid = event.device;
  head.detail = event.detail;
  head.root = kRoot;
  head.buttons_len = 1;
  head.valuators_len = 1;
  Wire wire;
  const auto* const bytes = reinterpret_cast<const std::uint8_t*>(&head);
  // libxcb's structure has four bytes of its own behind the first 32.
  for (std::size_t i = 0; i < sizeof head; ++i)
    if (i < 32 || i >= 36) wire.add(bytes[i]);
  wire.add(std::uint32_t{0}).add(which);
  for (const auto& [number, value] : event.values) wire.fixed(value);
  return wire.take();
}

FakeXServer::FakeXServer(std::vector<FakeDevice> devices, Input input)
    : input_(input), devices_(std::move(devices)) {
  int ends[2];
  if (::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends) != 0) throw std::runtime_error("no socket");
  here_ = ends[0];
  there_ = ends[1];
  for (const FakeDevice& device : devices_)
    for (const FakeAxis& axis : device.axes) atoms_.push_back(axis.label);
  thread_ = std::thread([this] { run(); });
}

FakeXServer::~FakeXServer() {
  die();
  thread_.join();
  ::close(here_);
  if (there_ >= 0) ::close(there_);
}

xcb_connection_t* FakeXServer::connect() {
  return xcb_connect_to_fd(std::exchange(there_, -1), nullptr);
}

void FakeXServer::die() {
  ::shutdown(here_, SHUT_RDWR);
}

void FakeXServer::run() {
  // The client's first message: byte order, version, a proof of identity that is empty here.
  std::uint8_t hello[12];
  if (!readAll(here_, hello, sizeof hello)) return;
  const std::vector<std::uint8_t> first = setup();
  if (::send(here_, first.data(), first.size(), MSG_NOSIGNAL) < 0) return;
  for (;;) {
    std::vector<std::uint8_t> request(4);
    if (!readAll(here_, request.data(), 4)) return;
    const std::size_t size = std::size_t{4} * at<std::uint16_t>(request, 2);
    request.resize(std::max(size, std::size_t{4}));
    if (!readAll(here_, request.data() + 4, request.size() - 4)) return;
    const std::lock_guard lock(mutex_);
    ++sequence_;
    answer(request);
  }
}

// All that is not of this kind gets no answer: the client waits, and the test's limit of time ends it.
void FakeXServer::answer(const std::vector<std::uint8_t>& request) {
  const auto reply = [&](Wire body) {
    // The first 32 bytes are in any reply; `body` begins behind the length.
    if (body.size() < 24) body.zeros(24 - body.size());
    body.pad();
    const auto extra = static_cast<std::uint32_t>((body.size() - 24) / 4);
    Wire whole;
    whole.add(std::uint8_t{1}).add(std::uint8_t{0}).add(sequence_).add(extra);
    for (const std::uint8_t byte : body.take()) whole.add(byte);
    write(whole.take());
  };
  const std::uint8_t opcode = request[0], minor = request[1];
  if (opcode == XCB_QUERY_EXTENSION) {
    const bool there = input_ != Input::kNone;
    reply(Wire().add(std::uint8_t{there}).add(there ? kExtension : std::uint8_t{0}));
  } else if (opcode == XCB_INTERN_ATOM) {
    const std::string name(request.begin() + 8, request.begin() + 8 + at<std::uint16_t>(request, 4));
    const auto found = std::ranges::find(atoms_, name);
    reply(Wire().add(found == atoms_.end() ? std::uint32_t{0}
                                           : static_cast<std::uint32_t>(300 + (found - atoms_.begin()))));
  } else if (opcode == XCB_GET_INPUT_FOCUS) {
    reply(Wire().add(kRoot));
  } else if (opcode == kExtension && minor == XCB_INPUT_XI_QUERY_VERSION) {
    reply(Wire()
              .add(std::uint16_t{static_cast<std::uint16_t>(input_ == Input::kVersion2 ? 2 : 1)})
              .add(std::uint16_t{0}));
  } else if (opcode == kExtension && minor == XCB_INPUT_XI_QUERY_DEVICE) {
    Wire body;
    body.add(static_cast<std::uint16_t>(devices_.size())).zeros(22);
    for (const FakeDevice& device : devices_) {
      body.add(device.id).add(std::uint16_t{XCB_INPUT_DEVICE_TYPE_SLAVE_POINTER}).add(std::uint16_t{2});
      body.add(static_cast<std::uint16_t>(device.axes.size()))
          .add(static_cast<std::uint16_t>(device.name.size()));
      body.add(std::uint8_t{1}).add(std::uint8_t{0}).text(device.name);
      for (std::size_t i = 0; i < device.axes.size(); ++i) {
        const FakeAxis& axis = device.axes[i];
        const auto atom = std::ranges::find(atoms_, axis.label) - atoms_.begin();
        body.add(std::uint16_t{XCB_INPUT_DEVICE_CLASS_TYPE_VALUATOR}).add(std::uint16_t{11}).add(device.id);
        body.add(static_cast<std::uint16_t>(i)).add(static_cast<std::uint32_t>(300 + atom));
        body.fixed(axis.low).fixed(axis.high).fixed(0.0).add(axis.resolution).add(std::uint8_t{1}).zeros(3);
      }
    }
    reply(std::move(body));
  } else if (opcode == kExtension && minor == XCB_INPUT_XI_SELECT_EVENTS) {
    const auto window = at<std::uint32_t>(request, 4);
    std::size_t offset = 12;
    for (int left = at<std::uint16_t>(request, 8); left > 0; --left) {
      selected_.emplace_back(window, at<std::uint16_t>(request, offset));
      offset += 4 + std::size_t{4} * at<std::uint16_t>(request, offset + 2);
    }
  }
}

void FakeXServer::write(std::vector<std::uint8_t> bytes) {
  static_cast<void>(::send(here_, bytes.data(), bytes.size(), MSG_NOSIGNAL));
}

void FakeXServer::send(const FakeEvent& event) {
  send(wireOf(event));
}

void FakeXServer::send(const std::vector<std::uint8_t>& wire) {
  const std::lock_guard lock(mutex_);
  std::vector<std::uint8_t> bytes = wire;
  std::memcpy(bytes.data() + 2, &sequence_, sizeof sequence_);
  write(std::move(bytes));
}

void FakeXServer::plugIn(const FakeDevice& device) {
  {
    const std::lock_guard lock(mutex_);
    devices_.push_back(device);
    for (const FakeAxis& axis : device.axes) atoms_.push_back(axis.label);
  }
  xcb_input_hierarchy_event_t event{};
  event.response_type = XCB_GE_GENERIC;
  event.extension = kExtension;
  event.event_type = XCB_INPUT_HIERARCHY;
  const auto* const bytes = reinterpret_cast<const std::uint8_t*>(&event);
  send(std::vector<std::uint8_t>(bytes, bytes + 32));
}

std::vector<std::uint16_t> FakeXServer::selected(std::uint32_t window) const {
  const std::lock_guard lock(mutex_);
  std::vector<std::uint16_t> devices;
  for (const auto& [of, device] : selected_)
    if (of == window) devices.push_back(device);
  return devices;
}

}  // namespace fettle::tests
