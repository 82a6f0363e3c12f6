#pragma once

#include <cstdint>

namespace fettle::haptic {

/// When ticks are due: a grid of times, one per period. A late tick runs late; periods that have passed
/// completely by then are counted and skipped, so two ticks never share a period and a stall is not followed
/// by a burst. The grid does not drift.
class Schedule {
 public:
  Schedule(std::int64_t start_ns, std::int64_t period_ns) noexcept
      : due_ns_(start_ns), period_ns_(period_ns) {}

  /// When the next tick is due. [ns]
  [[nodiscard]] std::int64_t due() const noexcept { return due_ns_; }
  [[nodiscard]] std::int64_t period() const noexcept { return period_ns_; }

  /// The tick that was due wakes at `now_ns`: how late it is, and how many later ones are skipped.
  struct Wake {
    std::int64_t lateness_ns = 0;
    std::int64_t skipped = 0;
  };
  [[nodiscard]] Wake wake(std::int64_t now_ns) noexcept {
    const std::int64_t late = now_ns > due_ns_ ? now_ns - due_ns_ : 0;
    const Wake wake{late, late / period_ns_};
    due_ns_ += (wake.skipped + 1) * period_ns_;
    return wake;
  }

 private:
  std::int64_t due_ns_;
  std::int64_t period_ns_;
};

/// Sleeps from tick to tick: clock_nanosleep with an absolute time, so that neither the work of a tick nor a
/// late wake-up shifts the next.
///
/// Threading: one thread; wait() sleeps, the rest does not.
class Pacer {
 public:
  static constexpr double kLowestRate_hz = 1000.0;
  static constexpr double kHighestRate_hz = 10000.0;

  /// `rate_hz` is clamped to kLowestRate_hz .. kHighestRate_hz.
  explicit Pacer(double rate_hz) noexcept;

  struct Tick {
    std::int64_t woke_ns = 0;      ///< engine::steadyNs() at wake-up
    std::int64_t lateness_ns = 0;  ///< after the due time
    std::int64_t skipped = 0;      ///< periods without a tick since the last one
    std::int64_t since_ns = 0;     ///< since the previous wake-up
  };
  /// Sleeps until the next tick is due; returns at once when that is past.
  [[nodiscard]] Tick wait() noexcept;

  [[nodiscard]] std::int64_t period() const noexcept { return schedule_.period(); }

 private:
  Schedule schedule_;
  std::int64_t last_ns_;
};

}  // namespace fettle::haptic
