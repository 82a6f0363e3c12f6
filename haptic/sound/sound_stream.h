#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>

#include "haptic/base/sound_tick.h"
#include "haptic/sound/synthesiser.h"

namespace fettle::haptic {

/// How many samples a tick lasts, so that no part of a sample is lost over many.
class SampleClock {
 public:
  /// Of a tick of some seconds, played by this much longer. A time that is unknown or above 20 ms counts as a millisecond. 0 .. kMost.
  [[nodiscard]] std::size_t samplesOf(double seconds, double stretch = 1.0) noexcept;

  static constexpr std::size_t kMost = 1024;

 private:
  double due_ = 0.0;  // of a sample
};

/// The sound of a loop that runs, for a device that asks for samples: ticks from its ring at the pace of the loop, held back by 24 ms, so
/// that neither the loop's lateness nor pieces of samples as large as that are heard. The clocks of loop and device differ: ticks are
/// stretched by up to 5 % towards that delay. An empty ring lets the sound fade until the delay is there again; one that holds more than
/// 120 ms, as after a device that stood still, is emptied down to it, after the sound has faded. Neither makes a step (Synthesiser).
///
/// Threading: fill() on one thread, which is the ring's consumer; it allocates nothing and waits for nobody.
class SoundStream {
 public:
  SoundStream(std::shared_ptr<SoundRing> ring, const SoundParams& params);

  /// The next samples.
  void fill(std::span<float> out) noexcept;
  void set(const SoundParams& params) noexcept { synthesiser_.set(params); }

  struct Counters {
    std::uint64_t ticks = 0;    ///< heard
    std::uint64_t skipped = 0;  ///< not heard: too many waited
    std::uint64_t gaps = 0;     ///< times that the ring was empty after ticks
  };
  [[nodiscard]] const Counters& counters() const noexcept { return counters_; }

  /// Places of a ring: a second at 10 kHz less a tenth is more than ever waits.
  static constexpr std::size_t kRingTicks = 8192;

 private:
  void next() noexcept;
  void makeFade(std::size_t samples) noexcept;
  [[nodiscard]] double stretch() const noexcept;

  std::shared_ptr<SoundRing> ring_;
  Synthesiser synthesiser_;
  SampleClock clock_;
  std::array<float, SampleClock::kMost> made_{};  // of the newest tick
  std::size_t made_count_ = 0, played_ = 0;
  bool flows_ = false;
  double tick_s_ = 1e-3;    // smoothed time of a tick
  double waiting_s_ = 0.0;  // smoothed time that waits in the ring
  Counters counters_;
};

}  // namespace fettle::haptic
