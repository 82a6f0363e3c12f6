#include "haptic/sound/sound_file.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <new>

#include "engine/io/files/atomic_file.h"
#include "haptic/effects/velocity.h"

namespace fettle::haptic {

namespace {

static_assert(std::endian::native == std::endian::little,
              "WAV is little-endian, and samples are written as they are");

constexpr double kLongestPause_s = 3600.0;
constexpr double kFull = 32767.0;
constexpr std::uint32_t kSampleBytes = sizeof(std::int16_t);
constexpr std::uint32_t kHeaderBytes = 44;  // of which RIFF counts all but its first 8

void put(std::string& to, std::uint32_t value, std::size_t bytes) {
  for (std::size_t i = 0; i < bytes; ++i) to += static_cast<char>((value >> (8 * i)) & 0xFFU);
}

// IBM, Microsoft, "Multimedia programming interface and data specifications 1.0" (1991): PCM.
std::string wavHeader(std::uint32_t data_bytes) {
  constexpr std::uint32_t kRate = Synthesiser::kRate_hz;
  std::string text = "RIFF";
  put(text, kHeaderBytes - 8 + data_bytes, 4);
  text += "WAVEfmt ";
  put(text, 16, 4);  // bytes that follow
  put(text, 1, 2);   // PCM
  put(text, 1, 2);   // channels
  put(text, kRate, 4);
  put(text, kRate * kSampleBytes, 4);  // bytes per second
  put(text, kSampleBytes, 2);          // of all channels
  put(text, 8 * kSampleBytes, 2);      // bits
  text += "data";
  put(text, data_bytes, 4);
  return text;
}

}  // namespace

void SoundFile::append(const SoundTick& tick, std::size_t samples) {
  std::array<float, SampleClock::kMost> made;
  const std::span<float> part = std::span(made).first(samples);
  synthesiser_.render(tick, part);
  for (const float sample : part)
    samples_.push_back(static_cast<std::int16_t>(std::lround(kFull * static_cast<double>(sample))));
}

engine::Status SoundFile::add(const SoundTick& tick, double t_s) {
  const double seconds = t_s_ ? t_s - *t_s_ : 0.0;
  t_s_ = t_s;
  try {
    // A pause ends with the tick after it, which is as long as any.
    if (seconds > VelocityFilter::kLongestGap_s && seconds <= kLongestPause_s)
      for (auto left = static_cast<std::int64_t>(seconds * 1e3) - 1; left > 0; --left)
        append({}, clock_.samplesOf(1e-3));
    append(tick, clock_.samplesOf(seconds));
  } catch (const std::bad_alloc&) {
    return engine::failure("memory for the sound could not be allocated", "sound", "replay without --sound");
  }
  return {};
}

double SoundFile::seconds() const noexcept {
  return static_cast<double>(samples_.size()) / Synthesiser::kRate_hz;
}

double SoundFile::peak() const noexcept {
  int most = 0;
  for (const std::int16_t sample : samples_) most = std::max(most, std::abs(static_cast<int>(sample)));
  return most / kFull;
}

std::uint64_t SoundFile::hash() const noexcept {
  std::uint64_t hash = 0xcbf29ce484222325;
  for (const std::int16_t sample : samples_)
    hash = (hash ^ static_cast<std::uint16_t>(sample)) * 0x100000001b3;
  return hash;
}

engine::Status SoundFile::write(const std::string& path) const {
  const std::size_t bytes = samples_.size() * kSampleBytes;
  if (bytes > std::numeric_limits<std::uint32_t>::max() - kHeaderBytes)
    return engine::inputError("the sound is longer than a WAV file can be, 12 hours", path,
                              "replay a part of the session");
  auto file = engine::AtomicFile::create(path);
  if (!file) return tl::unexpected(file.error());
  if (auto status = file->write(wavHeader(static_cast<std::uint32_t>(bytes))); !status) return status;
  if (auto status = file->write({reinterpret_cast<const char*>(samples_.data()), bytes}); !status)
    return status;
  return file->commit();
}

}  // namespace fettle::haptic
