#include "haptic/sound/sound_stream.h"

#include <algorithm>
#include <utility>

#include "haptic/effects/velocity.h"

namespace fettle::haptic {

namespace {

constexpr double kDelay_s = 0.024;
constexpr double kLongest_s = 0.120;
constexpr double kMostStretch = 0.05;
constexpr double kSmoothing = 0.02;        // per tick
constexpr std::size_t kFadeSamples = 48;   // a millisecond, in which ticks may have arrived again
constexpr std::size_t kSkipSamples = 120;  // in which the profile has faded

bool lasts(double seconds) noexcept {
  return seconds > 0.0 && seconds <= VelocityFilter::kLongestGap_s;
}

}  // namespace

std::size_t SampleClock::samplesOf(double seconds, double stretch) noexcept {
  constexpr double kOtherwise_s = 1e-3;
  due_ += (lasts(seconds) ? seconds : kOtherwise_s) * stretch * Synthesiser::kRate_hz;
  const auto whole = std::min(static_cast<std::size_t>(due_), kMost);
  due_ -= static_cast<double>(whole);
  return whole;
}

SoundStream::SoundStream(std::shared_ptr<SoundRing> ring, const SoundParams& params)
    : ring_(std::move(ring)), synthesiser_(params) {}

double SoundStream::stretch() const noexcept {
  const double lacking = (kDelay_s - waiting_s_) / kDelay_s;
  return 1.0 + kMostStretch * std::clamp(lacking, -1.0, 1.0);
}

// Makes the samples of the next tick, or of a millisecond without one.
void SoundStream::next() noexcept {
  played_ = 0;
  std::size_t waiting = ring_->waiting();
  if (!flows_ && static_cast<double>(waiting) * tick_s_ >= kDelay_s) {
    flows_ = true;
    waiting_s_ = kDelay_s;
  }
  SoundTick tick;
  if (static_cast<double>(waiting) * tick_s_ > kLongest_s) {
    for (; static_cast<double>(waiting) * tick_s_ > kDelay_s && ring_->pop(tick); --waiting)
      ++counters_.skipped;
    return makeFade(kSkipSamples);
  }
  if (flows_ && ring_->pop(tick)) {
    ++counters_.ticks;
    if (lasts(tick.seconds)) tick_s_ += kSmoothing * (tick.seconds - tick_s_);
    waiting_s_ += kSmoothing * (static_cast<double>(waiting) * tick_s_ - waiting_s_);
    made_count_ = clock_.samplesOf(tick.seconds, stretch());
    synthesiser_.render(tick, std::span(made_).first(made_count_));
    return;
  }
  counters_.gaps += flows_ ? 1 : 0;
  flows_ = false;
  makeFade(kFadeSamples);
}

void SoundStream::makeFade(std::size_t samples) noexcept {
  made_count_ = samples;
  synthesiser_.fade(std::span(made_).first(samples));
}

void SoundStream::fill(std::span<float> out) noexcept {
  while (!out.empty()) {
    while (played_ == made_count_) next();
    const std::size_t n = std::min(out.size(), made_count_ - played_);
    std::copy_n(made_.begin() + static_cast<std::ptrdiff_t>(played_), n, out.begin());
    played_ += n;
    out = out.subspan(n);
  }
}

}  // namespace fettle::haptic
