// Sources of what is relied on here: programs that use Haply's service and agree on its messages
// (docs/decisions/makers-libraries.md).

#include <algorithm>
#include <cstdlib>
#include <exception>
#include <utility>

#include <fmt/format.h>
#include <glm/vec3.hpp>

#include "engine/base/stopwatch.h"
#include "haptic/devices/vendor/inverse3_codec.h"
#include "haptic/devices/vendor/linked_device.h"
#include "haptic/devices/vendor/made_devices.h"
#include "haptic/devices/vendor/web_socket.h"

namespace fettle::haptic {

namespace {

constexpr std::int64_t kConnectNs = 500'000'000;
constexpr std::int64_t kFirstMessageNs = 500'000'000;
constexpr std::int64_t kStopLookNs = 5'000'000;     // between two looks at whether the link stops
constexpr std::int64_t kSilenceNs = 1'000'000'000;  // then the connection is given up and opened again
constexpr std::int64_t kExchangeNs = 1'000'000;     // longest pause between two exchanges
constexpr std::int64_t kFullStateNs = 200'000'000;  // between two questions for a calibration
constexpr std::int64_t kLastZeroNs = 50'000'000;    // for the answer to a zero that ends a connection

// The service's frame: x right, y away from the person, z up, 0 in the base, which stands behind the tip. This is
// the middle of what the arm reaches.
const glm::dvec3 kCentreM{0.0, -0.14, 0.20};

std::string serviceAddress() {
  const char* const named = std::getenv("FETTLE_INVERSE3");
  return named != nullptr && *named != '\0' ? named : "localhost:10001";
}

// The service states no largest force: the limits of an unknown device.
DeviceProfile inverse3Profile() {
  DeviceProfile profile;
  profile.name = "Haply Inverse3";
  profile.space = DeviceSpace::kDesk;
  profile.workspace_radius_mm = 80.0;
  profile.gives_force = true;
  return profile;
}

// Empty when there is no such device.
const Inverse3State* deviceNamed(const Inverse3Message& message, const std::string& which) {
  const auto it = std::ranges::find_if(
      message.devices, [&](const Inverse3State& d) { return which.empty() || d.device_id == which; });
  return it == message.devices.end() ? nullptr : &*it;
}

class Inverse3Counterpart final : public Counterpart {
 public:
  explicit Inverse3Counterpart(std::string which) : which_(std::move(which)), address_(serviceAddress()) {}

  void serve(ExchangeSlots& slots) noexcept override;

 private:
  enum class Step : std::uint8_t {
    kGood,
    kDeviceGone,   // the service does not name the device any more
    kServiceGone,  // the connection ended, or nothing came for too long
  };
  [[nodiscard]] Step exchange(ExchangeSlots& slots);
  [[nodiscard]] Step awaitState(ExchangeSlots& slots);
  [[nodiscard]] Step dropUnasked(ExchangeSlots& slots);
  [[nodiscard]] Inverse3Asks asksFor(const ExchangeSlots& slots);
  static void take(ExchangeSlots& slots, const Inverse3Message& message, const Inverse3State& state);
  void sendLastZero();

  const std::string which_;
  const std::string address_;
  WebSocket socket_;
  std::string text_;
  // Of a connection.
  std::string id_;
  Inverse3Form form_ = Inverse3Form::kValues;
  std::int64_t full_state_asked_ns_ = 0;
};

void Inverse3Counterpart::take(ExchangeSlots& slots, const Inverse3Message& message,
                               const Inverse3State& state) {
  if (state.calibrated) slots.setState(*state.calibrated ? LinkState::kConnected : LinkState::kUncalibrated);
  if (state.position_m)
    slots.takeInput(1000.0 * (*state.position_m - kCentreM), message.buttons, message.orientation);
  else
    slots.badInput();
}

// The one state that answers the message just sent.
Inverse3Counterpart::Step Inverse3Counterpart::awaitState(ExchangeSlots& slots) {
  const std::int64_t until = engine::steadyNs() + kSilenceNs;
  const std::int64_t until_stopped = engine::steadyNs() + 100'000'000;
  for (;;) {
    const WebSocket::Outcome outcome = socket_.receive(text_, kStopLookNs);
    if (outcome == WebSocket::Outcome::kGone) return Step::kServiceGone;
    if (outcome == WebSocket::Outcome::kDone) break;
    const std::int64_t now = engine::steadyNs();
    if (now > until || (slots.stopping() && now > until_stopped)) return Step::kServiceGone;
  }
  const std::optional<Inverse3Message> message = decodeInverse3(text_);
  if (!message) {  // it was an answer all the same: the next message brings the next
    slots.badInput();
    slots.notSent();
    return Step::kGood;
  }
  const Inverse3State* const state = deviceNamed(*message, id_);
  if (state == nullptr) return Step::kDeviceGone;
  slots.sent();
  take(slots, *message, *state);
  return Step::kGood;
}

// A service that says more than one state for a message would be read later and later: a pose that grows old makes the
// loop unstable. At most so many at once, so that a flood does not hold the zero at the end up.
Inverse3Counterpart::Step Inverse3Counterpart::dropUnasked(ExchangeSlots& slots) {
  constexpr int kMostAtOnce = 16;
  for (int i = 0; i < kMostAtOnce; ++i) {
    const WebSocket::Outcome outcome = socket_.receiveIfThere(text_);
    if (outcome == WebSocket::Outcome::kGone) return Step::kServiceGone;
    if (outcome == WebSocket::Outcome::kTimeout) break;
    slots.badInput();
  }
  return Step::kGood;
}

// 3.1 states a calibration only when it is asked for all.
Inverse3Asks Inverse3Counterpart::asksFor(const ExchangeSlots& slots) {
  const std::int64_t now = engine::steadyNs();
  if (slots.state() != LinkState::kUncalibrated || now - full_state_asked_ns_ < kFullStateNs)
    return Inverse3Asks::kState;
  full_state_asked_ns_ = now;
  return Inverse3Asks::kFullState;
}

Inverse3Counterpart::Step Inverse3Counterpart::exchange(ExchangeSlots& slots) {
  if (const Step step = dropUnasked(slots); step != Step::kGood) return step;
  const std::string message = encodeInverse3(form_, id_, slots.forceToSend(), asksFor(slots));
  if (socket_.send(message, kSilenceNs) != WebSocket::Outcome::kDone) return Step::kServiceGone;
  return awaitState(slots);
}

// To a device that the service stopped naming: if it names it in the next message again, it must not hold its last force.
void Inverse3Counterpart::sendLastZero() {
  if (socket_.send(encodeInverse3(form_, id_, glm::dvec3(0.0)), kLastZeroNs) == WebSocket::Outcome::kDone)
    static_cast<void>(socket_.receive(text_, kLastZeroNs));
}

void Inverse3Counterpart::serve(ExchangeSlots& slots) noexcept try {
  if (socket_.connect(address_, kConnectNs) != WebSocket::Outcome::kDone) return;
  if (socket_.receive(text_, kFirstMessageNs) != WebSocket::Outcome::kDone) return socket_.close();
  const std::optional<Inverse3Message> first = decodeInverse3(text_);
  const Inverse3State* const device = first ? deviceNamed(*first, which_) : nullptr;
  if (device == nullptr) return socket_.close();
  id_ = device->device_id;
  form_ = first->form;
  const bool calibrated = device->calibrated.value_or(true);
  slots.opened(calibrated ? LinkState::kConnected : LinkState::kUncalibrated, inverse3Profile().max_force_n);
  // While stopping, forces are zero: the exchange after the loop is the last zero.
  Step step = Step::kGood;
  while (step == Step::kGood && !slots.stopping()) {
    const std::int64_t start = engine::steadyNs();
    step = exchange(slots);
    slots.waitForForce(start + kExchangeNs);
  }
  if (step == Step::kGood) step = exchange(slots);
  if (step == Step::kDeviceGone) sendLastZero();
  socket_.close();
} catch (const std::exception&) {  // no memory: as if the service were gone
  socket_.close();
}

}  // namespace

MadeDevices listInverse3() {
  MadeDevices made;
  made.source = "ws://" + serviceAddress();
  WebSocket socket;
  std::string text;
  const WebSocket::Outcome connected = socket.connect(serviceAddress(), kConnectNs);
  if (connected != WebSocket::Outcome::kDone) {
    made.problem = "Haply's service does not answer";
    made.remedy = fmt::format(
        "install and start the Haply Inverse Service (haply.co), or name its host:port with FETTLE_INVERSE3; "
        "looked for {}",
        made.source);
    return made;
  }
  std::optional<Inverse3Message> message;
  if (socket.receive(text, kFirstMessageNs) == WebSocket::Outcome::kDone) message = decodeInverse3(text);
  if (!message) {
    made.problem = "what answers is not Haply's service, or an older one";
    made.remedy =
        fmt::format("install the Haply Inverse Service 3.1 or newer (haply.co); asked {}", made.source);
    return made;
  }
  for (const Inverse3State& state : message->devices) {
    MadeDevice d;
    d.argument = state.device_id;
    d.name = "Haply Inverse3";
    d.serial = state.device_id;
    d.profile = inverse3Profile();
    d.profile.serial = d.serial;
    if (!state.calibrated.value_or(true)) d.remedy = "calibrate it with the maker's program";
    made.devices.push_back(std::move(d));
  }
  return made;
}

engine::Result<std::unique_ptr<Device>> openInverse3(const std::string& which) {
  DeviceProfile profile = inverse3Profile();
  profile.serial = which;
  return std::make_unique<LinkedDevice>(std::move(profile), std::make_unique<Inverse3Counterpart>(which));
}

}  // namespace fettle::haptic
