#include "engine/measure/hills.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numeric>

#include <tbb/parallel_sort.h>

#include "engine/compare/tile_sums.h"

namespace fettle::engine {

namespace {

constexpr std::uint32_t kLow =
    std::numeric_limits<std::uint32_t>::max();  // a sample that is still under water

// A pass across a cell between two corners that are higher than the others.
struct Pass {
  float height = 0.0F;
  std::uint32_t from = 0, to = 0;
};

// Calls `take(Pass)` for each pass across a cell, row by row.
template <class Take>
void forEachPass(const Surface& surface, const Take& take) {
  const auto index = [&](std::int32_t c, std::int32_t r) {
    return static_cast<std::uint32_t>(r) * static_cast<std::uint32_t>(surface.width) +
           static_cast<std::uint32_t>(c);
  };
  for (std::int32_t r = 0; r + 1 < surface.height; ++r)
    for (std::int32_t c = 0; c + 1 < surface.width; ++c) {
      const double a = surface.at(c, r), b = surface.at(c + 1, r);
      const double d = surface.at(c, r + 1), e = surface.at(c + 1, r + 1);
      if (std::isnan(a + b + d + e)) continue;
      const bool rising = std::min(a, e) > std::max(b, d), falling = std::min(b, d) > std::max(a, e);
      if (!rising && !falling) continue;
      // Where the patch's gradient is nought, without cancellation: from the lower pair's mean.
      const double middle = (a * e - b * d) / (a + e - b - d);
      const double lower = rising ? std::max(b, d) : std::max(a, e),
                   upper = rising ? std::min(a, e) : std::min(b, d);
      take(Pass{static_cast<float>(std::clamp(middle, lower, upper)), rising ? index(c, r) : index(c + 1, r),
                rising ? index(c + 1, r + 1) : index(c, r + 1)});
    }
}

// Least first: the highest, of equal heights the first sample.
std::uint64_t emergenceKey(float height, std::uint32_t sample) noexcept {
  // Bits of floats in the order of their values; no -0.
  const auto bits = std::bit_cast<std::uint32_t>(height + 0.0F);
  const std::uint32_t rising = (bits & 0x80000000U) != 0 ? ~bits : bits | 0x80000000U;
  return std::uint64_t{~rising} << 32U | sample;
}
std::uint32_t sampleOf(std::uint64_t key) noexcept {
  return static_cast<std::uint32_t>(key);
}

// Hills that grow and merge while the water falls. A set's first sample is its peak.
class Flood {
 public:
  Flood(const Surface& surface, double least)
      : surface_(surface),
        least_(least),
        parent_(surface.heights.size(), kLow),
        rises_to_(surface.heights.size(), kLow),
        becomes_(surface.heights.size(), kLow) {}

  void emerge(std::uint32_t sample) {
    parent_[sample] = sample;
    const auto width = static_cast<std::uint32_t>(surface_.width);
    const std::uint32_t column = sample % width, row = sample / width;
    const double height = surface_.heights[sample];
    std::uint32_t neighbours[4];
    int count = 0;
    const auto add = [&](bool inside, std::uint32_t other) {
      if (inside && parent_[other] != kLow) neighbours[count++] = other;
    };
    add(column > 0, sample - 1);
    add(column + 1 < width, sample + 1);
    add(row > 0, sample - width);
    add(row + 1 < static_cast<std::uint32_t>(surface_.height), sample + width);
    // The highest first: the sample is of its hill from then on, for the saddles between this and the others.
    for (int i = 1; i < count; ++i)
      if (before(neighbours[i], neighbours[0])) std::swap(neighbours[0], neighbours[i]);
    rises_to_[sample] = count > 0 ? rises_to_[neighbours[0]] : sample;
    if (count == 0) becomes_[sample] = sample;
    for (int i = 0; i < count; ++i) join(sample, neighbours[i], height);
  }
  // At a saddle of this height.
  void join(std::uint32_t a, std::uint32_t b, double height) {
    if (parent_[a] == kLow || parent_[b] == kLow) return;
    std::uint32_t high = peakOf(a), low = peakOf(b), beyond = a;
    if (high == low) return;
    if (before(low, high)) {
      std::swap(high, low);
      beyond = b;
    }
    parent_[low] = high;
    // A hill that is pruned is one alone, as each that it had taken in was lower still over a higher saddle. A sample that
    // emerges is none.
    if (!take(low, height) && rises_to_[low] == low) becomes_[keptOf(low)] = keptOf(rises_to_[beyond]);
  }
  // What is left when all is dry, over the lowest sample of each connected part.
  void finish(const std::vector<std::uint64_t>& order) {
    // From the lowest on: the first sample of a part is its lowest one. A part that was seen has its peak's mark.
    std::vector<bool> seen(parent_.size(), false);
    for (auto at = order.rbegin(); at != order.rend(); ++at) {
      const std::uint32_t peak = peakOf(sampleOf(*at));
      if (seen[peak]) continue;
      seen[peak] = true;
      take(peak, surface_.heights[sampleOf(*at)]);
    }
  }
  // Whether sample a is higher than b.
  [[nodiscard]] bool before(std::uint32_t a, std::uint32_t b) const noexcept {
    const float za = surface_.heights[a], zb = surface_.heights[b];
    return za > zb || (za == zb && a < b);
  }
  // For each sample the number of its hill among hills(), which are sorted.
  [[nodiscard]] std::vector<std::int32_t> hillsOfSamples() {
    std::vector<std::int32_t> number(parent_.size(), HillMap::kNone);
    for (std::size_t i = 0; i < peaks_.size(); ++i) number[peaks_[i].sample] = static_cast<std::int32_t>(i);
    std::vector<std::int32_t> of(parent_.size(), HillMap::kNone);
    for (std::size_t i = 0; i < of.size(); ++i)
      if (rises_to_[i] != kLow) of[i] = number[keptOf(rises_to_[i])];
    return of;
  }
  [[nodiscard]] std::vector<Hill> hills() {
    std::sort(peaks_.begin(), peaks_.end(),
              [&](const Peak& a, const Peak& b) { return before(a.sample, b.sample); });
    std::vector<Hill> hills;
    hills.reserve(peaks_.size());
    const auto width = static_cast<std::uint32_t>(surface_.width);
    for (const Peak& peak : peaks_)
      hills.push_back({static_cast<std::int32_t>(peak.sample % width),
                       static_cast<std::int32_t>(peak.sample / width), surface_.heights[peak.sample],
                       peak.height});
    return hills;
  }

 private:
  struct Peak {
    std::uint32_t sample = 0;
    double height = 0.0;
  };

  std::uint32_t peakOf(std::uint32_t sample) noexcept {
    while (parent_[sample] != sample) {
      parent_[sample] = parent_[parent_[sample]];
      sample = parent_[sample];
    }
    return sample;
  }
  // Whether it is a hill.
  bool take(std::uint32_t peak, double saddle) {
    const double height = surface_.heights[peak] - saddle;
    const bool hill = height >= least_ && height > 0.0;
    if (hill) peaks_.push_back({peak, height});
    return hill;
  }
  // The peak of the hill that a peak's hill became part of.
  std::uint32_t keptOf(std::uint32_t peak) noexcept {
    while (becomes_[peak] != peak) {
      becomes_[peak] = becomes_[becomes_[peak]];
      peak = becomes_[peak];
    }
    return peak;
  }

  const Surface& surface_;
  double least_;
  std::vector<std::uint32_t> parent_;
  std::vector<Peak> peaks_;
  std::vector<std::uint32_t> rises_to_;  // of each sample its peak, before pruning
  std::vector<std::uint32_t> becomes_;   // of each peak that whose hill it is part of
};

}  // namespace

Result<HillMap> mapHills(const Surface& surface, double least, JobControl& job) {
  job.begin("segmenting hills", static_cast<std::uint64_t>(surface.samples));
  // Keys are sorted instead of samples, which would be looked up at each comparison: a half of the time.
  std::vector<std::uint64_t> order;
  order.reserve(static_cast<std::size_t>(surface.samples));
  for (std::size_t i = 0; i < surface.heights.size(); ++i)
    if (!std::isnan(surface.heights[i]))
      order.push_back(emergenceKey(surface.heights[i], static_cast<std::uint32_t>(i)));
  Flood flood(surface, least);
  tbb::parallel_sort(order.begin(), order.end());
  std::vector<Pass> passes;
  forEachPass(surface, [&](const Pass& pass) { passes.push_back(pass); });
  tbb::parallel_sort(passes.begin(), passes.end(), [](const Pass& a, const Pass& b) {
    return a.height > b.height || (a.height == b.height && a.from < b.from) ||
           (a.height == b.height && a.from == b.from && a.to < b.to);
  });
  std::size_t pass = 0;
  constexpr std::size_t kStep = 1U << 16U;
  for (std::size_t i = 0; i < order.size(); ++i) {
    const std::uint32_t sample = sampleOf(order[i]);
    const float height = surface.heights[sample];
    for (; pass < passes.size() && passes[pass].height > height; ++pass)
      flood.join(passes[pass].from, passes[pass].to, passes[pass].height);
    flood.emerge(sample);
    if (i % kStep == kStep - 1) {
      if (job.cancelled()) return cancelled();
      job.advance(kStep);
    }
  }
  // A pass is never below the lowest sample, so that each has been crossed but those at its very height.
  for (; pass < passes.size(); ++pass) flood.join(passes[pass].from, passes[pass].to, passes[pass].height);
  flood.finish(order);
  HillMap map;
  map.hills = flood.hills();
  map.of = flood.hillsOfSamples();
  return map;
}

std::vector<HillFigures> figuresOfHills(const Surface& surface, const HillMap& map) {
  constexpr double kUnder = -std::numeric_limits<double>::infinity();
  std::vector<HillFigures> figures;
  for (const Hill& hill : map.hills) figures.push_back({.hill = hill, .saddle = kUnder});
  const auto index = [&](std::int32_t c, std::int32_t r) {
    return static_cast<std::size_t>(r) * static_cast<std::size_t>(surface.width) +
           static_cast<std::size_t>(c);
  };
  const auto meet = [&](std::size_t a, std::size_t b, double height) {
    const std::int32_t one = map.of[a], other = map.of[b];
    if (one == other || one == HillMap::kNone || other == HillMap::kNone) return;
    for (const std::int32_t number : {one, other}) {
      double& saddle = figures[static_cast<std::size_t>(number)].saddle;
      saddle = std::max(saddle, height);
    }
  };
  forEachPass(surface, [&](const Pass& pass) { meet(pass.from, pass.to, pass.height); });
  for (std::int32_t r = 0; r < surface.height; ++r)
    for (std::int32_t c = 0; c < surface.width; ++c) {
      if (c + 1 < surface.width)
        meet(index(c, r), index(c + 1, r), std::min(surface.at(c, r), surface.at(c + 1, r)));
      if (r + 1 < surface.height)
        meet(index(c, r), index(c, r + 1), std::min(surface.at(c, r), surface.at(c, r + 1)));
    }
  for (HillFigures& of : figures)
    if (of.saddle == kUnder) of.saddle = of.hill.peak - of.hill.height;  // it meets no other

  std::vector<CompensatedSum> volumes(figures.size());
  std::vector<std::int64_t> above(figures.size());
  const double cell = surface.spacing_x * surface.spacing_y;
  const auto outside = [&](std::int32_t c, std::int32_t r) {
    return c < 0 || r < 0 || c >= surface.width || r >= surface.height || std::isnan(surface.at(c, r));
  };
  for (std::int32_t r = 0; r < surface.height; ++r)
    for (std::int32_t c = 0; c < surface.width; ++c) {
      const std::int32_t number = map.of[index(c, r)];
      if (number == HillMap::kNone) continue;
      const auto i = static_cast<std::size_t>(number);
      HillFigures& of = figures[i];
      ++of.samples;
      const bool rim = outside(c - 1, r) || outside(c + 1, r) || outside(c, r - 1) || outside(c, r + 1);
      of.cut = of.cut || rim;
      const double over = surface.at(c, r) - of.saddle;
      if (!(over > 0.0)) continue;
      ++above[i];
      volumes[i].add(over);
      of.open = of.open || rim;
    }
  for (std::size_t i = 0; i < figures.size(); ++i) {
    figures[i].area_mm2 = static_cast<double>(figures[i].samples) * cell;
    figures[i].area_above_mm2 = static_cast<double>(above[i]) * cell;
    figures[i].volume_mm3 = volumes[i].value() * cell * surface.height_mm;
  }
  return figures;
}

}  // namespace fettle::engine
