// Planes in shiftable windows against the formula in long double, and on forms that they must keep.
#include <cmath>
#include <limits>
#include <memory>
#include <random>

#include <gtest/gtest.h>

#include "tests/engine/filter/edge_line_of.h"
#include "tests/engine/filter/reference.h"

namespace fettle::engine::tests {
namespace {

constexpr double kPlanesNoise = 0.02;

Version planesOf(const Version& field, double noise = kPlanesNoise) {
  FilterSpec spec = makeSpec(FilterKind::kPlanes, 3);
  spec.range_sigma = noise;
  return filtered(field, spec).field;
}

PlainField noisy(int width, int height, const std::function<double(int, int)>& z, unsigned seed = 3) {
  std::mt19937 random(seed);
  std::normal_distribution<double> noise(0.0, kPlanesNoise);
  return formed(width, height, [&](int c, int r) { return static_cast<float>(z(c, r) + noise(random)); });
}

// The formula of filter.h; `cuts` may be null.
std::vector<double> planesTwin(const PlainField& field, double noise, const LineCuts* cuts) {
  using Real = long double;
  const int width = field.width, height = field.height;
  std::vector<Real> weights(field.z.size(), 0.0L), sums(field.z.size(), 0.0L);
  const auto at = [width](int c, int r) { return static_cast<std::size_t>(r) * width + c; };
  std::vector<std::uint8_t> links(field.z.size(), 0);
  if (cuts != nullptr)
    for (int r = 0; r < height; ++r)
      for (const LineCut& cut : cuts->row(r)) links[at(cut.column, r)] = cut.links;
  for (const int h : {1, 2, 3, 5})
    for (int r = h; r < height - h; ++r)
      for (int c = h; c < width - h; ++c) {
        Real z = 0, x = 0, y = 0, xx = 0;
        bool whole = true;
        for (int dy = -h; dy <= h; ++dy)
          for (int dx = -h; dx <= h; ++dx) {
            const float v = field.at(c + dx, r + dy);
            whole = whole && !std::isnan(v) &&
                    !(dx < h && (links[at(c + dx, r + dy)] & LineCut::kRight) != 0) &&
                    !(dy < h && (links[at(c + dx, r + dy)] & LineCut::kUp) != 0);
            z += v, x += Real{v} * dx, y += Real{v} * dy, xx += dx * dx;
          }
        if (!whole) continue;
        const Real n = (2 * h + 1) * (2 * h + 1), a = z / n, b = x / xx, d = y / xx;
        Real rest = 0;
        for (int dy = -h; dy <= h; ++dy)
          for (int dx = -h; dx <= h; ++dx) {
            const Real off = field.at(c + dx, r + dy) - (a + b * dx + d * dy);
            rest += off * off;
          }
        if (rest > (n - 3 + 2.5L * std::sqrt(2 * (n - 3))) * noise * noise) continue;
        for (int dy = -h; dy <= h; ++dy)
          for (int dx = -h; dx <= h; ++dx) {
            weights[at(c + dx, r + dy)] += n;
            sums[at(c + dx, r + dy)] += n * (a + b * dx + d * dy);
          }
      }
  std::vector<double> out;
  for (std::size_t i = 0; i < sums.size(); ++i)
    out.push_back(weights[i] > 0 ? static_cast<double>(sums[i] / weights[i]) : double{field.z[i]});
  return out;
}

void expectTwin(const PlainField& field, const Version& got, double noise, const LineCuts* cuts) {
  const std::vector<double> twin = planesTwin(field, noise, cuts);
  const PlainField plain = toPlain(got);
  for (int r = 0; r < field.height; ++r)
    for (int c = 0; c < field.width; ++c) {
      const double want = twin[static_cast<std::size_t>(r) * field.width + c];
      if (std::isnan(want)) {
        ASSERT_TRUE(std::isnan(plain.at(c, r)));
        continue;
      }
      ASSERT_NEAR(plain.at(c, r), want, 0.51 * static_cast<double>(ulp(plain.at(c, r))) + 1e-6 * noise)
          << c << ' ' << r;
    }
}

// A slope, a step, a hill, a hole, spikes; over the border of two squares.
PlainField planesPart(int width, int height) {
  PlainField field = noisy(width, height, [&](int c, int r) {
    double z = 0.01 * std::max(0, r - height / 2) + (c < width / 3 ? 0.3 : 0.0);
    const double d = std::hypot(c - 0.6 * width, r - 0.7 * height) / (0.2 * height);
    return d < 1.0 ? z + 0.5 * (1.0 - d * d) : z;
  });
  for (int r = 3; r < height; r += 11) field.at(width / 2, r) = 1e6F;
  for (int k = 0; k < 5 && k < width && k < height; ++k)
    field.at(k, height / 2) = std::numeric_limits<float>::quiet_NaN();
  return field;
}

TEST(Planes, AreTheFormulaButForRounding) {
  for (const auto& [w, h] : {std::pair{300, 40}, {40, 290}, {11, 11}, {3, 3}, {1, 60}, {60, 2}, {1, 1}}) {
    const PlainField field = planesPart(w, h);
    expectTwin(field, planesOf(toVersion(field)), kPlanesNoise, nullptr);
  }
}

TEST(Planes, WindowsEndAtLines) {
  // A step lower than the noise: without the line windows reach over it.
  const PlainField field = noisy(80, 60, [](int c, int) { return c > 40 ? 0.02 : 0.0; });
  const Version with = toVersion(field).withLines(std::make_shared<const std::vector<EdgeLine>>(
      std::vector{edgeLineOf({{40.5, -3.0}, {40.5, 63.0}}), edgeLineOf({{5.0, 20.2}, {30.0, 33.7}})}));
  expectTwin(field, planesOf(with), kPlanesNoise, with.lineCuts());
  const auto errorNear = [&](const Version& v) {
    double squares = 0.0;
    for (int r = 10; r < 50; ++r)
      for (int c = 38; c < 44; ++c)
        squares += std::pow(double{v.reader().heightAt(c, r)} - (c > 40 ? 0.02 : 0.0), 2);
    return std::sqrt(squares / 240);
  };
  EXPECT_LT(errorNear(planesOf(with)), 0.75 * errorNear(planesOf(toVersion(field))));
}

TEST(Planes, KeepPlanesStepsAndCreasesAndSmoothFlats) {
  const auto tilted = [](int c, int r) { return 0.3 * c - 0.7 * r + 5e3; };
  const PlainField plane = formed(120, 90, [&](int c, int r) { return static_cast<float>(tilted(c, r)); });
  const PlainField same = toPlain(planesOf(toVersion(plane)));
  for (int r = 0; r < 90; ++r)
    for (int c = 0; c < 120; ++c)
      ASSERT_NEAR(same.at(c, r), tilted(c, r), 5e-4) << c << ' ' << r;  // an ulp of 5000
  // Error on a flat and next to a step of 15 noises, of the noise.
  const PlainField step = noisy(200, 150, [](int c, int) { return c > 100 ? 0.3 : 0.0; });
  const PlainField clean = toPlain(planesOf(toVersion(step)));
  double flat = 0.0, near = 0.0;
  int flats = 0, nears = 0;
  for (int r = 15; r < 135; ++r)
    for (int c = 15; c < 185; ++c) {
      const double off = std::pow((double{clean.at(c, r)} - (c > 100 ? 0.3 : 0.0)) / kPlanesNoise, 2);
      const bool is_near = c >= 98 && c <= 103;
      (is_near ? near : flat) += off;
      ++(is_near ? nears : flats);
    }
  EXPECT_LT(std::sqrt(flat / flats), 0.2);
  EXPECT_LT(std::sqrt(near / nears), 0.35);
}

}  // namespace
}  // namespace fettle::engine::tests
