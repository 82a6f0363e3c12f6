#include "engine/scanner/lateral_spot.h"

#include <cmath>
#include <cstddef>

namespace fettle::engine {

void averageUnderSpot(ScanBlock& block, double spot, const std::function<double(double, double)>& height) {
  const double fine_spot = spot * kSpotFineness;
  const int reach = static_cast<int>(std::ceil(3.0 * fine_spot));
  std::vector<double> weights;
  for (int k = -reach; k <= reach; ++k) weights.push_back(std::exp(-0.5 * k * k / (fine_spot * fine_spot)));
  // The first fine sample is `reach` before the first sample.
  const int across = (block.columns - 1) * kSpotFineness + 1 + 2 * reach;
  const int up = (block.rows - 1) * kSpotFineness + 1 + 2 * reach;
  // Along the rows first: for each column of the block the weighted heights, and the weights, of each fine row.
  const auto at = [&](int c, int fine_row) {
    return static_cast<std::size_t>(fine_row) * static_cast<std::size_t>(block.columns) +
           static_cast<std::size_t>(c);
  };
  std::vector<double> heights(at(0, up)), shares(at(0, up));
  std::vector<double> line(static_cast<std::size_t>(across));
  for (int r = 0; r < up; ++r) {
    for (int c = 0; c < across; ++c)
      line[static_cast<std::size_t>(c)] =
          height(block.column + static_cast<double>(c - reach) / kSpotFineness,
                 block.row + static_cast<double>(r - reach) / kSpotFineness);
    for (int c = 0; c < block.columns; ++c)
      for (std::size_t k = 0; k < weights.size(); ++k) {
        const double z = line[static_cast<std::size_t>(c) * kSpotFineness + k];
        if (std::isnan(z)) continue;
        heights[at(c, r)] += weights[k] * z;
        shares[at(c, r)] += weights[k];
      }
  }
  for (int r = 0; r < block.rows; ++r)
    for (int c = 0; c < block.columns; ++c) {
      if (std::isnan(block.heightAt(c, r))) continue;
      double sum = 0.0, share = 0.0;
      for (std::size_t k = 0; k < weights.size(); ++k) {
        const std::size_t i = at(c, r * kSpotFineness + static_cast<int>(k));
        sum += weights[k] * heights[i];
        share += weights[k] * shares[i];
      }
      if (share > 0.0) block.heightAt(c, r) = sum / share;
    }
}

}  // namespace fettle::engine
