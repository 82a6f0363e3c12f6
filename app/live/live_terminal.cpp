#include "app/live/live_terminal.h"

#include <atomic>
#include <cerrno>
#include <cstdio>

#include <fmt/format.h>
#include <poll.h>
#include <unistd.h>
#include <glm/geometric.hpp>

#include "app/terminal.h"

namespace fettle::app {

namespace {

termios terminal_before{};
std::atomic<bool> terminal_changed{false};  // read by signal handlers
static_assert(std::atomic<bool>::is_always_lock_free);

constexpr double kRedraw_s = 0.2;

// A closed terminal must not end the session.
void put(const std::string& text) {
  std::fputs(text.c_str(), stderr);
  std::fflush(stderr);
}

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

StatusLine::StatusLine() : terminal_(!voice().quiet && isatty(STDERR_FILENO) != 0) {}

StatusLine::~StatusLine() {
  wipe();
}

void StatusLine::wipe() {
  if (terminal_ && shown_at_ >= 0.0) put("\r\x1b[K");
}

void StatusLine::show(const haptic::LoopState& state, const haptic::LoopTiming& timing, double seconds,
                      double ticks_per_second) {
  if (!terminal_ || (shown_at_ >= 0.0 && seconds - shown_at_ < kRedraw_s)) return;
  shown_at_ = seconds;
  const haptic::TimingFigures late = timing.lateness.figures();
  put(fmt::format(
      "\r\x1b[K{:7.1f} s  {:5.0f}/s  late p99 {:4.0f} us  missed {}  {}  {:4.2f} N  {}{}  {} strokes",
      seconds, ticks_per_second, 1e-3 * static_cast<double>(late.p99_ns),
      timing.missed.load(std::memory_order_relaxed), haptic::name(state.safety), glm::length(state.given_n),
      haptic::toolName(state.tool), state.contact ? ", touching" : "", state.stroke));
}

void StatusLine::report(const SessionEvent& event) {
  if (voice().quiet) return;  // the report lists every event
  wipe();
  put(fmt::format("fettle: {:.3f} s: {}{}{}\n", event.t, event.what, event.remedy.empty() ? "" : ": ",
                  event.remedy));
  shown_at_ = -1.0;
}

}  // namespace fettle::app
