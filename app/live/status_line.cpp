#include "app/live/status_line.h"

#include <cstdio>

#include <fmt/format.h>
#include <unistd.h>
#include <glm/geometric.hpp>

#include "app/terminal.h"

namespace fettle::app {

namespace {

constexpr double kRedraw_s = 0.2;

// A closed terminal must not end the session.
void put(const std::string& text) {
  std::fputs(text.c_str(), stderr);
  std::fflush(stderr);
}

}  // namespace

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
