#include "app/live/live_session.h"

#include <chrono>
#include <thread>
#include <utility>

#include <fmt/format.h>

#include "app/sound/loop_sound.h"
#include "app/terminal.h"
#include "engine/base/stopwatch.h"
#include "haptic/safety/last_resort.h"

namespace fettle::app {

namespace {

using haptic::CommandKind;
using haptic::FaultCause;
using haptic::LinkState;
using haptic::LoopState;
using haptic::SafetyState;
using namespace std::chrono_literals;

constexpr auto kPollInterval = 5ms;  // between two polls of rings, keys and state
constexpr double kArmAgain_s = 0.1;  // between two automatic attempts to arm
constexpr auto kFade = 30ms;         // a disarmed force has faded after peak / slew = 5 ms

std::string remedyFor(FaultCause cause) {
  switch (cause) {
    case FaultCause::kInputLost:
      return "no input from the device: check cable and power, then press a to arm";
    case FaultCause::kLoopStopped:
      return "the program was delayed: press a to arm";
    case FaultCause::kUnplugged:
      return "plug the device in, calibrate it if necessary, then press a to arm";
    case FaultCause::kOutputStalled:
      return "the device accepts no force: plug it in again, or press a to arm when it has recovered";
    case FaultCause::kLastResort:
    case FaultCause::kNone:
      break;
  }
  return "";
}

std::string_view linkName(LinkState link) {
  switch (link) {
    case LinkState::kDisconnected:
      return "not plugged in";
    case LinkState::kUncalibrated:
      return "not calibrated";
    case LinkState::kConnected:
      return "connected";
  }
  return "";
}

std::string_view linkRemedy(LinkState link) {
  switch (link) {
    case LinkState::kDisconnected:
      return "plug it in, it is waited for; Ctrl-C ends";
    case LinkState::kUncalibrated:
      return "hold the stylus in its home pose and press c, or the device's own button";
    case LinkState::kConnected:
      break;
  }
  return "";
}

// The guard's state kUncalibrated also includes a ready device that is not armed.
std::string stateName(const LoopState& state) {
  if (state.safety == SafetyState::kUncalibrated && state.link == LinkState::kConnected) return "not armed";
  return std::string(haptic::name(state.safety));
}

class LiveSession {
 public:
  LiveSession(haptic::HapticLoop& loop, haptic::Device& device, const LiveSettings& settings, SessionLog& log,
              const engine::JobControl& job)
      : loop_(loop), device_(device), settings_(settings), log_(log), job_(job), keys_(settings.keys) {}

  engine::Result<LiveOutcome> run() {
    const haptic::ZeroOnLastResort terminal(&Keys::restoreTerminal, nullptr);
    // After the program's own handlers, which it calls in turn.
    if (engine::Status status = haptic::LastResort::install(); !status) return tl::unexpected(status.error());
    if (engine::Status status = device_.start(); !status) return tl::unexpected(status.error());
    if (engine::Status status = loop_.start(); !status) {
      device_.stop();
      return tl::unexpected(status.error());
    }
    reportStart();
    engine::Status written = work();
    loop_.disarm();
    std::this_thread::sleep_for(kFade);
    outcome_.field = loop_.stop();
    device_.stop();
    haptic::LastResort::reset();  // a signal ended the session, not the program: the work is still saved
    if (written) written = drain();
    if (!written) return tl::unexpected(written.error());
    finish();
    return std::move(outcome_);
  }

 private:
  void finish() {
    watch();
    outcome_.last = now_;
    outcome_.granted = loop_.realTime();
    const haptic::LoopTiming& timing = loop_.timing();
    outcome_.lateness = timing.lateness.figures();
    outcome_.compute = timing.compute.figures();
    outcome_.missed = timing.missed.load(std::memory_order_relaxed);
    outcome_.over_1_ms = timing.lateness.countAbove(1'000'000);
    outcome_.device = device_.counters();
  }

  void reportStart() {
    for (const std::string& missing : loop_.realTime().missing)
      report("the system did not grant the loop everything", missing);
    if (settings_.arm == ArmPolicy::kByKey)
      report("no force yet", keys_.available()
                                 ? "hold the stylus clear of the surface and press a to arm, q to end"
                                 : "no key can be read to arm: run it in a terminal, or with --keys");
  }

  engine::Status work() {
    const engine::Stopwatch since_start;
    while (!ended()) {
      if (engine::Status status = drain(); !status) return status;
      for (haptic::LoopEvent event; loop_.poll(event);)
        if (event.kind == haptic::EventKind::kStrokeEnded) report("stroke kept", "");
      while (const auto key = keys_.next()) press(*key);
      watch();
      if (settings_.arm == ArmPolicy::kAuto) armByItself();
      const double lived = since_start.seconds();
      status_.show(now_, loop_.timing(), lived, lived > 0.0 ? static_cast<double>(now_.tick) / lived : 0.0);
      std::this_thread::sleep_for(kPollInterval);
    }
    return {};
  }

  bool ended() {
    if (job_.cancelled()) outcome_.ended_by = "signal";
    if (quit_) outcome_.ended_by = "key";
    if (settings_.seconds > 0.0 && log_.seconds() >= settings_.seconds) outcome_.ended_by = "time";
    if (settings_.most_ticks > 0 && now_.tick >= settings_.most_ticks)
      outcome_.ended_by = "end of the strokes";
    return !outcome_.ended_by.empty();
  }

  engine::Status drain() {
    for (haptic::TickRecord record; loop_.pollRecord(record);)
      if (engine::Status status = log_.add(record); !status) return status;
    return log_.flushIfDue();
  }

  void send(CommandKind kind, haptic::Tool tool = haptic::Tool::kFeel) {
    haptic::LoopCommand command;
    command.kind = kind;
    command.tool = tool;
    // A full ring: the loop does not run, and its fault will report that.
    static_cast<void>(loop_.send(std::move(command)));
  }

  void choose(haptic::Tool tool) {
    send(CommandKind::kTool, tool);
    report(fmt::format("tool {}", haptic::toolName(tool)), "");
  }

  void press(char key) {
    switch (key) {
      case 'a':
        disarmed_ = false;
        static_cast<void>(loop_.send(loop_.armCommand()));
        break;
      case 'd':
        disarmed_ = true;
        loop_.disarm();
        break;
      case 'c':
        device_.calibrate();
        break;
      case 'q':
        quit_ = true;
        break;
      default:
        pressTool(key);
    }
  }

  void pressTool(char key) {
    for (const haptic::ToolRow& tool : haptic::kToolRows)
      if (key == tool.key) return choose(tool.tool);
    report("keys", fmt::format("a arm, d disarm, c calibrate, {}, q end", toolKeys(", ")));
  }

  void armByItself() {
    // After a disarm by the user only the user arms again.
    if (disarmed_) return;
    const bool waits = now_.safety == SafetyState::kUncalibrated || now_.safety == SafetyState::kFault;
    if (!waits || now_.link != LinkState::kConnected || log_.seconds() - tried_at_ < kArmAgain_s) return;
    tried_at_ = log_.seconds();
    static_cast<void>(loop_.send(loop_.armCommand()));
  }

  // The only place that reads the state: the slot's value is valid until the next read.
  void watch() {
    const LoopState before = std::exchange(now_, loop_.state());
    if (now_.tick == 0) return;
    if (first_ns_ == 0) first_ns_ = now_.time_ns;
    const LoopState& state = now_;
    const bool first = before.tick == 0;
    if (first || state.link != before.link) {
      report(fmt::format("device {}", linkName(state.link)), std::string(linkRemedy(state.link)));
    }
    if (state.safety_counters.faults > before.safety_counters.faults)
      report(fmt::format("fault, {}", haptic::name(state.cause)), remedyFor(state.cause));
    if (state.safety_counters.arms_refused > before.safety_counters.arms_refused)
      report("not armed", "the device must be connected, calibrated and sending input");
    if (first || state.safety != before.safety) report(stateName(state), "");
    if (state.lost_records > 0 && before.lost_records == 0)
      report("ticks were not recorded", "the disk or the processor is too slow: a replay will differ");
  }

  void report(std::string what, std::string remedy) {
    const double t = 1e-9 * static_cast<double>(now_.time_ns - first_ns_);
    outcome_.events.push_back({t, std::move(what), std::move(remedy)});
    status_.report(outcome_.events.back());
  }

  haptic::HapticLoop& loop_;
  haptic::Device& device_;
  const LiveSettings& settings_;
  SessionLog& log_;
  const engine::JobControl& job_;
  Keys keys_;
  StatusLine status_;
  LiveOutcome outcome_;
  LoopState now_;              // as of the last read
  std::int64_t first_ns_ = 0;  // of the first tick seen
  double tried_at_ = -1.0;
  bool disarmed_ = false;  // by the user, who did not arm since
  bool quit_ = false;
};

}  // namespace

std::string toolKeys(std::string_view between) {
  std::string keys;
  for (const haptic::ToolRow& tool : haptic::kToolRows)
    keys += fmt::format("{}{} {}", keys.empty() ? "" : between, tool.key, tool.word);
  return keys;
}

engine::Result<LiveOutcome> runLive(const engine::Version& start, const engine::Version& original,
                                    const haptic::Scene& scene, haptic::Device& device,
                                    const LiveSettings& settings, SessionLog& log,
                                    const engine::JobControl& job) {
  LoopSound sound{Loudness{}};
  if (const engine::Status status = sound.follow(scene); !status)
    warn(fmt::format("{}: {}", status.error().what, status.error().remedy));
  haptic::HapticLoop::Settings with_sound = settings.loop;
  with_sound.sounds = sound.ring();
  auto loop = haptic::HapticLoop::create(start, original, scene, device, with_sound);
  if (!loop) return tl::unexpected(loop.error());
  auto outcome = LiveSession(**loop, device, settings, log, job).run();
  if (outcome && scene.invert) outcome->field = outcome->field.inverted();
  return outcome;
}

}  // namespace fettle::app
