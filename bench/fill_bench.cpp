#include "bench/fill_bench.h"

#include <algorithm>
#include <cstddef>
#include <utility>

#include "bench/holed_field.h"
#include "bench/machine.h"
#include "bench/repeats.h"
#include "engine/fill/fill.h"

namespace fettle::bench {

engine::Result<FillBenchReport> benchFill(const FillBenchOptions& options, engine::JobControl& job) {
  if (options.side < 512 || options.side > 32768 || options.repeats < 1 || options.repeats > 100)
    return engine::inputError("these options cannot be measured", "bench fill", "give 512 to 32768 samples");
  FillBenchReport report;
  report.machine = machine();
  report.samples = std::int64_t{options.side} * options.side;
  std::vector<float> copy(static_cast<std::size_t>(report.samples));
  for (const HoleKind& kind : holeKinds()) {
    const auto field = holedField(options.side, kind);
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
