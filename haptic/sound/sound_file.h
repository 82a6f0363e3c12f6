#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "engine/base/error.h"
#include "haptic/sound/sound_stream.h"
#include "haptic/sound/synthesiser.h"

namespace fettle::haptic {

/// The sound of recorded ticks as a file: WAV, one channel of 16 bits at 48 kHz. The same ticks give the same bytes.
///
/// Threading: one thread at a time.
class SoundFile {
 public:
  explicit SoundFile(const SoundParams& params) noexcept : synthesiser_(params) {}

  /// Of a scene with other parameters, from the next tick on.
  void set(const SoundParams& params) noexcept { synthesiser_.set(params); }
  /// The next tick, at a time in seconds. A gap of up to an hour is as long here as it was; time that does not advance, goes back or is
  /// not finite counts as a millisecond. Errors (kFailed): no memory, 96 kB per second.
  [[nodiscard]] engine::Status add(const SoundTick& tick, double t_s);

  [[nodiscard]] double seconds() const noexcept;
  /// Loudest sample, 0 .. 1.
  [[nodiscard]] double peak() const noexcept;
  /// Of all samples, for reports: as FNV-1a, sample by sample.
  [[nodiscard]] std::uint64_t hash() const noexcept;

  /// Whole or not at all. Errors: those of AtomicFile; longer than the 12 hours that a WAV file holds.
  [[nodiscard]] engine::Status write(const std::string& path) const;

 private:
  void append(const SoundTick& tick, std::size_t samples);

  Synthesiser synthesiser_;
  SampleClock clock_;
  std::vector<std::int16_t> samples_;
  std::optional<double> t_s_;  // of the last tick
};

}  // namespace fettle::haptic
