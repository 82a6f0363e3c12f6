#pragma once

#include <cstdint>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include <xcb/xcb.h>

namespace fettle::tests {

/// A valuator of a device, as an X server lists it.
struct FakeAxis {
  std::string label;
  double low = 0.0, high = 1.0;
  std::uint32_t resolution = 1;
};
struct FakeDevice {
  std::uint16_t id = 0;
  std::string name;
  std::vector<FakeAxis> axes;
};
/// An event of a device: the values that it lists, by their numbers.
struct FakeEvent {
  std::uint16_t type = 6;  ///< 4 press, 5 release, 6 motion
  std::uint16_t device = 0;
  std::uint32_t detail = 0;  ///< the button
  std::vector<std::pair<int, double>> values;
};
/// The event as it goes over the wire (X.Org, XI2proto: xXIDeviceEvent).
[[nodiscard]] std::vector<std::uint8_t> wireOf(const FakeEvent& event);

/// An X server with input devices only: it answers, over a pair of sockets, what a reader of tablets asks, and sends events when it
/// is told to. Clients are real ones: libxcb, over the X protocol. Thread: any.
class FakeXServer {
 public:
  enum class Input { kVersion2, kVersion1, kNone };
  explicit FakeXServer(std::vector<FakeDevice> devices, Input input = Input::kVersion2);
  ~FakeXServer();
  FakeXServer& operator=(FakeXServer&&) = delete;

  /// A connection to it; once.
  [[nodiscard]] xcb_connection_t* connect();
  void send(const FakeEvent& event);
  void send(const std::vector<std::uint8_t>& wire);
  /// Plugs in another device, and says so to who selected that.
  void plugIn(const FakeDevice& device);
  /// The devices whose events were selected for a window, in order; every time.
  [[nodiscard]] std::vector<std::uint16_t> selected(std::uint32_t window) const;
  /// Ends as a server that is killed.
  void die();

 private:
  void run();
  void answer(const std::vector<std::uint8_t>& request);
  void write(std::vector<std::uint8_t> bytes);

  const Input input_;
  int here_ = -1, there_ = -1;
  mutable std::mutex mutex_;
  std::vector<FakeDevice> devices_;
  std::vector<std::string> atoms_;
  std::vector<std::pair<std::uint32_t, std::uint16_t>> selected_;
  std::uint16_t sequence_ = 0;
  std::thread thread_;
};

}  // namespace fettle::tests
