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

Result<RoughnessProfile> roughnessProfile(const Section& section, const Stretch& within,
                                          const ProfileFilters& filters) {
  const Run run = longestRun(section, within);
  const double step = section.step_mm, cutoff_mm = filters.cutoff_mm, lambda_s_mm = filters.lambda_s_mm;
  const double least = 4.0 * step;
  const auto is_short = [least](double length_mm) { return !(length_mm >= least * (1.0 - 1e-9)); };
  if (is_short(cutoff_mm) || (lambda_s_mm != 0.0 && is_short(lambda_s_mm)))
    return inputError(fmt::format("a {} of {:.6g} mm is shorter than 4 places of the section",
                                  is_short(cutoff_mm) ? "cut-off" : "lambda s",
                                  is_short(cutoff_mm) ? cutoff_mm : lambda_s_mm),
                      "section", fmt::format("give {:.6g} mm or more", least));
  if (!(lambda_s_mm < cutoff_mm))
    return inputError(fmt::format("a lambda s of {:.6g} mm leaves nothing below a cut-off of {:.6g} mm",
                                  lambda_s_mm, cutoff_mm),
                      "section", "give a shorter lambda s: a hundredth or a three-hundredth is usual");
  std::vector<double> heights(section.height.begin() + static_cast<std::ptrdiff_t>(run.from),
                              section.height.begin() + static_cast<std::ptrdiff_t>(run.to));
  takeLineOut(heights);
  std::size_t first = run.from;  // place of the section
  if (lambda_s_mm > 0.0) {
    heights = gaussianMeanLine(heights, step, lambda_s_mm);
    const std::size_t end =
        std::min(static_cast<std::size_t>(std::ceil(0.5 * lambda_s_mm / step - 1e-6)), heights.size() / 2);
    heights.erase(heights.begin(), heights.begin() + static_cast<std::ptrdiff_t>(end));
    heights.resize(heights.size() - end);
    first += end;
  }
  const double length = heights.empty() ? 0.0 : static_cast<double>(heights.size() - 1) * step;
  if (!(length >= 2.0 * cutoff_mm * (1.0 - 1e-9)))
    return inputError(
        fmt::format("the section has {:.6g} mm without a hole{}, less than two cut-offs of {:.6g} mm", length,
                    lambda_s_mm > 0.0 ? " or an end of the S-filter" : "", cutoff_mm),
        "section", "give a longer line or a shorter cut-off");
  const std::vector<double> line = gaussianMeanLine(heights, step, cutoff_mm);
  for (std::size_t i = 0; i < heights.size(); ++i) heights[i] -= line[i];

  RoughnessProfile result;
  result.lengths = static_cast<int>(std::floor((length - cutoff_mm) / cutoff_mm + 1e-6));
  // In the middle of the run.
  const double start = 0.5 * (length - result.lengths * cutoff_mm);
  const auto placeAt = [&](double at) {
    return std::min(heights.size() - 1, static_cast<std::size_t>(std::ceil(at / step - 1e-6)));
  };
  const std::size_t from = placeAt(start), to = placeAt(start + result.lengths * cutoff_mm);
  const double begin = section.along(first);
  result.evaluated = {begin + static_cast<double>(from) * step, begin + static_cast<double>(to) * step};
  for (int k = 0; k <= result.lengths; ++k)
    result.lengths_begin.push_back(placeAt(start + k * cutoff_mm) - from);
  result.heights.assign(heights.begin() + static_cast<std::ptrdiff_t>(from),
                        heights.begin() + static_cast<std::ptrdiff_t>(to) + 1);
  const auto n = static_cast<double>(result.heights.size());
  double mean = 0.0;
  for (const double z : result.heights) mean += z / n;
  // The mean line of all is not exactly the mean of the evaluated part.
  for (double& z : result.heights) z -= mean;
  return result;
}

Result<Roughness> roughnessOf(const Section& section, const Stretch& within, const ProfileFilters& filters) {
  const auto found = roughnessProfile(section, within, filters);
  if (!found) return tl::unexpected(found.error());
  const std::vector<double>& profile = found->heights;
  Roughness result;
  result.evaluated = found->evaluated;
  result.lengths = found->lengths;
  const auto n = static_cast<double>(profile.size());
  double second = 0.0, third = 0.0, fourth = 0.0;
  for (const double z : profile) {
    result.ra += std::abs(z) / n;
    second += z * z / n;
    third += z * z * z / n;
    fourth += z * z * z * z / n;
  }
  result.rq = std::sqrt(second);
  result.rsk = second > 0.0 ? third / (second * result.rq) : std::numeric_limits<double>::quiet_NaN();
  result.rku = second > 0.0 ? fourth / (second * second) : std::numeric_limits<double>::quiet_NaN();
  for (std::size_t k = 0; k + 1 < found->lengths_begin.size(); ++k) {
    const auto low = static_cast<std::ptrdiff_t>(found->lengths_begin[k]),
               high = static_cast<std::ptrdiff_t>(found->lengths_begin[k + 1]);
    const auto [least, most] = std::minmax_element(profile.begin() + low, profile.begin() + high + 1);
    result.rz += (*most - *least) / result.lengths;
  }
  result.rsm = meanWidth(profile, section.step_mm, 0.1 * result.rz);
  return result;
}

}  // namespace fettle::engine
