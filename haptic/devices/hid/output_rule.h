#pragma once

#include <cstdint>

namespace fettle::haptic {

/// When a device accepts output.
enum class Pacing : std::uint8_t {
  kNone,      ///< never: no output
  kFree,      ///< whenever there is a new force
  kLockStep,  ///< once for each input; the device waits for it
};

/// Times of OutputRule [ns].
struct OutputTimes {
  /// Lock-step: longest wait of the reply to an input for the loop's force; two periods of a 1 kHz loop,
  /// since the loop's ticks and the device's inputs are not in step.
  std::int64_t reply_wait = 2'000'000;
  /// A force older than this is replaced by zero: the loop that computed it hangs, is stopped in a debugger
  /// or has ended.
  std::int64_t stale_after = 10'000'000;
  /// Lock-step: after this time without input a zero is sent, since the device may be waiting for a reply
  /// that was lost.
  std::int64_t silence = 10'000'000;
  /// Free: zeros are repeated at this interval, well below the firmware's watchdog of 500 ms.
  std::int64_t keep_alive = 100'000'000;
};

/// Decides what the writer thread sends and when; uses no clock, no thread and no device, so that tests can
/// run hours of virtual time. Rule: the newest force, or zero when there is no recent one. Not thread-safe:
/// used by the writer thread only.
class OutputRule {
 public:
  enum class Send : std::uint8_t { kNothing, kForce, kZero };

  OutputRule(Pacing pacing, const OutputTimes& times) noexcept : pacing_(pacing), times_(times) {}

  /// The device was opened (again); `inputs` is the count of inputs so far.
  void open(std::int64_t now, std::uint64_t inputs) noexcept {
    answered_ = inputs;
    seen_ = inputs;
    waiting_since_ = now;
    last_exchange_ = now;
    last_was_force_ = false;
    fresh_ = false;
    force_at_ = now - times_.stale_after;
  }

  /// The loop wrote a force at `written` (its own clock reading).
  void force(std::int64_t written) noexcept {
    fresh_ = true;
    force_at_ = written;
  }

  /// What to send now, if anything; `inputs` = inputs received so far. The answer counts as sent, whether or
  /// not the write then succeeds: a lost reply is replaced by the rule of silence.
  [[nodiscard]] Send decide(std::int64_t now, std::uint64_t inputs) noexcept {
    if (pacing_ == Pacing::kNone) return Send::kNothing;
    if (inputs != seen_) {
      if (answered_ == seen_) waiting_since_ = now;
      seen_ = inputs;
      if (pacing_ == Pacing::kLockStep) last_exchange_ = now;
    }
    const bool usable = now - force_at_ < times_.stale_after;
    return pacing_ == Pacing::kFree ? decideFree(now, usable) : decideLockStep(now, usable);
  }

  /// The latest time at which decide() must be called again when neither input nor force arrives.
  [[nodiscard]] std::int64_t deadline(std::int64_t now) const noexcept {
    if (pacing_ == Pacing::kLockStep)
      return answered_ != seen_ ? waiting_since_ + times_.reply_wait : last_exchange_ + times_.silence;
    if (pacing_ == Pacing::kFree)
      return last_was_force_ ? force_at_ + times_.stale_after : last_exchange_ + times_.keep_alive;
    return now + times_.keep_alive;
  }

 private:
  Send decideFree(std::int64_t now, bool usable) noexcept {
    if (fresh_ && usable) return sent(now, Send::kForce);
    if (last_was_force_ && !usable) return sent(now, Send::kZero);
    if (now - last_exchange_ >= times_.keep_alive) return sent(now, Send::kZero);
    return Send::kNothing;
  }

  Send decideLockStep(std::int64_t now, bool usable) noexcept {
    if (answered_ != seen_) {
      // A new force is sent immediately; without one there is a short wait for the loop, then the last force
      // is repeated while it is recent, then zero.
      if (!fresh_ && now - waiting_since_ < times_.reply_wait) return Send::kNothing;
      ++answered_;
      waiting_since_ = now;
      return sent(now, usable ? Send::kForce : Send::kZero);
    }
    if (now - last_exchange_ >= times_.silence) return sent(now, Send::kZero);
    return Send::kNothing;
  }

  Send sent(std::int64_t now, Send what) noexcept {
    fresh_ = false;
    last_exchange_ = now;
    last_was_force_ = what == Send::kForce;
    return what;
  }

  Pacing pacing_;
  OutputTimes times_;
  std::uint64_t answered_ = 0;  // inputs that got their reply
  std::uint64_t seen_ = 0;      // inputs as of the last decide()
  std::int64_t waiting_since_ = 0;
  std::int64_t last_exchange_ = 0;  // last input (lock-step) or output
  std::int64_t force_at_ = 0;
  bool fresh_ = false;
  bool last_was_force_ = false;
};

}  // namespace fettle::haptic
