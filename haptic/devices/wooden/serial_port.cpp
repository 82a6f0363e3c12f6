#include "haptic/devices/wooden/serial_port.h"

#include <fcntl.h>
#include <poll.h>
#include <termios.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <filesystem>
#include <string_view>

#include "haptic/devices/emergency_zero.h"

namespace fettle::haptic {

namespace {

// A board that accepts no line for the time of its own watchdog is stalled.
constexpr int kWriteWaitMs = 100;
constexpr std::string_view kZeroLine = "[0,0,0]\n";

class SerialPort final : public ReportPort {
 public:
  explicit SerialPort(int file) noexcept : file_(file) {}
  ~SerialPort() override {
    disarmEmergencyZero(emergency_);
    ::close(file_);
  }

  void armEmergency(const std::string& path) noexcept {
    emergency_ = armEmergencyZero(
        path.c_str(), {reinterpret_cast<const std::uint8_t*>(kZeroLine.data()), kZeroLine.size()});
  }

  ReadOutcome read(std::span<std::uint8_t> out, std::chrono::milliseconds timeout) noexcept override {
    const auto until = std::chrono::steady_clock::now() + timeout;
    for (;;) {
      if (const std::size_t size = takeLine(out)) return {PortRead::kReport, size};
      const auto left =
          std::chrono::duration_cast<std::chrono::milliseconds>(until - std::chrono::steady_clock::now());
      pollfd p{.fd = file_, .events = POLLIN, .revents = 0};
      const int ready = ::poll(&p, 1, static_cast<int>(std::max<std::int64_t>(left.count(), 0)));
      if (ready < 0 && errno == EINTR) continue;
      if (ready < 0) return {PortRead::kGone, 0};
      if (ready == 0) return {PortRead::kTimeout, 0};
      const ssize_t n = ::read(file_, buffer_.data() + filled_, buffer_.size() - filled_);
      if (n < 0 && (errno == EAGAIN || errno == EINTR)) {
        if ((p.revents & (POLLHUP | POLLERR)) != 0) return {PortRead::kGone, 0};
        continue;
      }
      if (n <= 0) return {PortRead::kGone, 0};  // end of file: the device was disconnected
      filled_ += static_cast<std::size_t>(n);
    }
  }

  PortWrite write(std::span<const std::uint8_t> line) noexcept override {
    if (devicesHeldAtZero())
      line = {reinterpret_cast<const std::uint8_t*>(kZeroLine.data()), kZeroLine.size()};
    while (!line.empty()) {
      const ssize_t n = ::write(file_, line.data(), line.size());
      if (n > 0) {
        line = line.subspan(static_cast<std::size_t>(n));
        continue;
      }
      if (n < 0 && errno == EINTR) continue;
      if (n < 0 && errno != EAGAIN) return PortWrite::kGone;
      pollfd p{.fd = file_, .events = POLLOUT, .revents = 0};
      if (::poll(&p, 1, kWriteWaitMs) == 0) return PortWrite::kFailed;
      if ((p.revents & (POLLHUP | POLLERR | POLLNVAL)) != 0) return PortWrite::kGone;
    }
    return PortWrite::kDone;
  }

 private:
  // Moves the first whole line, line end included, to `out`; a full buffer without line end counts as one.
  std::size_t takeLine(std::span<std::uint8_t> out) noexcept {
    const auto begin = buffer_.begin();
    const auto end = begin + static_cast<std::ptrdiff_t>(filled_);
    const auto newline = std::find(begin, end, std::uint8_t{'\n'});
    if (newline == end && filled_ < buffer_.size()) return 0;
    const auto after = newline == end ? end : newline + 1;
    const auto size = static_cast<std::size_t>(after - begin);
    std::copy_n(begin, std::min(size, out.size()), out.begin());
    std::copy(after, end, begin);
    filled_ -= size;
    return std::min(size, out.size());
  }

  int file_;
  int emergency_ = -1;
  std::array<std::uint8_t, 255> buffer_{};
  std::size_t filled_ = 0;
};

bool makeRaw(int file) noexcept {
  termios t{};
  if (::tcgetattr(file, &t) != 0) return false;
  ::cfmakeraw(&t);
  t.c_cflag |= static_cast<tcflag_t>(CLOCAL | CREAD);
  t.c_cc[VMIN] = 0;
  t.c_cc[VTIME] = 0;
  ::cfsetspeed(&t, B115200);
  if (::tcsetattr(file, TCSANOW, &t) != 0) return false;
  ::tcflush(file, TCIOFLUSH);  // half a line from before
  return true;
}

}  // namespace

std::vector<SerialBoard> serialBoards(const std::string& folder) {
  std::vector<SerialBoard> boards;
  std::error_code error;
  for (auto it = std::filesystem::directory_iterator(folder, error);
       !error && it != std::filesystem::directory_iterator(); it.increment(error)) {
    const std::string name = it->path().filename().string();
    if (name.find("Teensy") != std::string::npos) boards.push_back({it->path().string(), name});
  }
  std::sort(boards.begin(), boards.end(),
            [](const SerialBoard& a, const SerialBoard& b) { return a.name < b.name; });
  return boards;
}

std::optional<OpenedPorts> SerialSource::open() noexcept try {
  std::string path = path_;
  if (path.empty()) {
    const std::vector<SerialBoard> boards = serialBoards();
    if (boards.empty()) return std::nullopt;
    path = boards.front().path;
  }
  const int file = ::open(path.c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC);
  if (file < 0) return std::nullopt;
  const int twin = makeRaw(file) ? ::fcntl(file, F_DUPFD_CLOEXEC, 0) : -1;
  if (twin < 0) {
    ::close(file);
    return std::nullopt;
  }
  OpenedPorts ports;
  ports.reading = std::make_unique<SerialPort>(file);
  auto writing = std::make_unique<SerialPort>(twin);
  writing->armEmergency(path);
  ports.writing = std::move(writing);
  return ports;
} catch (const std::exception&) {
  return std::nullopt;  // no memory, or a folder that cannot be listed: not opened; the link tries again
}

}  // namespace fettle::haptic
