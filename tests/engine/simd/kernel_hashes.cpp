// Prints a hash of what each kernel that is compiled for several processors makes of hard fields, with the
// kernels that FETTLE_CPU allows. No line may depend on the processor or the compiler.

#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "engine/field/builder.h"
#include "engine/filter/catalogue.h"
#include "engine/marks/edge_response.h"
#include "haptic/contact/sphere_contact_lanes.h"
#include "render/detail/detail_tile.h"
#include "render/plan/value_range.h"

namespace fettle {
namespace {

// FNV-1a over the bits of numbers, all NaN being one.
class Hash {
 public:
  template <class T>
  void add(const T* values, std::size_t count) {
    for (std::size_t i = 0; i < count; ++i) {
      const T value = values[i] == values[i] ? values[i] : std::numeric_limits<T>::quiet_NaN();
      unsigned char bytes[sizeof(T)];
      std::memcpy(bytes, &value, sizeof value);
      for (const unsigned char byte : bytes) hash_ = (hash_ ^ byte) * 0x100000001b3U;
    }
  }
  template <class T>
  void add(const std::vector<T>& values) {
    add(values.data(), values.size());
  }
  void print(const std::string& name) const { std::printf("%-28s %016llx\n", name.c_str(), hash_); }

 private:
  unsigned long long hash_ = 0xcbf29ce484222325U;
};

/// Reproducible on every machine, unlike the standard library's distributions. In [-1, 1).
class Noise {
 public:
  double operator()() noexcept {
    state_ = state_ * 6364136223846793005U + 1442695040888963407U;
    return static_cast<double>(static_cast<std::int64_t>(state_) >> 11) * 0x1p-52;
  }

 private:
  std::uint64_t state_ = 7;
};

constexpr int kWidth = 270, kHeight = 210;  // some tiles, the last ones cut, and two with no border near

struct Case {
  const char* name;
  engine::Version field;
};

// Steps and noise; with holes and marks; with magnitudes that need two lanes of exact sums, and all of them.
std::vector<Case> cases() {
  struct Kind {
    const char* name;
    bool holes, marks;
    int spread;  // powers of two that magnitudes range over
  };
  std::vector<Case> all;
  Noise noise;
  for (const Kind& kind :
       {Kind{"plain", false, false, 0}, Kind{"holed", true, true, 0}, Kind{"wide", false, false, 20},
        Kind{"wide holed", true, true, 20}, Kind{"widest", true, false, 100}}) {
    std::vector<float> z;
    std::vector<std::uint8_t> marks;
    for (int i = 0; i < kWidth * kHeight; ++i) {
      const int c = i % kWidth, r = i / kWidth;
      const double height = 0.01 * c + (c / 40 % 2 + r / 30 % 2) * 2.0 + 0.3 * noise();
      const int scale = kind.spread == 0 ? 0 : static_cast<int>(noise() * kind.spread);
      const bool hole = kind.holes && noise() > 0.95;
      z.push_back(hole ? std::nanf("") : static_cast<float>(std::ldexp(height, scale)));
      marks.push_back(kind.marks && noise() > 0.8 ? 1 : 0);
    }
    engine::Grid grid;
    grid.width = kWidth;
    grid.height = kHeight;
    all.push_back({kind.name, engine::makeField(grid, z, marks)});
  }
  return all;
}

bool filters(const Case& each) {
  for (const engine::Filter& filter : engine::filters())
    for (const int window : {3, 5, 7, 9, 11, 31}) {
      if (!filter.window.exists() && window != engine::FilterSpec{}.window) continue;
      engine::FilterSpec spec;
      spec.kind = filter.kind;
      spec.window = window;
      spec.passes = window == 5 ? 2 : 1;
      spec.sigma = filter.sigma.exists() && window == 7 ? 2.5 : 0.0;
      if (filter.range_sigma.exists()) spec.range_sigma = 0.25;
      spec.nesting_mm = 1.6 * engine::usualNesting(filter, each.field.grid());
      engine::JobControl job;
      const auto done = engine::applyFilter(each.field, each.field, spec, job);
      if (!done) {
        std::fprintf(stderr, "%s\n", done.error().line().c_str());
        return false;
      }
      std::vector<float> z(kWidth * kHeight);
      done->field.reader().readHeights(0, 0, kWidth, kHeight, z.data(), kWidth);
      Hash hash;
      hash.add(z);
      const double report[] = {static_cast<double>(done->report.changed), done->report.max_change,
                               done->report.rms_change};
      hash.add(report, 3);
      hash.print(std::string(filter.word) + " " + std::to_string(window) + " " + each.name);
    }
  return true;
}

void edges(const Case& each) {
  engine::EdgeResponse response(1.5, engine::EdgeResponse::Scatter::kMeasure);
  const engine::JobControl job;
  if (!response.run(each.field.reader(), 0, 0, kWidth, kHeight, job)) return;
  Hash hash;
  for (const std::vector<float>* values :
       {&response.step, &response.crease, &response.step_x, &response.step_y, &response.crease_x,
        &response.crease_y, &response.step_in_x, &response.bend_in_y})
    hash.add(*values);
  hash.print(std::string("edges ") + each.name);
}

void detail(const Case& each) {
  std::vector<float> z(render::kTileRows * render::kTileStride, std::nanf(""));
  each.field.reader().readHeights(64, 0, render::kTileRows, render::kTileRows, z.data(), render::kTileStride);
  render::TileExtremes extremes;
  const glm::ivec2 cells{engine::kTileSide, engine::kTileSide - 5};
  extremes.ofSamples(z.data(), cells);
  Hash hash;
  for (int level = 1; level <= 6; ++level) {
    if (level > 1) extremes.coarsen();
    const int side = (engine::kTileSide >> level) + 1;
    std::vector<float> vertices;
    for (int r = 0; r < side; ++r)
      for (int c = 0; c < side; ++c) {
        const float height = z[static_cast<std::size_t>((r << level) * render::kTileStride + (c << level))];
        vertices.push_back(height == height ? height : render::kMissingVertex);
      }
    render::DetailMeasure::Error errors[32 * 32] = {};
    render::measureTileLevel(z.data(), cells, level, vertices.data(), extremes, 2, 32, errors);
    for (const render::DetailMeasure::Error& error : errors) {
      const float numbers[] = {error.deviation, error.excess};
      hash.add(numbers, 2);
    }
  }
  hash.print(std::string("detail ") + each.name);
}

void values(const Case& each, const Case& other) {
  const render::ValueSpan span = render::deviationSpan(each.field, other.field.inverted());
  const double numbers[] = {span.extreme.low, span.extreme.high, span.robust.low, span.robust.high};
  Hash hash;
  hash.add(numbers, 4);
  hash.print(std::string("values ") + each.name);
}

void touches() {
  constexpr int kSide = 40;
  Noise noise;
  std::vector<double> z(kSide * kSide + haptic::kSphereContactLanes);
  for (double& height : z) height = noise();
  const haptic::LaneWindow window{z.data(), kSide, 3, 5, 1.0, 0.6};
  const haptic::SphereContactKernels& kernels = haptic::sphereContactKernels();
  // The cells at the rim, which prepare() leaves out, are not searched below.
  const auto bounds = std::make_unique<haptic::LaneBounds>();
  kernels.prepare(window, kSide, 0.0, *bounds);
  Hash hash;
  for (int i = 0; i < 400; ++i) {
    const double reach = i % 3 == 0 ? 6.0 : 1.5;
    const haptic::LaneProbe ball{3.0 + 20.0 + 8.0 * noise(),
                                 0.6 * (5.0 + 20.0 + 8.0 * noise()),
                                 1.2 * reach * (0.5 + 0.5 * noise()),
                                 reach,
                                 reach * reach,
                                 1e-12,
                                 1e-12};
    std::array<haptic::LaneCell, 30 * 30 + haptic::kSphereContactLanes> cells;
    const int count = kernels.reached(window, *bounds, ball, 4, 33, 4, 33, cells.data());
    for (int at = 0; at < count; at += haptic::kSphereContactLanes) {
      haptic::LaneFinds finds;
      kernels.find(window, ball, cells.data() + at, std::min(count - at, haptic::kSphereContactLanes), finds);
      for (const haptic::LaneContacts* kind : {&finds.sample, &finds.edge_x, &finds.edge_y, &finds.inside})
        for (int lane = 0; lane < haptic::kSphereContactLanes; ++lane) {
          if ((kind->found >> lane & 1U) == 0) continue;
          const auto k = static_cast<std::size_t>(lane);
          const double numbers[] = {static_cast<double>(at + lane), kind->mx[k], kind->my[k], kind->mz[k],
                                    kind->d2[k]};
          hash.add(numbers, 5);
          if (kind == &finds.edge_x || kind == &finds.inside) hash.add(&kind->u[k], 1);
          if (kind == &finds.edge_y || kind == &finds.inside) hash.add(&kind->v[k], 1);
        }
    }
    const haptic::LaneValley valley{noise(), noise(), noise(), noise(), noise(), noise(), 1.0, 0.6};
    double v[haptic::kSphereContactLanes], slopes[2][haptic::kSphereContactLanes];
    for (double& at : v) at = 0.5 + 0.5 * noise();
    kernels.steepSlopes(valley, v, slopes[0], slopes[1]);
    const double rises = kernels.rises(valley);
    hash.add(&rises, 1);
    hash.add(slopes[0], haptic::kSphereContactLanes);
    hash.add(slopes[1], haptic::kSphereContactLanes);
  }
  hash.print("touches");
}

}  // namespace
}  // namespace fettle

int main() {
  const std::vector<fettle::Case> cases = fettle::cases();
  for (const fettle::Case& each : cases) {
    if (!fettle::filters(each)) return 1;
    fettle::edges(each);
    fettle::detail(each);
    fettle::values(each, cases.front());
  }
  fettle::touches();
  return 0;
}
