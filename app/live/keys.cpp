#include "app/live/keys.h"

#include <atomic>
#include <cerrno>

#include <poll.h>
#include <unistd.h>

namespace fettle::app {

namespace {

termios terminal_before{};
std::atomic<bool> terminal_changed{false};  // read by signal handlers
static_assert(std::atomic<bool>::is_always_lock_free);

}  // namespace

Keys::Keys(KeySource source) {
  if (isatty(STDIN_FILENO) == 0) {
    available_ = source == KeySource::kAnyInput;
    return;
  }
  if (tcgetattr(STDIN_FILENO, &terminal_before) != 0) return;
  termios single = terminal_before;
  // Single keys without echo; Ctrl-C still sends its signal. tcsetattr from the background would stop the
  // process.
  single.c_lflag &= ~static_cast<tcflag_t>(ICANON | ECHO);
  if (tcgetpgrp(STDIN_FILENO) != getpgrp() || tcsetattr(STDIN_FILENO, TCSANOW, &single) != 0) return;
  terminal_changed.store(true);
  available_ = true;
}

Keys::~Keys() {
  restoreTerminal(nullptr);
}

void Keys::restoreTerminal(void*) noexcept {
  if (terminal_changed.exchange(false)) tcsetattr(STDIN_FILENO, TCSANOW, &terminal_before);
}

std::optional<char> Keys::next() noexcept {
  while (available_) {
    pollfd input{.fd = STDIN_FILENO, .events = POLLIN, .revents = 0};
    if (::poll(&input, 1, 0) <= 0) return std::nullopt;
    char key = 0;
    const ssize_t n = ::read(STDIN_FILENO, &key, 1);
    if (n == 0 || (n < 0 && errno != EINTR && errno != EAGAIN)) available_ = false;  // closed
    if (n == 1 && key != '\n' && key != '\r') return key;
    if (n < 0) return std::nullopt;
  }
  return std::nullopt;
}

}  // namespace fettle::app
