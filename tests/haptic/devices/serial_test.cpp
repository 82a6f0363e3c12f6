// Form S over a pseudo terminal: the host side is the real driver, the board is a thread on the other end.
#include <fcntl.h>
#include <poll.h>
#include <pty.h>
#include <termios.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <chrono>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <thread>

#include <gtest/gtest.h>
#include <glm/geometric.hpp>

#include "haptic/devices/emergency_zero.h"
#include "haptic/devices/wooden/serial_port.h"
#include "haptic/devices/wooden/wooden_haptics.h"
#include "tests/support/eventually.h"
#include "tests/support/temp_folder.h"

namespace fettle::haptic {
namespace {

using namespace std::chrono_literals;

// A board with the current firmware: sends a line, waits for one (100 ms at most), sends the next.
class FakeBoard {
 public:
  FakeBoard() {
    std::array<char, 128> name{};
    termios raw{};
    ::cfmakeraw(&raw);
    if (::openpty(&master_, &slave_, name.data(), &raw, nullptr) != 0) return;
    // Close-on-exec, and the slave's own end stays open, so that the master lives while no host is there.
    ::fcntl(master_, F_SETFD, FD_CLOEXEC);
    ::fcntl(slave_, F_SETFD, FD_CLOEXEC);
    path_ = name.data();
    thread_ = std::thread([this] { run(); });
  }
  ~FakeBoard() {
    stop_ = true;
    thread_.join();
    ::close(master_);
    ::close(slave_);
  }
  [[nodiscard]] const std::string& path() const { return path_; }
  void send(const std::string& text) {
    const std::lock_guard lock(mutex_);
    extra_ += text;
  }
  [[nodiscard]] std::array<int, 3> ma() const {
    const std::lock_guard lock(mutex_);
    return ma_;
  }
  std::atomic<int> encoder_c{0};
  std::atomic<int> fault{0};
  std::atomic<std::uint64_t> sent{0};
  std::atomic<std::uint64_t> replies{0};
  std::atomic<std::uint64_t> odd{0};

 private:
  void run() {
    std::string received;
    while (!stop_) {
      std::array<char, 96> line{};
      const int n =
          std::snprintf(line.data(), line.size(), "[3,0,0,%d,0,0,0,%d]\n", encoder_c.load(), fault.load());
      std::string out;
      {
        const std::lock_guard lock(mutex_);
        out.swap(extra_);
      }
      out.append(line.data(), static_cast<std::size_t>(n));
      if (::write(master_, out.data(), out.size()) < 0) continue;
      ++sent;
      waitForReply(received);
      std::this_thread::sleep_for(1ms);
    }
  }

  void waitForReply(std::string& received) {
    pollfd p{.fd = master_, .events = POLLIN, .revents = 0};
    while (received.find('\n') == std::string::npos) {
      if (stop_ || ::poll(&p, 1, 100) <= 0) return;
      std::array<char, 256> bytes;
      const ssize_t n = ::read(master_, bytes.data(), bytes.size());
      if (n <= 0) return;
      received.append(bytes.data(), static_cast<std::size_t>(n));
    }
    const std::string line = received.substr(0, received.find('\n') + 1);
    received.erase(0, line.size());
    std::array<int, 3> ma{};
    char end = 0;
    if (std::sscanf(line.c_str(), "[%d,%d,%d]%c", &ma[0], &ma[1], &ma[2], &end) == 4 && end == '\n') {
      ++replies;
      const std::lock_guard lock(mutex_);
      ma_ = ma;
    } else {
      ++odd;
    }
  }

  int master_ = -1;
  int slave_ = -1;
  std::string path_;
  std::atomic<bool> stop_{false};
  mutable std::mutex mutex_;
  std::string extra_;
  std::array<int, 3> ma_{};
  std::thread thread_;
};

TEST(SerialDriver, CalibratesFollowsGivesForceAndEndsWithZero) {
  FakeBoard board;
  ASSERT_FALSE(board.path().empty());
  WoodenHaptics device(*wooden("woody_v2015"), std::make_unique<SerialSource>(board.path()), WoodenForm::kS);
  ASSERT_TRUE(device.start());
  ASSERT_TRUE(fettle::tests::eventually([&] { return device.read().sequence > 3; }));
  EXPECT_EQ(device.read().link, LinkState::kUncalibrated);
  device.calibrate();
  ASSERT_TRUE(fettle::tests::eventually([&] { return device.read().link == LinkState::kConnected; }));
  EXPECT_LT(glm::length(device.read().position_mm - glm::dvec3{0.0, -25.0, 205.0}), 1e-9);
  ASSERT_TRUE(fettle::tests::eventually([&] {
    static_cast<void>(device.read());
    device.write({0, 0, 1});
    const std::array<int, 3> ma = board.ma();
    return ma[2] != 0;
  }));
  const std::uint64_t before = board.replies;
  board.send("[garbage]\n[1,2\n" + std::string(1000, 'x') + "\n");
  ASSERT_TRUE(fettle::tests::eventually([&] { return device.counters().bad_inputs >= 3; }));
  ASSERT_TRUE(fettle::tests::eventually([&] { return board.replies > before + 10; }));
  board.fault = 2;
  EXPECT_TRUE(fettle::tests::eventually([&] { return device.counters().faults > 0; }));
  device.stop();
  EXPECT_TRUE(fettle::tests::eventually([&] { return board.ma() == std::array<int, 3>{}; }));
  EXPECT_EQ(board.odd, 0U);
}

TEST(SerialDriver, AFatalSignalSendsZeroToTheBoardWhileItsPortIsOpenAndToNoneAfterwards) {
  FakeBoard board;
  SerialSource source(board.path());
  std::optional<OpenedPorts> ports = source.open();
  ASSERT_TRUE(ports);
  ASSERT_EQ(zeroAllDevices(), 1);
  EXPECT_TRUE(fettle::tests::eventually([&] { return board.replies > 0; }));
  ports.reset();
  const std::uint64_t replies = board.replies;
  EXPECT_EQ(zeroAllDevices(), 0) << "what is closed is written to: another device may have its number now";
  EXPECT_EQ(board.replies, replies);
}

TEST(SerialDriver, BoardsAreFoundByTheirName) {
  const tests::TempFolder folder;
  for (const char* name :
       {"usb-Teensyduino_USB_Serial_2-if00", "usb-Teensyduino_USB_Serial_1-if00", "usb-FTDI_x"})
    std::ofstream(folder.file(name)) << "";
  const std::vector<SerialBoard> boards = serialBoards(folder.path().string());
  ASSERT_EQ(boards.size(), 2U);
  EXPECT_EQ(boards[0].name, "usb-Teensyduino_USB_Serial_1-if00");
  EXPECT_TRUE(serialBoards("/nowhere").empty());
}

}  // namespace
}  // namespace fettle::haptic
