#include "engine/suggest/noise_match.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "engine/filter/catalogue.h"

namespace fettle::engine {

namespace {

constexpr double kNoNoise = 6.0;        // [sigma]
constexpr std::int32_t kWindow = 31;    // of total variation
constexpr std::size_t kMatchZones = 2;  // flats, edges

struct Removed {
  std::array<double, kMatchZones> squares{};
  std::array<std::int64_t, kMatchZones> samples{};
};

Result<Version> varied(const Version& field, double sigma, JobControl& job) {
  FilterSpec spec;
  spec.kind = FilterKind::kTotalVariation;
  spec.window = kWindow;
  spec.range_sigma = filterOf(spec.kind).noises * sigma;
  auto done = applyFilter(field, field, spec, job);
  if (!done) return tl::unexpected(done.error());
  return std::move(done->field);
}

Removed removedFrom(const Version& before, const Version& after, const std::vector<SampleZone>& zones,
                    double sigma) {
  Removed removed;
  const std::int32_t width = before.grid().width;
  std::vector<float> was(static_cast<std::size_t>(width)), is(was.size());
  const FieldReader before_reader = before.reader(), after_reader = after.reader();
  for (std::int32_t r = 0; r < before.grid().height; ++r) {
    before_reader.readHeights(0, r, width, 1, was.data(), width);
    after_reader.readHeights(0, r, width, 1, is.data(), width);
    const SampleZone* const zone = zones.data() + static_cast<std::ptrdiff_t>(r) * width;
    for (std::size_t c = 0; c < was.size(); ++c) {
      const double off = static_cast<double>(was[c]) - static_cast<double>(is[c]);
      if (zone[c] == SampleZone::kBetween || !(std::abs(off) <= kNoNoise * sigma)) continue;
      const std::size_t z = zone[c] == SampleZone::kEdge ? 1 : 0;
      removed.squares[z] += off * off;
      ++removed.samples[z];
    }
  }
  return removed;
}

}  // namespace

double NoiseMatch::in(SampleZone zone) const noexcept {
  return zone == SampleZone::kFlat ? flat : zone == SampleZone::kEdge ? edge : 0.5 * (flat + edge);
}

Result<NoiseMatch> matchNoise(const Version& scan, const Version& sample,
                              const std::vector<SampleZone>& zones, double sigma, JobControl& job) {
  const auto of_scan = varied(scan, sigma, job);
  if (!of_scan) return tl::unexpected(of_scan.error());
  const auto of_sample = varied(sample, sigma, job);
  if (!of_sample) return tl::unexpected(of_sample.error());
  const Removed off_scan = removedFrom(scan, *of_scan, zones, sigma);
  const Removed off_sample = removedFrom(sample, *of_sample, zones, sigma);
  const auto ratio = [&](std::size_t z) {
    if (std::min(off_scan.samples[z], off_sample.samples[z]) < kFewestMatched ||
        !(off_sample.squares[z] > 0.0))
      return 1.0;
    const double squares = off_scan.squares[z] / static_cast<double>(off_scan.samples[z]) /
                           (off_sample.squares[z] / static_cast<double>(off_sample.samples[z]));
    return std::clamp(std::sqrt(squares), 1.0 / kMostMatched, kMostMatched);
  };
  return NoiseMatch{ratio(0), ratio(1)};
}

}  // namespace fettle::engine
