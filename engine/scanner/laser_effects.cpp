#include "engine/scanner/laser_effects.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numbers>

namespace fettle::engine {

namespace {

constexpr double kDropout = std::numeric_limits<double>::quiet_NaN();

void forEachSample(ScanBlock& block, auto&& f) {
  for (int r = 0; r < block.rows; ++r)
    for (int c = 0; c < block.columns; ++c)
      if (!std::isnan(block.heightAt(c, r))) f(c, r);
}

// Sigma of a sample against that at the reference height.
double depthFactor(const LaserModel& model, double height_mm) noexcept {
  const double d = (model.standoff_mm - height_mm) / model.standoff_mm;
  return d * d;
}

// Rise per sample towards the flatter of two neighbours; with one neighbour that one, without any flat.
double flatterRise(double before, double here, double after) noexcept {
  const double a = std::abs(here - before);
  const double b = std::abs(after - here);
  if (std::isnan(a)) return std::isnan(b) ? 0.0 : b;
  return std::isnan(b) ? a : std::min(a, b);
}

}  // namespace

void mixPixels(ScanBlock& block, const LaserModel& model, double share, const CounterRandom& random) {
  // 3 x 3 samples on a 70 degree face span tan(70) * 2 sqrt(2) spacings.
  const double least = std::max(model.mixed_step_mm, 7.8 * block.spacing_mm);
  const CounterRandom where(random.bits(0, 0), 1);
  forEachSample(block, [&](int c, int r) {
    double low = std::numeric_limits<double>::infinity();
    double high = -low;
    for (int dr = -1; dr <= 1; ++dr)
      for (int dc = -1; dc <= 1; ++dc) {
        const double z = block.truthAt(c + dc, r + dr);
        if (z < low) low = z;
        if (z > high) high = z;
      }
    const std::int32_t column = block.column + c;
    const std::int32_t row = block.row + r;
    if (high - low < least || random.uniform(column, row) >= share) return;
    block.heightAt(c, r) = low + (high - low) * where.uniform(column, row);
  });
}

void addSensorNoise(ScanBlock& block, const LaserModel& model, double scale, const CounterRandom& random) {
  const double sigma = model.sigma_mm * scale;
  forEachSample(block, [&](int c, int r) {
    block.heightAt(c, r) +=
        sigma * depthFactor(model, block.truthAt(c, r)) * random.normal(block.column + c, block.row + r);
  });
}

std::vector<double> speckleKernel(const LaserModel& model, double spacing_mm) {
  const double sigma = model.speckle_length_mm / spacing_mm;  // in samples
  // Beyond 3 sigma lies 0.3 % of the weight. The longest kernel is bounded, for extremely fine grids.
  const int half = static_cast<int>(std::min(3.0 * sigma, 512.0));
  std::vector<double> kernel;
  double power = 0.0;
  for (int k = -half; k <= half; ++k) {
    kernel.push_back(sigma > 0.0 ? std::exp(-0.5 * (k / sigma) * (k / sigma)) : 1.0);
    power += kernel.back() * kernel.back();
  }
  for (double& w : kernel) w /= std::sqrt(power);
  return kernel;
}

void addSpeckle(ScanBlock& block, const LaserModel& model, double scale, std::span<const double> kernel,
                const CounterRandom& random) {
  const int half = static_cast<int>(kernel.size() / 2);
  const double sigma = model.sigma_mm * model.speckle_ratio * scale;
  std::vector<double> white(static_cast<std::size_t>(block.columns + 2 * half));
  for (int r = 0; r < block.rows; ++r) {
    for (std::size_t i = 0; i < white.size(); ++i)
      white[i] = random.normal(block.column - half + static_cast<int>(i), block.row + r);
    for (int c = 0; c < block.columns; ++c) {
      if (std::isnan(block.heightAt(c, r))) continue;
      double sum = 0.0;
      for (std::size_t k = 0; k < kernel.size(); ++k)
        sum += kernel[k] * white[static_cast<std::size_t>(c) + k];
      block.heightAt(c, r) += sigma * depthFactor(model, block.truthAt(c, r)) * sum;
    }
  }
}

void addLineOffset(ScanBlock& block, const LaserModel& model, double scale, const CounterRandom& random) {
  for (int r = 0; r < block.rows; ++r) {
    const double offset = model.sigma_mm * model.line_ratio * scale * random.normal(0, block.row + r);
    for (int c = 0; c < block.columns; ++c) block.heightAt(c, r) += offset;
  }
}

void quantise(ScanBlock& block, const LaserModel& model, double scale) {
  const double count = model.sigma_mm * model.count_ratio * scale;
  forEachSample(block, [&](int c, int r) {
    block.heightAt(c, r) = std::nearbyint(block.heightAt(c, r) / count) * count;
  });
}

void dropSteep(ScanBlock& block, const LaserModel& model, double scale, const CounterRandom& random) {
  forEachSample(block, [&](int c, int r) {
    const double z = block.truthAt(c, r);
    const double rise = std::hypot(flatterRise(block.truthAt(c - 1, r), z, block.truthAt(c + 1, r)),
                                   flatterRise(block.truthAt(c, r - 1), z, block.truthAt(c, r + 1)));
    const double degrees = std::atan2(rise, block.spacing_mm) * 180.0 / std::numbers::pi;
    if (degrees <= model.steep_from_deg) return;
    const double t = (degrees - model.steep_from_deg) / (model.steep_all_deg - model.steep_from_deg);
    if (random.uniform(block.column + c, block.row + r) < scale * t * t) block.heightAt(c, r) = kDropout;
  });
}

void dropShadowed(ScanBlock& block, const LaserModel& model, std::span<double> horizon) {
  // Float heights carry an error of about 1e-6 of their size; a plane exactly as steep as the ray must not be
  // partly hidden.
  constexpr double kSlack = 1e-4;
  for (int r = block.rows - 1; r >= 0; --r) {
    const double y = (block.row + r) * block.spacing_mm;
    for (int c = 0; c < block.columns; ++c) {
      const double z = block.truthAt(c, r);
      if (std::isnan(z)) continue;
      const double level = z - y / model.camera_tangent;
      double& highest = horizon[static_cast<std::size_t>(c)];
      // Hidden when z' > z + (y' - y) / tangent for an earlier (higher) row.
      if (highest > level + kSlack) block.heightAt(c, r) = kDropout;
      highest = std::max(highest, level);
    }
  }
}

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
