#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <string>

#include "app/sound/loudness.h"
#include "engine/base/error.h"
#include "haptic/base/latest_slot.h"
#include "haptic/base/sound_tick.h"
#include "haptic/scene/effects.h"
#include "haptic/sound/sound_stream.h"

namespace fettle::app {

/// Plays what a loop is heard as on the default audio device, through SDL: one channel at 48 kHz, pieces of 10 ms. SDL converts them to
/// what the device takes, and calls a thread of its own for each; that thread allocates nothing and waits for nobody.
///
/// Threading: main, but for what SDL calls.
class SoundPlayer {
 public:
  /// Plays the ticks of `ring`, of which it is the only consumer, until it is destroyed. Errors (kFailed): SDL is not installed, no audio
  /// device or sound server answers.
  [[nodiscard]] static engine::Result<std::unique_ptr<SoundPlayer>> open(
      std::shared_ptr<haptic::SoundRing> ring, const haptic::SoundParams& params, Loudness loudness);
  ~SoundPlayer();
  SoundPlayer& operator=(SoundPlayer&&) = delete;

  /// From the next piece on.
  void set(const haptic::SoundParams& params) noexcept { params_.publish(params); }
  void setLoudness(Loudness loudness) noexcept;

  /// "pulseaudio", "alsa", ...: what SDL plays through.
  [[nodiscard]] const std::string& driver() const noexcept { return driver_; }

  struct Counters {
    std::uint64_t samples = 0;  ///< asked for by the device
    std::uint64_t ticks = 0;    ///< heard
    std::uint64_t skipped = 0;  ///< see SoundStream
    std::uint64_t gaps = 0;
  };
  [[nodiscard]] Counters counters() const noexcept;

 private:
  SoundPlayer(std::shared_ptr<haptic::SoundRing> ring, const haptic::SoundParams& params, Loudness loudness);
  static void fill(void* self, std::uint8_t* bytes, int count) noexcept;
  void fill(float* samples, std::size_t count) noexcept;

  haptic::SoundStream stream_;  // of the audio thread while it runs
  haptic::LatestSlot<haptic::SoundParams> params_;
  std::atomic<float> gain_;                                                  // relaxed: a number of its own
  float gain_now_;                                                           // of the audio thread
  std::atomic<std::uint64_t> samples_{0}, ticks_{0}, skipped_{0}, gaps_{0};  // relaxed: for display
  std::uint32_t device_ = 0;
  std::string driver_;
};

}  // namespace fettle::app
