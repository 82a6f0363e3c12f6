#include "engine/edges/sample_window.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <tbb/parallel_for.h>

namespace fettle::engine {

namespace {

// A sample that lies alone in height: see SampleWindow's constructor. The window of 5 x 5 also finds pairs.
constexpr double kNear = 4.0;  // standard deviations
constexpr int kLeastNeighbours = 3;
constexpr float kLargestMisfit = 4.5F;  // standard deviations

}  // namespace

SampleWindow::SampleWindow(const FieldReader& field, glm::ivec2 origin, const std::vector<Polyline>& lines,
                           double margin, double noise) {
  std::vector<glm::ivec2> places;
  for (const Polyline& line : lines)
    for (const glm::dvec2& point : line.points) {
      const glm::ivec2 low{static_cast<int>(std::floor(point.x - margin)),
                           static_cast<int>(std::floor(point.y - margin))};
      const glm::ivec2 high{static_cast<int>(std::ceil(point.x + margin)),
                            static_cast<int>(std::ceil(point.y + margin))};
      for (int up = low.y >> kShift; up <= high.y >> kShift; ++up)
        for (int across = low.x >> kShift; across <= high.x >> kShift; ++across) {
          const glm::ivec2 first = origin + glm::ivec2{across << kShift, up << kShift};
          const bool inside = first.x < field.width() && first.y < field.height() && first.x + kSide > 0 &&
                              first.y + kSide > 0;
          if (inside && blocks_.try_emplace(key(across, up), places.size()).second)
            places.push_back({across, up});
        }
    }
  samples_.resize(places.size() * kBlock);
  tbb::parallel_for(std::size_t{0}, places.size(), [&](std::size_t i) {
    readBlock(field, origin, places[i], noise, samples_.data() + i * kBlock);
  });
}

void SampleWindow::readBlock(const FieldReader& field, glm::ivec2 origin, glm::ivec2 block, double noise,
                             Sample* out) {
  constexpr int kAlone = kSpikeReach;
  constexpr int kWide = kSide + 2 * kAlone;
  std::array<float, static_cast<std::size_t>(kWide) * kWide> z;
  field.readHeights(origin.x + (block.x << kShift) - kAlone, origin.y + (block.y << kShift) - kAlone, kWide,
                    kWide, z.data(), kWide);
  for (int row = 0; row < kSide; ++row)
    for (int column = 0; column < kSide; ++column) {
      const float* centre = z.data() + (row + kAlone) * kWide + column + kAlone;
      int neighbours = -1;  // the sample itself
      for (int y = -kAlone; y <= kAlone; ++y)
        for (int x = -kAlone; x <= kAlone; ++x)
          neighbours += std::abs(double{centre[y * kWide + x]} - double{*centre}) < kNear * noise ? 1 : 0;
      Sample& sample = out[row * kSide + column];
      sample.height = *centre;
      sample.kept = neighbours >= kLeastNeighbours;
    }
}

void SampleWindow::applyMisfits() {
  for (Sample& sample : samples_) {
    if (sample.misfit < kNoFit && sample.misfit > 0.0F && !std::isnan(sample.height))
      sample.kept = sample.misfit <= kLargestMisfit;
    sample.misfit = kNoFit;
  }
}

}  // namespace fettle::engine
