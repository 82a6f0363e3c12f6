#include "tests/numeric/support/hard_fields.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>
#include <limits>
#include <stdexcept>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "engine/field/reader.h"
#include "tests/haptic/support/fields.h"

namespace fettle::tests {

namespace {

constexpr int kSide = 24;

// A field takes megabytes of pool, whatever its size: the table holds how to make them.
struct Maker {
  std::string name;
  std::function<engine::Version()> make;
};

template <class F>
Maker of(const char* name, F z, double sx = 1.0, double sy = 1.0) {
  return {name, [=] { return fieldOf(kSide, kSide, z, sx, sy); }};
}

double bump(double x) {
  return 0.8 * std::sin(0.5 * x);
}

// Heights of a stone wall: as random as a fixed formula gets.
double pebble(int c, int r) {
  const std::uint32_t k =
      static_cast<std::uint32_t>(c) * 73856093U ^ static_cast<std::uint32_t>(r) * 19349663U;
  return static_cast<double>((k * 2654435761U) >> 20U) / 4096.0;
}

std::vector<Maker> makers() {
  const double hole = std::numeric_limits<double>::quiet_NaN();
  std::vector<Maker> all;
  all.push_back(of("flat", [](int, int) { return 0.0; }));
  all.push_back(of("tilted", [](int c, int r) { return 0.5 * c - 0.25 * r; }));
  all.push_back(of("waves", [](int c, int r) { return bump(c) * std::cos(0.4 * r); }));
  all.push_back(of("near_vertical_step", [](int c, int) { return c < kSide / 2 ? 0.0 : 1000.0; }));
  all.push_back(of("stairs_of_two_cells", [](int c, int r) { return 3.0 * (c / 4) + 2.0 * (r / 5); }));
  all.push_back(
      of("spikes_1e6_high", [](int c, int r) { return c % 9 == 5 && r % 8 == 5 ? 1e6 : 0.25 * (r % 2); }));
  all.push_back(
      of("saddle", [](int c, int r) { return 0.05 * ((c - 11.5) * (c - 11.5) - (r - 11.5) * (r - 11.5)); }));
  all.push_back(of("twisted_cells", [](int c, int r) { return (c + r) % 2 == 0 ? 1.0 : -1.0; }));
  all.push_back(of("concave_corner",
                   [](int c, int r) { return 0.75 * std::abs(c - 12.0) + 0.5 * std::abs(r - 12.0); }));
  all.push_back(of("duplicate_minima", [](int c, int r) { return c % 4 == 2 && r % 4 == 2 ? -0.5 : 0.0; }));
  all.push_back(of("plateaus", [](int c, int r) { return std::floor(3.0 * pebble(c / 2, r / 2)); }));
  all.push_back(of("ridge_one_sample_wide", [](int c, int) { return c == 12 ? 4.0 : 0.0; }));
  all.push_back(of("diagonal_ridge", [](int c, int r) { return c == r ? 2.0 : 0.0; }));
  all.push_back(of("roof", [](int c, int) { return -0.5 * std::abs(c - 12.0); }));
  all.push_back(of("pyramid_vertex",
                   [](int c, int r) { return -0.5 * std::max(std::abs(c - 12.0), std::abs(r - 12.0)); }));
  all.push_back(
      of("holes", [=](int c, int r) { return (c * 7 + r * 3) % 23 == 0 ? hole : 0.3 * bump(c + r); }));
  all.push_back(of("rim_of_a_large_hole",
                   [=](int c, int r) { return std::hypot(c - 12.0, r - 12.0) < 5.0 ? hole : 0.1 * c; }));
  all.push_back(of("infinities", [](int c, int r) {
    return (c + 2 * r) % 29 == 0 ? HUGE_VAL : ((2 * c + r) % 31 == 0 ? -HUGE_VAL : 0.2 * bump(c));
  }));
  all.push_back(of("denormal_heights", [](int c, int r) { return 0x1p-149 * ((c * 3 + r) % 5); }));
  all.push_back(of(
      "anisotropic_spacing", [](int c, int r) { return 0.2 * bump(c) + 0.3 * pebble(c, r); }, 0.01, 3.0));
  all.push_back(of(
      "scale_1e_minus_6", [](int c, int r) { return 1e-6 * pebble(c, r); }, 1e-6, 1e-6));
  all.push_back(of(
      "scale_1e6", [](int c, int r) { return 1e6 * pebble(c, r); }, 1e6, 1e6));
  all.push_back(of("heights_near_5e6", [](int c, int r) { return 5e6 + 0.5 * ((c * 3 + r * 5) % 4); }));
  all.push_back(of("noise", [](int c, int r) { return 2.0 * pebble(c, r); }));
  all.push_back({"two_by_two", [] { return fieldOf(2, 2, [](int c, int r) { return 1.0 * c * r; }); }});
  all.push_back(
      {"two_rows", [] { return fieldOf(kSide, 2, [](int c, int r) { return bump(c) + 0.5 * r; }); }});
  // Tiles are 64 samples wide: cells that lie across four of them.
  all.push_back(
      {"across_tiles", [] { return fieldOf(72, 70, [](int c, int r) { return 1.5 * pebble(c, r); }); }});
  all.push_back({"upside_down", [] {
                   return fieldOf(kSide, kSide,
                                  [](int c, int r) { return bump(c) * std::cos(0.4 * r) + 0.2 * c; })
                       .inverted();
                 }});
  all.push_back({"origin_5e6_away", [] {
                   engine::Grid grid;
                   grid.width = grid.height = kSide;
                   grid.origin_x = 5e6;
                   grid.origin_y = -5e6;
                   std::vector<float> heights;
                   for (int r = 0; r < kSide; ++r)
                     for (int c = 0; c < kSide; ++c)
                       heights.push_back(static_cast<float>(bump(c) + pebble(c, r)));
                   return engine::makeField(grid, heights);
                 }});
  return all;
}

}  // namespace

HardField asHardField(std::string name, engine::Version field) {
  HardField hard{std::move(name), std::move(field)};
  const engine::Grid& grid = hard.field.grid();
  const engine::FieldReader reader = hard.field.reader();
  const auto z = [&](int c, int r) {
    return static_cast<double>(reader.heightAt(c, r)) * grid.height_unit.mm;
  };
  double along_x = 0.0, along_y = 0.0, highest = 0.0;
  for (int r = 0; r < grid.height; ++r)
    for (int c = 0; c < grid.width; ++c) {
      if (std::isnan(z(c, r))) {
        hard.gaps = true;
        continue;
      }
      highest = std::max(highest, std::abs(z(c, r)));
      // max() gives its first argument where the second is NaN.
      if (c > 0) along_x = std::max(along_x, std::abs(z(c, r) - z(c - 1, r)) / grid.spacingXMm());
      if (r > 0) along_y = std::max(along_y, std::abs(z(c, r) - z(c, r - 1)) / grid.spacingYMm());
    }
  hard.slope = std::hypot(along_x, along_y);
  hard.size_mm = std::max({grid.width * grid.spacingXMm(), grid.height * grid.spacingYMm(), highest});
  return hard;
}

std::vector<std::string> hardFieldNames() {
  std::vector<std::string> names;
  for (const Maker& maker : makers()) names.push_back(maker.name);
  return names;
}

HardField hardField(const std::string& name) {
  for (const Maker& maker : makers())
    if (maker.name == name) return asHardField(name, maker.make());
  throw std::invalid_argument("no hard field " + name);
}

std::string choiceName(Choice choice) {
  constexpr const char* kNames[] = {"paper", "descent", "certified", "sphere"};
  return kNames[static_cast<std::size_t>(choice)];
}

haptic::Scene sceneFor(Choice choice, const engine::Grid& grid) {
  haptic::Scene scene;
  scene.effects = {haptic::EffectKind::kSpring};
  scene.force_limit_n = 1000.0;
  scene.certified_radius_cells = 40;
  if (choice == Choice::kDescent) scene.level = haptic::ContactLevel::kDescent;
  if (choice == Choice::kCertified) scene.level = haptic::ContactLevel::kCertified;
  if (choice == Choice::kSphere) {
    scene.tip = haptic::TipShape::kSphere;
    scene.tip_radius_mm = 1.5 * std::min(grid.spacingXMm(), grid.spacingYMm());
  }
  return scene;
}

long double heightAt(const engine::Version& field, double x_mm, double y_mm) {
  const engine::Grid& grid = field.grid();
  const engine::FieldReader reader = field.reader();
  if (grid.width < 2 || grid.height < 2) return std::numeric_limits<long double>::quiet_NaN();
  const long double x = static_cast<long double>(x_mm) / grid.spacingXMm();
  const long double y = static_cast<long double>(y_mm) / grid.spacingYMm();
  if (!(x >= 0 && y >= 0 && x <= grid.width - 1 && y <= grid.height - 1))
    return std::numeric_limits<long double>::quiet_NaN();
  const int c = std::min(static_cast<int>(x), grid.width - 2);
  const int r = std::min(static_cast<int>(y), grid.height - 2);
  const long double u = x - c;
  const long double v = y - r;
  const auto z = [&](int i, int j) {
    return static_cast<long double>(reader.heightAt(c + i, r + j)) * grid.height_unit.mm;
  };
  return (1 - u) * (1 - v) * z(0, 0) + u * (1 - v) * z(1, 0) + (1 - u) * v * z(0, 1) + u * v * z(1, 1);
}

std::vector<haptic::StrokeSample> wander(const HardField& hard, int ticks, std::uint64_t seed, Jumps jumps) {
  std::mt19937_64 random(seed);
  const engine::Grid& grid = hard.field.grid();
  const double sx = grid.spacingXMm();
  const double sy = grid.spacingYMm();
  const double cell = std::min(sx, sy);
  const double w = (grid.width - 1) * sx;
  const double h = (grid.height - 1) * sy;
  std::vector<haptic::StrokeSample> out;
  glm::dvec3 e{0.0};
  double depth = -2.0;  // below the surface, in cells
  glm::dvec3 way{0.0};
  int left = 0;
  double last_surface = 0.0;
  for (int i = 0; i < ticks; ++i) {
    if (left-- <= 0) {
      left = 5 + static_cast<int>(random() % 40);
      const double sizes[] = {0.0, 1e-9, 1e-3, 0.05, 0.2, 0.5};
      const double size = sizes[random() % 6];
      way =
          size * glm::dvec3(sx * uniform(random, -1, 1), sy * uniform(random, -1, 1), uniform(random, -1, 1));
      if (i == 0 || random() % 12 == 0) {
        // Somewhere else, a little outside the field at times; without jumps that is where it begins.
        if (i == 0 || jumps == Jumps::kYes) {
          e = {uniform(random, -0.05, 1.05) * w, uniform(random, -0.05, 1.05) * h, 0.0};
          depth = uniform(random, -1.0, 3.0);
        }
        // Begins above the low corner, where no field has anything that rises into a ball.
        if (i == 0) {
          e = {0.06 * w, 0.06 * h, 0.0};
          depth = -2.0;
        }
      }
      // Exactly on lines between cells and on samples, where a case of its own begins.
      if (jumps == Jumps::kYes && random() % 5 == 0) e.x = std::round(e.x / sx) * sx;
      if (jumps == Jumps::kYes && random() % 5 == 0) e.y = std::round(e.y / sy) * sy;
    }
    // Outside the field it turns back.
    if (e.x < 0.0 || e.x > w) way.x = std::copysign(way.x, 0.5 * w - e.x);
    if (e.y < 0.0 || e.y > h) way.y = std::copysign(way.y, 0.5 * h - e.y);
    e.x = std::clamp(e.x + way.x, -0.1 * w, 1.1 * w);
    e.y = std::clamp(e.y + way.y, -0.1 * h, 1.1 * h);
    depth = std::clamp(depth + way.z, -2.0, 4.0);
    const auto surface = static_cast<double>(heightAt(hard.field, e.x, e.y));
    // Follows the surface, but at a spike continues straight into it rather than to climb a million.
    if (std::isfinite(surface) && std::abs(surface - last_surface) < 3.0 * cell) last_surface = surface;
    if (i == 0 && std::isfinite(surface)) last_surface = surface;
    out.push_back({0.001 * i, {e.x, e.y, last_surface - depth * cell}, haptic::Tool::kFeel});
  }
  return out;
}

void tellRare(const std::string& name, const haptic::TickCounters& c, const std::string& more) {
  std::string line;
  const auto add = [&](const char* what, std::int64_t n) {
    if (n != 0) line += fmt::format(" {} {}", what, n);
  };
  add("bad_input", c.bad_input);
  add("outside", c.outside);
  add("over_hole", c.over_hole);
  add("force_clamped", c.force_clamped);
  add("lost_cell", c.lost_cell);
  add("side_entries", c.side_entries);
  add("search_bound_hits", c.search_bound_hits);
  add("mean_normal_overruled", c.mean_normal_overruled);
  add("below_without_contact", c.below_without_contact);
  add("longest_search", c.longest_search);
  add("passivity_ticks", c.passivity_ticks);
  std::printf("%s: rare%s%s%s\n", name.c_str(), line.c_str(), more.empty() ? "" : "; ", more.c_str());
  ::testing::Test::RecordProperty("rare", line + (more.empty() ? "" : "; ") + more);
}

}  // namespace fettle::tests
