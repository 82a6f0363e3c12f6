#include "app/sound/sound_player.h"

#include <algorithm>
#include <span>
#include <utility>

#include <fmt/format.h>

#include "app/sound/sdl_calls.h"
#include "haptic/base/rt_thread.h"

namespace fettle::app {

namespace {

constexpr std::uint16_t kPiece = 512;    // samples: 10.7 ms
constexpr float kGainStep = 1.0F / 480;  // per sample: a volume changes within 10 ms

// What is heard as equally louder steps is a power of the volume.
float gainOf(Loudness loudness) noexcept {
  return loudness.muted ? 0.0F : loudness.volume * loudness.volume;
}

tl::unexpected<engine::Error> noDevice(const SdlCalls& sdl) {
  return engine::failure(fmt::format("no sound: no audio device answers ({})", sdl.get_error()), "sound",
                         "connect one or start a sound server, or take \"sound\" out of the effects");
}

}  // namespace

SoundPlayer::SoundPlayer(std::shared_ptr<haptic::SoundRing> ring, const haptic::SoundParams& params,
                         Loudness loudness)
    : stream_(std::move(ring), params),
      params_(params),
      gain_(gainOf(loudness)),
      gain_now_(gainOf(loudness)) {}

engine::Result<std::unique_ptr<SoundPlayer>> SoundPlayer::open(std::shared_ptr<haptic::SoundRing> ring,
                                                               const haptic::SoundParams& params,
                                                               Loudness loudness) {
  const auto loaded = sdlCalls();
  if (!loaded) return tl::unexpected(loaded.error());
  const SdlCalls& sdl = **loaded;
  // With audio SDL starts its events, which would take the signals that end this program.
  sdl.set_hint(SDL_HINT_NO_SIGNAL_HANDLERS, "1");
  sdl.set_hint(SDL_HINT_AUDIO_DEVICE_APP_NAME, "Fettle");
  if (sdl.init_sub_system(SDL_INIT_AUDIO) != 0) return noDevice(sdl);
  std::unique_ptr<SoundPlayer> player(new SoundPlayer(std::move(ring), params, loudness));
  SDL_AudioSpec wanted{}, given{};
  wanted.freq = haptic::Synthesiser::kRate_hz;
  wanted.format = AUDIO_F32SYS;
  wanted.channels = 1;
  wanted.samples = kPiece;
  wanted.callback = [](void* self, Uint8* bytes, int count) { fill(self, bytes, count); };
  wanted.userdata = player.get();
  player->device_ = sdl.open_audio_device(nullptr, 0, &wanted, &given, 0);
  if (player->device_ == 0) {
    auto error = noDevice(sdl);
    sdl.quit_sub_system(SDL_INIT_AUDIO);
    return error;
  }
  if (const char* driver = sdl.current_audio_driver()) player->driver_ = driver;
  sdl.pause_audio_device(player->device_, 0);
  return player;
}

SoundPlayer::~SoundPlayer() {
  if (device_ == 0) return;
  const SdlCalls& sdl = **sdlCalls();
  sdl.close_audio_device(device_);  // its thread has ended then
  sdl.quit_sub_system(SDL_INIT_AUDIO);
}

void SoundPlayer::setLoudness(Loudness loudness) noexcept {
  gain_.store(gainOf(loudness), std::memory_order_relaxed);
}

SoundPlayer::Counters SoundPlayer::counters() const noexcept {
  return {samples_.load(std::memory_order_relaxed), ticks_.load(std::memory_order_relaxed),
          skipped_.load(std::memory_order_relaxed), gaps_.load(std::memory_order_relaxed)};
}

void SoundPlayer::fill(void* self, std::uint8_t* bytes, int count) noexcept {
  static_cast<SoundPlayer*>(self)->fill(reinterpret_cast<float*>(bytes),
                                        static_cast<std::size_t>(count) / sizeof(float));
}

void SoundPlayer::fill(float* samples, std::size_t count) noexcept {
  const haptic::DenormalScope quiet_is_zero;
  if (params_.take()) stream_.set(params_.latest());
  const std::span<float> out(samples, count);
  stream_.fill(out);
  const float gain = gain_.load(std::memory_order_relaxed);
  for (float& sample : out) {
    gain_now_ += std::clamp(gain - gain_now_, -kGainStep, kGainStep);
    sample *= gain_now_;
  }
  const haptic::SoundStream::Counters& counters = stream_.counters();
  samples_.fetch_add(count, std::memory_order_relaxed);
  ticks_.store(counters.ticks, std::memory_order_relaxed);
  skipped_.store(counters.skipped, std::memory_order_relaxed);
  gaps_.store(counters.gaps, std::memory_order_relaxed);
}

}  // namespace fettle::app
