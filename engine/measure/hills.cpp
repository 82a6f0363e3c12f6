#include "engine/measure/hills.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numeric>

#include <tbb/parallel_sort.h>

#include "engine/compare/tile_sums.h"

namespace fettle::engine {

namespace {

constexpr double kNoFigure = std::numeric_limits<double>::quiet_NaN();
constexpr std::uint32_t kLow =
    std::numeric_limits<std::uint32_t>::max();  // a sample that is still under water

// A pass across a cell between two corners that are higher than the others.
struct Pass {
  float height = 0.0F;
  std::uint32_t from = 0, to = 0;
};

std::vector<Pass> passesOf(const Surface& surface) {
  std::vector<Pass> passes;
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
      passes.push_back({static_cast<float>(std::clamp(middle, lower, upper)),
                        rising ? index(c, r) : index(c + 1, r),
                        rising ? index(c + 1, r + 1) : index(c, r + 1)});
    }
  return passes;
}

// Hills that grow and merge while the water falls. A set's first sample is its peak.
class Flood {
 public:
  Flood(const Surface& surface, double least)
      : surface_(surface), least_(least), parent_(surface.heights.size(), kLow) {}

  void emerge(std::uint32_t sample) {
    parent_[sample] = sample;
    const auto width = static_cast<std::uint32_t>(surface_.width);
    const std::uint32_t column = sample % width, row = sample / width;
    const double height = surface_.heights[sample];
    if (column > 0) join(sample, sample - 1, height);
    if (column + 1 < width) join(sample, sample + 1, height);
    if (row > 0) join(sample, sample - width, height);
    if (row + 1 < static_cast<std::uint32_t>(surface_.height)) join(sample, sample + width, height);
  }
  // At a saddle of this height.
  void join(std::uint32_t a, std::uint32_t b, double height) {
    if (parent_[a] == kLow || parent_[b] == kLow) return;
    std::uint32_t high = peakOf(a), low = peakOf(b);
    if (high == low) return;
    if (before(low, high)) std::swap(high, low);
    parent_[low] = high;
    take(low, height);
  }
  // What is left when all is dry, over the lowest sample of each connected part.
  void finish(const std::vector<std::uint32_t>& order) {
    // From the lowest on: the first sample of a part is its lowest one. A part that was seen has its peak's mark.
    std::vector<bool> seen(parent_.size(), false);
    for (auto at = order.rbegin(); at != order.rend(); ++at) {
      const std::uint32_t peak = peakOf(*at);
      if (seen[peak]) continue;
      seen[peak] = true;
      take(peak, surface_.heights[*at]);
    }
  }
  // Whether sample a is higher than b.
  [[nodiscard]] bool before(std::uint32_t a, std::uint32_t b) const noexcept {
    const float za = surface_.heights[a], zb = surface_.heights[b];
    return za > zb || (za == zb && a < b);
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
  void take(std::uint32_t peak, double saddle) {
    const double height = surface_.heights[peak] - saddle;
    if (height >= least_ && height > 0.0) peaks_.push_back({peak, height});
  }

  const Surface& surface_;
  double least_;
  std::vector<std::uint32_t> parent_;
  std::vector<Peak> peaks_;
};

}  // namespace

Result<std::vector<Hill>> segmentHills(const Surface& surface, double least, JobControl& job) {
  job.begin("segmenting hills", static_cast<std::uint64_t>(surface.samples));
  std::vector<std::uint32_t> order;
  order.reserve(static_cast<std::size_t>(surface.samples));
  for (std::size_t i = 0; i < surface.heights.size(); ++i)
    if (!std::isnan(surface.heights[i])) order.push_back(static_cast<std::uint32_t>(i));
  Flood flood(surface, least);
  tbb::parallel_sort(order.begin(), order.end(),
                     [&](std::uint32_t a, std::uint32_t b) { return flood.before(a, b); });
  std::vector<Pass> passes = passesOf(surface);
  tbb::parallel_sort(passes.begin(), passes.end(), [](const Pass& a, const Pass& b) {
    return a.height > b.height || (a.height == b.height && a.from < b.from) ||
           (a.height == b.height && a.from == b.from && a.to < b.to);
  });
  std::size_t pass = 0;
  constexpr std::size_t kStep = 1U << 16U;
  for (std::size_t i = 0; i < order.size(); ++i) {
    const float height = surface.heights[order[i]];
    for (; pass < passes.size() && passes[pass].height > height; ++pass)
      flood.join(passes[pass].from, passes[pass].to, passes[pass].height);
    flood.emerge(order[i]);
    if (i % kStep == kStep - 1) {
      if (job.cancelled()) return cancelled();
      job.advance(kStep);
    }
  }
  // A pass is never below the lowest sample, so that each has been crossed but those at its very height.
  for (; pass < passes.size(); ++pass) flood.join(passes[pass].from, passes[pass].to, passes[pass].height);
  flood.finish(order);
  return flood.hills();
}

Result<FeatureParameters> measureFeatures(const Surface& surface, double sz, double prune, JobControl& job) {
  FeatureParameters result;
  result.spd = result.spc = kNoFigure;
  const auto none = [&](const char* why) {
    result.no_spd = result.no_spc = why;
    return result;
  };
  if (surface.width < 2 || surface.height < 2) return none("fewer than 2 columns or rows of samples");
  if (!(sz > 0.0)) return none("the surface is flat");
  if (surface.heights.size() >= kLow) return none("more than 4 294 967 294 samples");
  const auto hills = segmentHills(surface, prune * sz, job);
  if (!hills) return tl::unexpected(hills.error());
  result.hills = static_cast<std::int64_t>(hills->size());
  result.spd = static_cast<double>(result.hills) /
               (static_cast<double>(surface.samples) * surface.spacing_x * surface.spacing_y);
  CompensatedSum curvature;
  for (const Hill& hill : *hills) {
    const std::int32_t c = hill.column, r = hill.row;
    if (c == 0 || r == 0 || c + 1 == surface.width || r + 1 == surface.height) continue;
    const double middle = 2.0 * static_cast<double>(surface.at(c, r));
    const double along_x = (static_cast<double>(surface.at(c - 1, r)) - middle + surface.at(c + 1, r)) /
                           (surface.spacing_x * surface.spacing_x);
    const double along_y = (static_cast<double>(surface.at(c, r - 1)) - middle + surface.at(c, r + 1)) /
                           (surface.spacing_y * surface.spacing_y);
    if (std::isnan(along_x + along_y)) continue;
    ++result.curved;
    curvature.add(-0.5 * (along_x + along_y) * surface.height_mm);
  }
  if (result.curved > 0)
    result.spc = curvature.value() / static_cast<double>(result.curved);
  else
    result.no_spc = "every peak lies at the border or at a hole";
  return result;
}

}  // namespace fettle::engine
