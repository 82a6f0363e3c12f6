#include "engine/measure/spatial.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <numbers>
#include <utility>

#include <fmt/format.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include "engine/compare/tile_sums.h"
#include "engine/measure/plane_transform.h"
#include "engine/measure/wave_fit.h"

namespace fettle::engine {

namespace {

using std::numbers::pi;

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
constexpr double kDecayLevel = 0.2;     // the standard's default
constexpr std::int32_t kLeastSide = 4;  // for lags of two samples in each direction

// A plane of complex values, large enough that lags of half the surface do not wrap.
struct Padded {
  std::int32_t width = 1, height = 1;
  std::vector<std::complex<double>> values;

  [[nodiscard]] std::complex<double>& at(std::int32_t column, std::int32_t row) noexcept {
    return values[static_cast<std::size_t>(row) * static_cast<std::size_t>(width) +
                  static_cast<std::size_t>(column)];
  }
};

std::pair<std::int32_t, std::int32_t> paddedSize(const Surface& surface) noexcept {
  return {transformLength(surface.width + surface.width / 2),
          transformLength(surface.height + surface.height / 2)};
}

template <class F>
void forEachRow(std::int32_t rows, JobControl& job, const F& f) {
  tbb::parallel_for(tbb::blocked_range<std::int32_t>(0, rows), [&](const auto& range) {
    for (std::int32_t r = range.begin(); r < range.end() && !job.cancelled(); ++r) f(r);
  });
}

// Heights over their deviation as real parts, 1 for a sample as imaginary ones: one transform for both.
void fill(Padded& plane, const Surface& surface, double deviation, JobControl& job) {
  forEachRow(surface.height, job, [&](std::int32_t r) {
    for (std::int32_t c = 0; c < surface.width; ++c) {
      const double z = surface.at(c, r);
      if (!std::isnan(z)) plane.at(c, r) = {z / deviation, 1.0};
    }
  });
}

// Of the transform F of z + i m: |Z|^2 + i |M|^2, with Z = (F(k) + F*(-k)) / 2 and i M = (F(k) - F*(-k)) / 2.
void toPowers(Padded& plane, JobControl& job) {
  const auto power = [](std::complex<double> here, std::complex<double> there) {
    const std::complex<double> z = 0.5 * (here + std::conj(there)), m = 0.5 * (here - std::conj(there));
    return std::complex<double>(std::norm(z), std::norm(m));
  };
  // A row with its mirror, each pair once.
  forEachRow(plane.height / 2 + 1, job, [&](std::int32_t r) {
    const std::int32_t mirror = (plane.height - r) % plane.height;
    const std::int32_t last = r == mirror ? plane.width / 2 : plane.width - 1;
    for (std::int32_t c = 0; c <= last; ++c) {
      const std::int32_t other = (plane.width - c) % plane.width;
      std::complex<double>& here = plane.at(c, r);
      std::complex<double>& there = plane.at(other, mirror);
      here = there = power(here, there);
    }
  });
}

// That of the largest power of toPowers(); none where all have none.
WavesOver strongestWave(Padded& plane, const Surface& surface) noexcept {
  const double columns = static_cast<double>(surface.width) / plane.width,
               rows = static_cast<double>(surface.height) / plane.height;
  WavesOver strongest;
  double most = 0.0;
  // Those of a half plane; the others are the same waves.
  for (std::int32_t r = 0; r <= plane.height / 2; ++r)
    for (std::int32_t c = 0; c < plane.width; ++c) {
      const double power = plane.at(c, r).real();
      if (!(power > most) || (c == 0 && r == 0)) continue;  // the mean is no wave
      most = power;
      strongest = {(2 * c > plane.width ? c - plane.width : c) * columns, r * rows};
    }
  return strongest;
}

void setDominantWave(SpatialParameters& of, const Surface& surface, const WavesOver& strongest,
                     JobControl& job) {
  constexpr double kRounding = 1e-6;
  const WavesOver wave = nearestWave(surface, strongest, job);
  if (std::hypot(wave.columns, wave.rows) < 1.0 - kRounding) {
    of.ssw = kNone;
    of.no_ssw = "its largest wave is longer than the surface";
    return;
  }
  of.ssw = 1.0 / std::hypot(wave.columns / (surface.width * surface.spacing_x),
                            wave.rows / (surface.height * surface.spacing_y));
}

double meanSquare(const Surface& surface) noexcept {
  CompensatedSum sum;
  for (const float z : surface.heights)
    if (!std::isnan(z)) sum.add(static_cast<double>(z) * z);
  return sum.value() / static_cast<double>(surface.samples);
}

Autocorrelation correlationOf(Padded& plane, const Surface& surface, JobControl& job) {
  Autocorrelation result;
  result.lags_x = surface.width / 2;
  result.lags_y = surface.height / 2;
  result.spacing_x = surface.spacing_x;
  result.spacing_y = surface.spacing_y;
  result.values.assign(result.columns() * (static_cast<std::size_t>(result.lags_y) + 1), kNone);
  const double scale = 1.0 / (static_cast<double>(plane.width) * plane.height);
  const double least = std::max(1.0, static_cast<double>(surface.samples) / 16.0);
  const double whole = plane.at(0, 0).real() / plane.at(0, 0).imag();
  forEachRow(result.lags_y + 1, job, [&](std::int32_t ty) {
    for (std::int32_t tx = -result.lags_x; tx <= result.lags_x; ++tx) {
      const std::complex<double> sums = plane.at((tx + plane.width) % plane.width, ty) * scale;
      const double pairs = std::round(sums.imag());
      if (pairs < least) continue;
      result.values[static_cast<std::size_t>(ty) * result.columns() +
                    static_cast<std::size_t>(tx + result.lags_x)] = sums.real() / pairs / whole;
    }
  });
  return result;
}

// Power over directions, from the tapered correlation in the same plane.
AngularSpectrum spectrumOf(Padded& plane, const Autocorrelation& correlation, JobControl& job) {
  std::fill(plane.values.begin(), plane.values.end(), std::complex<double>());
  const auto taper = [](std::int32_t lag, std::int32_t most) {
    return 0.5 + 0.5 * std::cos(pi * lag / (most + 1.0));
  };
  for (std::int32_t ty = -correlation.lags_y; ty <= correlation.lags_y; ++ty)
    for (std::int32_t tx = -correlation.lags_x; tx <= correlation.lags_x; ++tx) {
      const double value = correlation.at(tx, ty);
      if (!std::isnan(value))
        plane.at((tx + plane.width) % plane.width, (ty + plane.height) % plane.height) =
            value * taper(tx, correlation.lags_x) * taper(ty, correlation.lags_y);
    }
  transformPlane(plane.values, plane.width, plane.height, Transform::kForward, job);
  AngularSpectrum spectrum;
  spectrum.power.assign(AngularSpectrum::kBins, 0.0);
  spectrum.white.assign(AngularSpectrum::kBins, 0.0);
  if (job.cancelled()) return spectrum;
  // The power at a frequency in lines of the transform, bilinear between them: the taper makes each peak some lines wide.
  const auto line = [&](std::int32_t c, std::int32_t r) {
    return plane
        .at((c % plane.width + plane.width) % plane.width, (r % plane.height + plane.height) % plane.height)
        .real();
  };
  const auto power = [&](double x, double y) {
    const double left = std::floor(x), low = std::floor(y), u = x - left, v = y - low;
    const auto c = static_cast<std::int32_t>(left), r = static_cast<std::int32_t>(low);
    // Negative ones are what the estimate of an unbiased correlation leaves of nothing.
    return std::max(0.0, (1.0 - v) * ((1.0 - u) * line(c, r) + u * line(c + 1, r)) +
                             v * ((1.0 - u) * line(c, r + 1) + u * line(c + 1, r + 1)));
  };
  // Lines per wave per millimetre.
  const double lines_x = plane.width * correlation.spacing_x, lines_y = plane.height * correlation.spacing_y;
  const double high = 0.5 / std::max(correlation.spacing_x, correlation.spacing_y);
  const double low_x = 0.75 / (correlation.lags_x * correlation.spacing_x);
  const double low_y = 0.75 / (correlation.lags_y * correlation.spacing_y);
  const double step = 0.5 / std::max(lines_x, lines_y);
  double sum = 0.0;
  for (int bin = 0; bin < AngularSpectrum::kBins; ++bin) {
    const double angle = pi * bin / AngularSpectrum::kBins, cosine = std::cos(angle), sine = std::sin(angle);
    const double low = 1.0 / std::hypot(cosine / low_x, sine / low_y);
    double total = 0.0, of_white = 0.0;
    const auto steps = static_cast<std::int64_t>((high - low) / step);
    for (std::int64_t i = 0; i <= steps && low <= high; ++i) {
      const double f = low + static_cast<double>(i) * step;
      total += f * power(f * cosine * lines_x, f * sine * lines_y);
      of_white += f;  // its autocorrelation is 1 without a lag, else 0
    }
    spectrum.power[static_cast<std::size_t>(bin)] = total;
    spectrum.white[static_cast<std::size_t>(bin)] = of_white;
    sum += total;
  }
  if (sum > 0.0)
    for (std::vector<double>* const parts : {&spectrum.power, &spectrum.white})
      for (double& part : *parts) part /= sum;
  return spectrum;
}

// The direction of its largest peak [degrees], without white noise that has `noise` of the mean square: the mean of what is above half of the
// peak's height, so that noise of single directions has little part in it.
double strongestDirection(const AngularSpectrum& spectrum, double noise) noexcept {
  constexpr int kBins = AngularSpectrum::kBins;
  const auto at = [&](int bin) {
    const auto i = static_cast<std::size_t>((bin + kBins) % kBins);
    return std::max(0.0, spectrum.power[i] - noise * spectrum.white[i]);
  };
  int best = 0;
  for (int bin = 1; bin < kBins; ++bin)
    if (at(bin) > at(best)) best = bin;
  const double half = 0.5 * at(best);
  double sum = at(best) - half, moment = 0.0;
  for (const int way : {-1, 1})
    for (int off = 1; off < kBins / 4 && at(best + way * off) > half; ++off) {
      const double part = at(best + way * off) - half;
      sum += part;
      moment += way * off * part;
    }
  return sum > 0.0 ? (best + moment / sum) * 180.0 / kBins : kNone;
}

double halfTurn(double degrees) noexcept {
  const double within = std::fmod(degrees, 180.0), turned = within < 0.0 ? within + 180.0 : within;
  return turned < 180.0 ? turned : 0.0;  // of a rounding below 0 the sum is 180
}

// Of the lay, across which the strongest waves go.
double layOf(const AngularSpectrum& spectrum, double noise) noexcept {
  const double direction = strongestDirection(spectrum, noise);
  return std::isnan(direction) ? kNone : halfTurn(direction - 90.0);
}

struct Extreme {
  double angle = 0.0, distance = 0.0;
};

// The angle of the shortest (sign +1) or longest (-1) decay: the best of 1440 directions, then between its neighbours.
Extreme extremeDecay(const Autocorrelation& correlation, double sign) noexcept {
  constexpr int kAngles = 1440;
  const auto decay = [&](double angle) { return sign * correlation.decay(angle, kDecayLevel); };
  Extreme best{0.0, decay(0.0)};
  for (int i = 1; i < kAngles; ++i) {
    const double angle = pi * i / kAngles, distance = decay(angle);
    if (distance < best.distance) best = {angle, distance};
  }
  // Golden section: J. Kiefer, Sequential minimax search for a maximum, 1953.
  constexpr double kGolden = 0.6180339887498949;
  double low = best.angle - pi / kAngles, high = best.angle + pi / kAngles;
  for (int i = 0; i < 40; ++i) {
    const double left = high - kGolden * (high - low), right = low + kGolden * (high - low);
    const double at_left = decay(left), at_right = decay(right);
    if (at_left < best.distance) best = {left, at_left};
    if (at_right < best.distance) best = {right, at_right};
    (at_left < at_right ? high : low) = at_left < at_right ? right : left;
  }
  best.distance *= sign;
  return best;
}

SpatialParameters without(const std::string& why) {
  SpatialParameters none{kNone, kNone, kNone, kNone, kNone, kNone, why, why, why, why};
  none.lay_less.fill(kNone);
  return none;
}

// At a lag that is no whole number.
double betweenLags(const Autocorrelation& correlation, double x, double y) noexcept {
  const auto column = static_cast<std::int32_t>(std::floor(x)),
             row = static_cast<std::int32_t>(std::floor(y));
  const double u = x - column, v = y - row;
  // A corner that has no part in it may lie outside, or be no number.
  const auto corner = [&](std::int32_t c, std::int32_t r, double part) {
    if (part == 0.0) return 0.0;
    if (std::abs(c) > correlation.lags_x || std::abs(r) > correlation.lags_y) return kNone;
    return part * correlation.at(c, r);
  };
  return corner(column, row, (1.0 - u) * (1.0 - v)) + corner(column + 1, row, u * (1.0 - v)) +
         corner(column, row + 1, (1.0 - u) * v) + corner(column + 1, row + 1, u * v);
}

// Str to 2 %, by directions half a degree apart; NaN where it is none.
double roughAspect(const Autocorrelation& correlation, double level) noexcept {
  constexpr int kAngles = 360;
  double fast = std::numeric_limits<double>::infinity(), slow = 0.0;
  for (int i = 0; i < kAngles; ++i) {
    const double distance = correlation.decay(pi * i / kAngles, level);
    fast = std::min(fast, distance);
    slow = std::max(slow, distance);
  }
  return std::isinf(slow) ? kNone : fast / slow;
}

SpatialParameters parametersOf(const Autocorrelation& correlation, const AngularSpectrum& spectrum) {
  SpatialParameters result;
  const Extreme fast = extremeDecay(correlation, 1.0);
  if (std::isinf(fast.distance)) {
    result.sal = result.str = result.sal_direction = result.slow_direction = kNone;
    result.no_sal = result.no_str =
        "the autocorrelation falls to 0.2 in no direction within half of the surface";
  } else {
    result.sal = fast.distance;
    result.sal_direction = halfTurn(fast.angle * 180.0 / pi);
    const Extreme slow = extremeDecay(correlation, -1.0);
    result.slow_direction = halfTurn(slow.angle * 180.0 / pi);
    result.str = std::isinf(slow.distance) ? kNone : fast.distance / slow.distance;
    if (std::isnan(result.str))
      result.no_str =
          fmt::format("along {:.0f} degrees the autocorrelation stays above 0.2 within half of the surface",
                      result.slow_direction);
    const double rough = roughAspect(correlation, kDecayLevel);
    for (std::size_t k = 0; k < result.str_lowered.size(); ++k)
      result.str_lowered[k] =
          roughAspect(correlation, kDecayLevel * (1.0 - SpatialParameters::kLowered[k])) / rough;
  }
  result.lay = layOf(spectrum, 0.0);
  if (std::isnan(result.lay)) result.no_lay = "the surface has no wave shorter than two thirds of it";
  for (std::size_t k = 0; k < result.lay_less.size(); ++k)
    result.lay_less[k] = layOf(spectrum, static_cast<double>(k) / SpatialParameters::kLayParts);
  return result;
}

}  // namespace

double Autocorrelation::valueAt(double x_mm, double y_mm) const noexcept {
  return betweenLags(*this, x_mm / spacing_x, y_mm / spacing_y);
}

double Autocorrelation::decay(double angle, double level) const noexcept {
  // In lags per millimetre.
  const double dx = std::cos(angle) / spacing_x, dy = std::sin(angle) / spacing_y;
  const auto value = [&](double x, double y) { return betweenLags(*this, x, y); };
  constexpr double kFar = std::numeric_limits<double>::infinity();
  // From one line of lags to the next; in between the function is a quadratic, given by its ends and its middle.
  double here = 0.0, value_here = 1.0;
  double next_x = dx != 0.0 ? 1.0 / std::abs(dx) : kFar, next_y = dy != 0.0 ? 1.0 / std::abs(dy) : kFar;
  std::int32_t lines_x = 1, lines_y = 1;
  for (;;) {
    const double there = std::min(next_x, next_y);
    // On a line the lag is a whole number, exactly.
    const auto lagAt = [&](double distance, double step, double next, std::int32_t lines) {
      return next == distance ? std::copysign(static_cast<double>(lines), step) : distance * step;
    };
    const double x = lagAt(there, dx, next_x, lines_x), y = lagAt(there, dy, next_y, lines_y);
    if (std::abs(x) > lags_x || std::abs(y) > lags_y) return kFar;
    const double middle = 0.5 * (here + there);
    const double value_middle = value(middle * dx, middle * dy), value_there = value(x, y);
    if (std::isnan(value_middle) || std::isnan(value_there)) return kFar;
    // a t^2 + b t + c over t from 0 to 1, less the level.
    const double c = value_here - level, b = 4.0 * value_middle - 3.0 * value_here - value_there;
    const double a = 2.0 * (value_here + value_there) - 4.0 * value_middle;
    const double lowest = a > 0.0 && b < 0.0 && -b < 2.0 * a ? c - b * b / (4.0 * a) : value_there - level;
    if (lowest <= 0.0 || value_there <= level) {
      // The first root without cancellation: b < 0 or a < 0 there.
      const double root = std::sqrt(std::max(0.0, b * b - 4.0 * a * c));
      const double t = b <= 0.0 ? 2.0 * c / (root - b) : (-b - root) / (2.0 * a);
      return here + std::clamp(t, 0.0, 1.0) * (there - here);
    }
    here = there;
    value_here = value_there;
    if (next_x == there) next_x = ++lines_x / std::abs(dx);
    if (next_y == there) next_y = ++lines_y / std::abs(dy);
  }
}

double SpatialParameters::layWithout(double share) const noexcept {
  const double place = std::clamp(share, 0.0, 1.0) * kLayParts;
  const auto k = std::min(static_cast<std::size_t>(place), lay_less.size() - 1),
             next = std::min(k + 1, lay_less.size() - 1);
  // 0 and 180 are one.
  const double step = lay_less[next] - lay_less[k], turn = step - 180.0 * std::round(step / 180.0);
  return halfTurn(lay_less[k] + (place - static_cast<double>(k)) * turn);
}

double SpatialParameters::strWithout(double share) const noexcept {
  double low = 0.0, at_low = 1.0;
  for (std::size_t k = 0; k < kLowered.size(); ++k) {
    if (share <= kLowered[k])
      return str * (at_low + (str_lowered[k] - at_low) * (share - low) / (kLowered[k] - low));
    low = kLowered[k];
    at_low = str_lowered[k];
  }
  return str * at_low;
}

double correlationBytes(const Surface& surface) noexcept {
  const auto [width, height] = paddedSize(surface);
  return 16.0 * width * height + 4.0 * surface.width * surface.height;
}

Result<SpatialAnalysis> correlate(const Surface& surface, JobControl& job) {
  SpatialAnalysis result;
  result.spectrum.power.assign(AngularSpectrum::kBins, 0.0);
  if (std::min(surface.width, surface.height) < kLeastSide) {
    result.parameters = without(fmt::format("fewer than {} columns or rows of samples", kLeastSide));
    return result;
  }
  const double deviation = std::sqrt(meanSquare(surface));
  if (!(deviation > 0.0)) {
    result.parameters = without("the surface is flat");
    return result;
  }
  job.begin("correlating", 6);
  Padded plane;
  const auto size = paddedSize(surface);
  plane.width = size.first;
  plane.height = size.second;
  plane.values.resize(static_cast<std::size_t>(plane.width) * static_cast<std::size_t>(plane.height));
  fill(plane, surface, deviation, job);
  job.advance();
  transformPlane(plane.values, plane.width, plane.height, Transform::kForward, job, surface.height);
  job.advance();
  if (job.cancelled()) return cancelled();
  toPowers(plane, job);
  if (job.cancelled()) return cancelled();
  const WavesOver strongest = strongestWave(plane, surface);
  transformPlane(plane.values, plane.width, plane.height, Transform::kBackward, job);
  job.advance();
  if (job.cancelled()) return cancelled();
  result.correlation = correlationOf(plane, surface, job);
  job.advance();
  result.spectrum = spectrumOf(plane, result.correlation, job);
  job.advance();
  if (job.cancelled()) return cancelled();
  result.parameters = parametersOf(result.correlation, result.spectrum);
  setDominantWave(result.parameters, surface, strongest, job);
  job.advance();
  if (job.cancelled()) return cancelled();
  return result;
}

}  // namespace fettle::engine
