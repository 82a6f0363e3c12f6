#include "haptic/sound/synthesiser.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace fettle::haptic {

namespace {

constexpr double kRate = Synthesiser::kRate_hz;
constexpr double kFull_cells_s =
    500.0;  // see Synthesiser: a slow hand on a scan of 0.05 mm is slower than 25 mm/s
constexpr double kKnock_cells_s = 500.0;  // a knock is half as loud as it can be
constexpr double kSoftestKnock = 0.1;     // of contact that begins at no speed
constexpr double kCut_hz = 7000.0;        // the profile has values at 16 kHz
constexpr double kMean_hz = 30.0;         // below, the form of a part is moved along
constexpr double kNoise_hz = 2000.0;      // below, sliding is not heard
constexpr double kProfile = 3.0;          // a scan's noise, as steep as 0.1, is then a tenth of full
constexpr double kQuietest = 0.3;         // of the profile, touched without force
constexpr double kSmooth_s = 0.002;       // of all gains
constexpr double kIntoBody = 0.5;         // part of the profile that the body takes up
constexpr double kSlide = 0.08;           // sliding beside a surface as steep as 1
constexpr double kSilent = 1e-9;
constexpr double kMost = 1e6;  // of any number in a tick

// Of a one-pole filter at a frequency.
double poleAt(double hz) noexcept {
  return 1.0 - std::exp(-2.0 * std::numbers::pi * hz / kRate);
}

double sane(float value) noexcept {
  return std::isfinite(value) ? std::clamp(static_cast<double>(value), -kMost, kMost) : 0.0;
}
double sanePart(float value) noexcept {
  return std::clamp(sane(value), 0.0, 1.0);
}

// Straight for quiet sounds, never 1.
double limited(double x) noexcept {
  return x / std::sqrt(1.0 + x * x);
}

// The vertical speed of the tip at a place of two ticks, the previous one from -kPieces to 0, this one from 0 to kPieces.
class Profile {
 public:
  using Speeds = std::array<double, SoundTick::kPieces>;

  Profile(const Speeds& before, const Speeds& now) noexcept {
    for (std::size_t i = 0; i < 2 * kPieces; ++i)
      sums_[i + 1] = sums_[i] + (i < kPieces ? before[i] : now[i - kPieces]);
  }
  /// Speed, the mean over the last `width` pieces.
  [[nodiscard]] double speedAt(double place, double width) const noexcept {
    return (at(place) - at(place - width)) / width;
  }

 private:
  [[nodiscard]] double at(double place) const noexcept {
    const double x = place + static_cast<double>(kPieces);
    const auto i = std::min(static_cast<std::size_t>(x), 2 * kPieces - 1);
    return sums_[i] + (x - static_cast<double>(i)) * (sums_[i + 1] - sums_[i]);
  }

  static constexpr std::size_t kPieces = SoundTick::kPieces;
  std::array<double, 2 * kPieces + 1> sums_{};
};

}  // namespace

Synthesiser::LowPass::LowPass(double cut_hz) noexcept {
  const double turn = 2.0 * std::numbers::pi * cut_hz / kRate;
  const double alpha = std::sin(turn) / std::numbers::sqrt2;  // Butterworth: Q = 1 / sqrt 2
  const double a0 = 1.0 + alpha;
  b0 = b2 = 0.5 * (1.0 - std::cos(turn)) / a0;
  b1 = 2.0 * b0;
  a1 = -2.0 * std::cos(turn) / a0;
  a2 = (1.0 - alpha) / a0;
}

double Synthesiser::LowPass::next(double x) noexcept {
  const double y = b0 * x + s1;
  s1 = b1 * x - a1 * y + s2;
  s2 = b2 * x - a2 * y;
  return y;
}

Synthesiser::Synthesiser(const SoundParams& params) noexcept
    : params_(params),
      body_(params.body_hz, 1e-3 * params.ring_ms, kRate),
      low_pass_(kCut_hz),
      smooth_(1.0 - std::exp(-1.0 / (kSmooth_s * kRate))),
      mean_pole_(poleAt(kMean_hz)),
      noise_pole_(poleAt(kNoise_hz)) {
  double sum = 0.0;
  for (std::size_t i = 0; i < kBlowSamples; ++i) {
    blow_shape_[i] = 1.0 - std::cos(2.0 * std::numbers::pi * (static_cast<double>(i) + 0.5) / kBlowSamples);
    sum += blow_shape_[i];
  }
  for (double& value : blow_shape_) value /= sum;
}

void Synthesiser::set(const SoundParams& params) noexcept {
  if (params == params_) return;
  params_ = params;
  body_.set(params.body_hz, 1e-3 * params.ring_ms, kRate);
}

void Synthesiser::strike(double size) noexcept {
  // More than four within half a millisecond are not heard apart.
  for (Blow& blow : blows_)
    if (blow.at >= kBlowSamples) {
      blow = {size, 0};
      return;
    }
}

double Synthesiser::nextBlow() noexcept {
  double sum = 0.0;
  for (Blow& blow : blows_)
    if (blow.at < kBlowSamples) sum += blow.size * blow_shape_[blow.at++];
  return sum;
}

// George Marsaglia's xorshift (2003), -1 .. 1: a fixed sequence.
double Synthesiser::noise() noexcept {
  random_ ^= random_ << 13U;
  random_ ^= random_ >> 17U;
  random_ ^= random_ << 5U;
  return static_cast<double>(random_) / 2147483648.0 - 1.0;
}

void Synthesiser::render(const SoundTick& tick, std::span<float> out) noexcept {
  if (tick.contact && tick.approach_cells_s > 0.0F) {
    const double speed = sane(tick.approach_cells_s);
    strike(params_.knock * std::max(speed / (speed + kKnock_cells_s), kSoftestKnock));
  }
  if (tick.contact && tick.released > 0.0F) strike(params_.slip * sanePart(tick.released));
  const double level = tick.contact ? kProfile * params_.profile *
                                          (kQuietest + (1.0 - kQuietest) * std::sqrt(sanePart(tick.strength)))
                                    : 0.0;
  const double speed = std::abs(sane(tick.speed_cells_s));
  const double slide =
      tick.contact && tick.slipping
          ? params_.slip * kSlide * std::sqrt(sanePart(tick.strength)) * speed / (speed + kFull_cells_s)
          : 0.0;

  // At once, or the first milliseconds of a fast hand would be as loud as a slow hand's on a steeper surface.
  speed_ = std::max(speed_, speed);
  if (out.empty()) return;
  constexpr double kPieces = SoundTick::kPieces;
  const double step = kPieces / static_cast<double>(out.size());
  Profile::Speeds now{};
  if (tick.contact) {
    closing_ = 0.0;
    for (std::size_t i = 0; i < now.size(); ++i) now[i] = sane(tick.rise_cells[i]) * kRate * step;
  } else if (level_ > 0.0) {
    if (closing_ == 0.0) closing_ = level_ / (kSmooth_s * kRate);
    std::reverse_copy(rise_s_.begin(), rise_s_.end(), now.begin());
  }
  const Profile profile(rise_s_, now);
  // The mean over a piece, or over a sample where that is longer: a straight line between the pieces' speeds, and no alias.
  const double width = std::max(step, 1.0);
  for (std::size_t i = 0; i < out.size(); ++i) {
    const double place = step * static_cast<double>(i + 1);
    const double rise_s = profile.speedAt(place, width);
    level_ = closing_ > 0.0 ? std::max(level_ - closing_, 0.0) : level_ + smooth_ * (level - level_);
    slide_ += smooth_ * (slide - slide_);
    speed_ += smooth_ * (speed - speed_);
    const double steep = low_pass_.next(rise_s / (speed_ + kFull_cells_s));
    mean_ += mean_pole_ * (steep - mean_);
    const double surface = level_ * (steep - mean_);
    double slides = 0.0;
    if (slide_ > kSilent) {
      const double white = noise();
      mean_noise_ += noise_pole_ * (white - mean_noise_);
      slides = slide_ * (white - mean_noise_);
    }
    const double rings = body_.next(nextBlow(), kIntoBody * (limited(surface) + slides));
    out[i] = static_cast<float>(limited(surface + slides + rings));
  }
  rise_s_ = now;
  settle();
}

void Synthesiser::settle() noexcept {
  body_.settle();
  for (double* const value : {&level_, &slide_, &speed_, &mean_, &low_pass_.s1, &low_pass_.s2})
    if (std::abs(*value) < kSilent) *value = 0.0;
}

}  // namespace fettle::haptic
