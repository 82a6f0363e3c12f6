#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

namespace fettle::fake {

struct Description {
  std::uint16_t vendor = 0x1234;
  std::uint16_t product = 0x0006;
  std::uint16_t usage_page = 0xFFAB;
  std::uint16_t usage = 0x0200;
  int interface_number = -1;  ///< as virtual devices have it
  std::string manufacturer;
  std::string product_name;
  std::string serial;
};

/// The device's end of the sockets of wire.h. One thread.
class FakeHid {
 public:
  /// Called with each output report, without its id byte.
  using Output = std::function<void(std::span<const std::uint8_t> report)>;

  FakeHid(std::string folder, std::string name, Description description);
  ~FakeHid();
  FakeHid(const FakeHid&) = delete;
  FakeHid& operator=(const FakeHid&) = delete;

  void plug();
  void unplug();
  [[nodiscard]] bool plugged() const { return listen_in_ >= 0; }

  enum class Out : std::uint8_t { kTaken, kStalled };
  /// Waits up to `ms` for hosts and outputs, and hands on what came; stalled outputs are left waiting.
  void serve(int ms, Out out, const Output& on_output);
  /// To every host; a host that does not read loses reports, as with hidraw.
  void send(std::span<const std::uint8_t> report);
  /// What was written straight to the device file since last time, in whole writes of `size` bytes.
  [[nodiscard]] std::vector<std::vector<std::uint8_t>> directWrites(std::size_t size);
  [[nodiscard]] std::string path() const { return path_; }

 private:
  std::string path_;
  Description description_;
  int listen_in_ = -1;
  int listen_out_ = -1;
  int pipe_ = -1;
  std::vector<int> hosts_in_;
  std::vector<int> hosts_out_;
};

}  // namespace fettle::fake
