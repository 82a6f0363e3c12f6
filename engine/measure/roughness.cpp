#include "engine/measure/roughness.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numbers>

#include <fmt/format.h>

namespace fettle::engine {

namespace {

// The longest run of places of a stretch that all have a height: the first and the one after the last.
struct Run {
  std::size_t from = 0, to = 0;
};
Run longestRun(const Section& section, const Stretch& within) {
  const double slack = 1e-6 * section.step_mm;
  Run best, run;
  for (std::size_t i = 0; i < section.size(); ++i) {
    const bool counts = section.along(i) >= within.from_mm - slack &&
                        section.along(i) <= within.to_mm + slack && !std::isnan(section.height[i]);
    if (!counts)
      run = {i + 1, i + 1};
    else if (++run.to - run.from > best.to - best.from)
      best = run;
  }
  return best;
}

void takeLineOut(std::vector<double>& heights) {
  const auto n = static_cast<double>(heights.size());
  double mean = 0.0, xz = 0.0;
  for (const double z : heights) mean += z / n;
  for (std::size_t i = 0; i < heights.size(); ++i)
    xz += (static_cast<double>(i) - 0.5 * (n - 1.0)) * (heights[i] - mean);
  const double slope = n > 1.0 ? xz * 12.0 / (n * (n * n - 1.0)) : 0.0;
  for (std::size_t i = 0; i < heights.size(); ++i)
    heights[i] -= mean + slope * (static_cast<double>(i) - 0.5 * (n - 1.0));
}

// Mean width of elements: crossings of the mean line that lead from beyond one threshold to beyond the other.
double meanWidth(std::span<const double> heights, double step_mm, double threshold) {
  double width = 0.0;
  int elements = 0;
  for (const double sign : {1.0, -1.0}) {
    bool below = false;
    double crossing = 0.0, first = 0.0, last = 0.0;
    int count = 0;
    for (std::size_t i = 0; i < heights.size(); ++i) {
      const double z = sign * heights[i];
      if (i > 0 && z >= 0.0 && sign * heights[i - 1] < 0.0)
        crossing = static_cast<double>(i) - z / (z - sign * heights[i - 1]);
      if (z < -threshold) below = true;
      if (z > threshold && below) {
        below = false;
        if (count++ == 0) first = crossing;
        last = crossing;
      }
    }
    if (count > 1) {
      width += (last - first) * step_mm;
      elements += count - 1;
    }
  }
  return elements > 0 ? width / elements : std::numeric_limits<double>::quiet_NaN();
}

}  // namespace

std::vector<double> gaussianMeanLine(std::span<const double> heights, double step_mm, double cutoff_mm) {
  const double alpha = std::sqrt(std::numbers::ln2 / std::numbers::pi);
  const auto reach =
      static_cast<std::size_t>(std::min(cutoff_mm / step_mm, static_cast<double>(heights.size())));
  std::vector<double> weights(reach + 1);
  for (std::size_t k = 0; k <= reach; ++k) {
    const double x = static_cast<double>(k) * step_mm / (alpha * cutoff_mm);
    weights[k] = std::exp(-std::numbers::pi * x * x);
  }
  std::vector<double> line(heights.size());
  for (std::size_t i = 0; i < heights.size(); ++i) {
    double sum = weights[0] * heights[i], whole = weights[0];
    for (std::size_t k = 1; k <= reach; ++k) {
      if (k <= i) {
        sum += weights[k] * heights[i - k];
        whole += weights[k];
      }
      if (i + k < heights.size()) {
        sum += weights[k] * heights[i + k];
        whole += weights[k];
      }
    }
    line[i] = sum / whole;
  }
  return line;
}

Result<Roughness> roughnessOf(const Section& section, const Stretch& within, double cutoff_mm) {
  const Run run = longestRun(section, within);
  const double step = section.step_mm;
  const double length = run.to > run.from ? static_cast<double>(run.to - run.from - 1) * step : 0.0;
  if (!(cutoff_mm >= 4.0 * step * (1.0 - 1e-9)))
    return inputError(
        fmt::format("a cut-off of {:.6g} mm is shorter than 4 places of the section", cutoff_mm), "section",
        fmt::format("give {:.6g} mm or more", 4.0 * step));
  if (!(length >= 2.0 * cutoff_mm * (1.0 - 1e-9)))
    return inputError(
        fmt::format("the section has {:.6g} mm without a hole, less than two cut-offs of {:.6g} mm", length,
                    cutoff_mm),
        "section", "give a longer line or a shorter cut-off");
  std::vector<double> heights(section.height.begin() + static_cast<std::ptrdiff_t>(run.from),
                              section.height.begin() + static_cast<std::ptrdiff_t>(run.to));
  takeLineOut(heights);
  const std::vector<double> line = gaussianMeanLine(heights, step, cutoff_mm);
  for (std::size_t i = 0; i < heights.size(); ++i) heights[i] -= line[i];

  Roughness result;
  result.lengths = static_cast<int>(std::floor((length - cutoff_mm) / cutoff_mm + 1e-6));
  // In the middle of the run.
  const double start = 0.5 * (length - result.lengths * cutoff_mm);
  const auto placeAt = [&](double at) {
    return std::min(heights.size() - 1, static_cast<std::size_t>(std::ceil(at / step - 1e-6)));
  };
  const std::size_t from = placeAt(start), to = placeAt(start + result.lengths * cutoff_mm);
  const double begin = section.along(run.from);
  result.evaluated = {begin + static_cast<double>(from) * step, begin + static_cast<double>(to) * step};
  const std::span<const double> evaluated = std::span(heights).subspan(from, to - from + 1);
  const auto n = static_cast<double>(evaluated.size());
  double mean = 0.0;
  for (const double z : evaluated) mean += z / n;
  double second = 0.0, third = 0.0, fourth = 0.0;
  std::vector<double> profile(evaluated.begin(), evaluated.end());
  for (double& z : profile) {
    // From the mean of the evaluated part: the mean line of all is not exactly its mean.
    z -= mean;
    result.ra += std::abs(z) / n;
    second += z * z / n;
    third += z * z * z / n;
    fourth += z * z * z * z / n;
  }
  result.rq = std::sqrt(second);
  result.rsk = second > 0.0 ? third / (second * result.rq) : std::numeric_limits<double>::quiet_NaN();
  result.rku = second > 0.0 ? fourth / (second * second) : std::numeric_limits<double>::quiet_NaN();
  for (int k = 0; k < result.lengths; ++k) {
    const std::size_t low = placeAt(start + k * cutoff_mm) - from,
                      high = placeAt(start + (k + 1) * cutoff_mm) - from;
    const auto [least, most] = std::minmax_element(profile.begin() + static_cast<std::ptrdiff_t>(low),
                                                   profile.begin() + static_cast<std::ptrdiff_t>(high) + 1);
    result.rz += (*most - *least) / result.lengths;
  }
  result.rsm = meanWidth(profile, step, 0.1 * result.rz);
  return result;
}

}  // namespace fettle::engine
