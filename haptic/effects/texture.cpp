#include "haptic/effects/texture.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>

#include <glm/geometric.hpp>

namespace fettle::haptic {

namespace {

constexpr int kSide = TextureTable::kSide;
constexpr int kWaves = 64;

// A plane wave: cycles in the period along x and y, phase in steps of a kSide-th of a turn.
struct Wave {
  int x = 0, y = 0;
  std::uint32_t phase = 0;
};

// Sebastiano Vigna's splitmix64 (2014): a fixed sequence, the same everywhere.
std::uint64_t nextRandom(std::uint64_t& state) noexcept {
  std::uint64_t z = (state += 0x9e3779b97f4a7c15ULL);
  z = (z ^ (z >> 30U)) * 0xbf58476d1ce4e5b9ULL;
  z = (z ^ (z >> 27U)) * 0x94d049bb133111ebULL;
  return z ^ (z >> 31U);
}

std::vector<Wave> wavesOf(TexturePattern pattern) {
  if (pattern == TexturePattern::kGrating) return {{TextureTable::kCyclesMost, 0, 0}};
  std::vector<Wave> waves;
  std::uint64_t seed = 20041;
  constexpr int kMost = TextureTable::kCyclesMost;
  constexpr int kLeast = TextureTable::kCyclesLeast;
  while (waves.size() < kWaves) {
    const std::uint64_t bits = nextRandom(seed);
    const Wave wave{static_cast<int>(bits % (2 * kMost + 1)) - kMost,
                    static_cast<int>((bits >> 8U) % (2 * kMost + 1)) - kMost,
                    static_cast<std::uint32_t>((bits >> 16U) % kSide)};
    const int squared = wave.x * wave.x + wave.y * wave.y;
    if (squared >= kLeast * kLeast && squared <= kMost * kMost) waves.push_back(wave);
  }
  return waves;
}

// Amplitude at the knots of a cubic B-spline whose coefficients are a cosine with `cycles`.
double splineGain(int cycles) noexcept {
  return (2.0 + std::cos(2.0 * std::numbers::pi * cycles / kSide)) / 3.0;
}

// Weights of a uniform cubic B-spline at u in [0, 1) and their derivatives.
struct CubicWeights {
  std::array<double, 4> value, slope;

  explicit CubicWeights(double u) noexcept
      : value{(1 - u) * (1 - u) * (1 - u) / 6, (3 * u * u * u - 6 * u * u + 4) / 6,
              (-3 * u * u * u + 3 * u * u + 3 * u + 1) / 6, u * u * u / 6},
        slope{-(1 - u) * (1 - u) / 2, (3 * u * u - 4 * u) / 2, (-3 * u * u + 2 * u + 1) / 2, u * u / 2} {}
};

}  // namespace

TextureTable::TextureTable(const TextureParams& params)
    : per_mm_(kSide / (kCyclesMost * params.wavelength_mm)),
      half_amplitude_mm_(0.5 * params.amplitude_mm),
      coefficients_(static_cast<std::size_t>(kSide * kSide)) {
  std::array<double, kSide> cosine;
  for (int i = 0; i < kSide; ++i)
    cosine[static_cast<std::size_t>(i)] = std::cos(2.0 * std::numbers::pi * i / kSide);
  const std::vector<Wave> waves = wavesOf(params.pattern);
  std::vector<double> sum(coefficients_.size());
  for (const Wave& wave : waves) {
    const double weight = 1.0 / (splineGain(wave.x) * splineGain(wave.y));
    for (int r = 0; r < kSide; ++r)
      for (int c = 0; c < kSide; ++c)
        sum[static_cast<std::size_t>(r * kSide + c)] +=
            weight * cosine[static_cast<std::size_t>(wave.x * c + wave.y * r + static_cast<int>(wave.phase)) &
                            (kSide - 1)];
  }
  // A spline stays within the range of its coefficients. The grating's peaks lie on knots, where its
  // amplitude is exact.
  double most = 1.0;
  if (params.pattern == TexturePattern::kNoise) {
    most = 0.0;
    for (const double c : sum) most = std::max(most, std::abs(c));
  }
  std::transform(sum.begin(), sum.end(), coefficients_.begin(),
                 [most](double c) { return static_cast<float>(c / most); });
}

TextureTable::Value TextureTable::at(double x_mm, double y_mm) const noexcept {
  const double x = x_mm * per_mm_;
  const double y = y_mm * per_mm_;
  const double column = std::floor(x);
  const double row = std::floor(y);
  const CubicWeights wx(x - column);
  const CubicWeights wy(y - row);
  // Reduced to the period as doubles: a position may be too large for an int.
  const auto within = [](double i) { return static_cast<int>(i - kSide * std::floor(i / kSide)); };
  const int c0 = within(column) - 1 + kSide;
  const int r0 = within(row) - 1 + kSide;
  double value = 0.0, slope_x = 0.0, slope_y = 0.0;
  for (int j = 0; j < 4; ++j) {
    const float* line = coefficients_.data() + ((r0 + j) & (kSide - 1)) * kSide;
    double along = 0.0, along_slope = 0.0;
    for (int i = 0; i < 4; ++i) {
      const auto c = static_cast<double>(line[(c0 + i) & (kSide - 1)]);
      along += wx.value[static_cast<std::size_t>(i)] * c;
      along_slope += wx.slope[static_cast<std::size_t>(i)] * c;
    }
    value += wy.value[static_cast<std::size_t>(j)] * along;
    slope_x += wy.value[static_cast<std::size_t>(j)] * along_slope;
    slope_y += wy.slope[static_cast<std::size_t>(j)] * along;
  }
  return {half_amplitude_mm_ * (value - 1.0), half_amplitude_mm_ * per_mm_ * glm::dvec2(slope_x, slope_y)};
}

namespace {

struct Texture {
  const TextureTable& table;  // EffectList::relief

  static void run(void* data, TickState& state) noexcept {
    const double depth_mm = glm::length(state.contact.penetration_mm);
    if (!(depth_mm > 0.0 && std::isfinite(depth_mm))) return;
    const glm::dvec3& proxy = state.contact.proxy.position_mm;
    const TextureTable::Value relief = static_cast<const Texture*>(data)->table.at(proxy.x, proxy.y);
    const glm::dvec3 normal = state.contact.penetration_mm / depth_mm;
    glm::dvec3 uphill(relief.slope.x, relief.slope.y, 0.0);
    uphill -= normal * glm::dot(uphill, normal);
    const glm::dvec3 press = state.press_n * (std::max(depth_mm + relief.height_mm, 0.0) / depth_mm);
    state.force_n += press - state.press_n - glm::length(press) * uphill;
    state.press_n = press;
  }
};

}  // namespace

const TextureTable& needRelief(EffectList& list, const Scene& scene) {
  if (!list.relief) list.relief = std::make_shared<const TextureTable>(scene.params.texture);
  return *list.relief;
}

void addTexture(EffectList& list, const EffectSource& from) {
  const TextureTable& table = needRelief(list, from.scene);
  Texture& texture = addData(list, EffectKind::kTexture, std::make_shared<Texture>(Texture{table}),
                             sizeof(TextureTable) + table.bytesHeld());
  list.in_contact.push_back({&Texture::run, &texture});
}

}  // namespace fettle::haptic
