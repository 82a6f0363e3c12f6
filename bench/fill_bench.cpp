#include "bench/fill_bench.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <functional>
#include <limits>
#include <utility>

#include "bench/machine.h"
#include "bench/repeats.h"
#include "engine/field/builder.h"
#include "engine/fill/fill.h"

namespace fettle::bench {

namespace {

// A number that looks random, of a place.
std::uint32_t mixed(std::int32_t c, std::int32_t r) {
  std::uint32_t h = static_cast<std::uint32_t>(c) * 0x9E3779B1U ^ static_cast<std::uint32_t>(r) * 0x85EBCA77U;
  h = (h ^ (h >> 15)) * 0x2C1B3C6DU;
  h = (h ^ (h >> 12)) * 0x297A2D39U;
  return h ^ (h >> 15);
}

struct HoleKind {
  const char* name;
  bool (*isHole)(std::int32_t c, std::int32_t r, std::int32_t side);
};

constexpr HoleKind kHoleKinds[] = {
    {"single", [](std::int32_t c, std::int32_t r, std::int32_t) { return mixed(c, r) % 20 == 0; }},
    {"discs",
     [](std::int32_t c, std::int32_t r, std::int32_t) {
       constexpr std::int32_t kCell = 32;
       const auto radius = static_cast<std::int32_t>(2 + mixed(c / kCell, r / kCell) % 5);
       const std::int32_t x = c % kCell - kCell / 2, y = r % kCell - kCell / 2;
       return x * x + y * y <= radius * radius;
     }},
    {"scratches",
     [](std::int32_t c, std::int32_t r, std::int32_t side) {
       // Slanted by one in eight, 256 apart, with ends.
       return (r + c / 8) % 256 < 3 && c > 4 && c < side - 5 && r > 4 && r < side - 5;
     }},
    {"one large",
     [](std::int32_t c, std::int32_t r, std::int32_t side) {
       const std::int64_t x = c - side / 2, y = r - side / 2;
       return x * x + y * y <= 19100;  // times pi: 60,000
     }},
};

engine::Result<engine::Version> holed(std::int32_t side, const HoleKind& kind) {
  engine::Grid grid;
  grid.width = grid.height = side;
  grid.spacing_x = grid.spacing_y = kSpacingMm;
  auto builder = engine::FieldBuilder::create(grid, "the field");
  if (!builder) return tl::unexpected(builder.error());
  std::vector<float> row(static_cast<std::size_t>(side));
  for (std::int32_t r = 0; r < side; ++r) {
    const double along = std::cos(r * 0.013);
    for (std::int32_t c = 0; c < side; ++c)
      row[static_cast<std::size_t>(c)] = kind.isHole(c, r, side)
                                             ? std::numeric_limits<float>::quiet_NaN()
                                             : static_cast<float>(std::sin(c * 0.01) + along);
    builder->writeHeights(0, r, side, 1, row.data(), side);
  }
  return std::move(*builder).build();
}

}  // namespace

engine::Result<FillBenchReport> benchFill(const FillBenchOptions& options, engine::JobControl& job) {
  if (options.side < 512 || options.side > 32768 || options.repeats < 1 || options.repeats > 100)
    return engine::inputError("these options cannot be measured", "bench fill", "give 512 to 32768 samples");
  FillBenchReport report;
  report.machine = machine();
  report.samples = std::int64_t{options.side} * options.side;
  std::vector<float> copy(static_cast<std::size_t>(report.samples));
  for (const HoleKind& kind : kHoleKinds) {
    const auto field = holed(options.side, kind);
    if (!field) return tl::unexpected(field.error());
    for (const auto& [method, name] : {std::pair{engine::FillMethod::kMembrane, "membrane"},
                                       {engine::FillMethod::kCurvature, "curvature"}}) {
      FillBenchRow row;
      row.holes = kind.name;
      row.method = name;
      engine::FillOptions fill;
      fill.method = method;
      std::vector<double> plain, seconds;
      for (int k = 0; k < options.repeats; ++k) {
        plain.push_back(secondsOf([&] {
          field->reader().readHeights(0, 0, options.side, options.side, copy.data(), options.side);
        }));
        engine::Result<engine::Filled> filled;
        seconds.push_back(secondsOf([&] { filled = engine::fillHoles(*field, fill, job); }));
        if (!filled) return tl::unexpected(filled.error());
        const std::uint64_t hash = engine::contentHash(filled->field);
        if (k > 0 && hash != row.hash) return engine::failure("two repeats differ", "bench fill");
        row.hash = hash;
        row.count = filled->filled_holes;
        row.filled = filled->filled;
      }
      row.plain = median(plain);
      row.median = median(seconds);
      row.fastest = *std::ranges::min_element(seconds);
      row.slowest = *std::ranges::max_element(seconds);
      report.rows.push_back(std::move(row));
    }
  }
  return report;
}

}  // namespace fettle::bench
