#include "tests/end_to_end/window/frame_gate.h"

#include <cstring>
#include <stdexcept>
#include <utility>

#include <poll.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include "tests/end_to_end/window/view_program.h"

namespace fettle::tests {
namespace {

// Whether something comes in time.
bool comes(int from) {
  constexpr auto kPatience = std::chrono::duration_cast<std::chrono::milliseconds>(ViewProgram::kPatience);
  pollfd wait{from, POLLIN, 0};
  return poll(&wait, 1, static_cast<int>(kPatience.count())) == 1;
}

}  // namespace

FrameGate::FrameGate(const std::string& path) : path_(path) {
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  if (path.size() >= sizeof(address.sun_path)) throw std::runtime_error("too long for a socket: " + path);
  std::memcpy(address.sun_path, path.c_str(), path.size());
  listening_ = socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
  if (listening_ < 0 || bind(listening_, reinterpret_cast<const sockaddr*>(&address), sizeof(address)) != 0 ||
      listen(listening_, 1) != 0)
    throw std::runtime_error("no socket at " + path);
}

FrameGate::~FrameGate() {
  disconnect();
  close(listening_);
}

std::map<std::string, std::string> FrameGate::environment() const {
  return {{"VK_ADD_LAYER_PATH", FETTLE_LAYER_FOLDER},
          {"VK_INSTANCE_LAYERS", "VK_LAYER_FETTLE_lose_device"},
          {"FETTLE_FRAME_GATE", path_}};
}

void FrameGate::say(char what) const {
  // A program that has ended is noticed where its answer does not come.
  (void)send(program_, &what, 1, MSG_NOSIGNAL);
}

bool FrameGate::waits() {
  if (!comes(program_)) throw std::runtime_error("no frame for a long time");
  char what = 0;
  if (recv(program_, &what, 1, 0) == 1) return true;
  disconnect();
  return false;
}

bool FrameGate::hold() {
  if (program_ < 0) {
    if (!comes(listening_)) throw std::runtime_error("the program never showed a frame");
    program_ = accept4(listening_, nullptr, nullptr, SOCK_CLOEXEC);
  }
  say('h');
  return waits();
}

bool FrameGate::step() {
  say('s');
  return waits();
}

void FrameGate::release() {
  if (program_ >= 0) say('f');
}

void FrameGate::disconnect() {
  if (program_ >= 0) close(std::exchange(program_, -1));
}

}  // namespace fettle::tests
