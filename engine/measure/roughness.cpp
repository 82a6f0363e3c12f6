#include "engine/measure/roughness.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numbers>
#include <utility>

#include <fmt/format.h>

#include "engine/measure/profile_ratio.h"

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

// Mean over a profile by the trapezoidal rule, of one place and more.
double meanAlong(std::span<const double> profile, const auto& of) {
  if (profile.size() == 1) return of(profile.front());
  const double n = static_cast<double>(profile.size()) - 1.0;
  double sum = 0.5 * (of(profile.front()) + of(profile.back())) / n;
  for (const double z : profile.subspan(1, profile.size() - 2)) sum += of(z) / n;
  return sum;
}

// Elements: between crossings of the mean line that lead from beyond one threshold to beyond the other. Means of rising and
// of falling ones.
struct Elements {
  double width_mm = std::numeric_limits<double>::quiet_NaN(), height = width_mm;
};
Elements elementsOf(std::span<const double> heights, double step_mm, double threshold) {
  double width = 0.0, height = 0.0;
  int elements = 0;
  for (const double sign : {1.0, -1.0}) {
    bool below = false, begun = false;
    double crossing = 0.0, last = 0.0;
    std::size_t at = 0, from = 0;  // the place behind each crossing
    for (std::size_t i = 0; i < heights.size(); ++i) {
      const double z = sign * heights[i];
      if (i > 0 && z >= 0.0 && sign * heights[i - 1] < 0.0) {
        crossing = static_cast<double>(i) - z / (z - sign * heights[i - 1]);
        at = i;
      }
      if (z < -threshold) below = true;
      if (!(z > threshold && below)) continue;
      below = false;
      if (std::exchange(begun, true)) {
        const auto [least, most] = std::ranges::minmax(heights.subspan(from, at - from));
        width += (crossing - last) * step_mm;
        height += most - least;
        ++elements;
      }
      last = crossing;
      from = at;
    }
  }
  return elements > 0 ? Elements{width / elements, height / elements} : Elements();
}

double slopeOf(std::span<const double> z, double step_mm) {
  double squares = 0.0;
  for (std::size_t i = 3; i + 3 < z.size(); ++i) {
    const double slope =
        (45.0 * (z[i + 1] - z[i - 1]) - 9.0 * (z[i + 2] - z[i - 2]) + (z[i + 3] - z[i - 3])) /
        (60.0 * step_mm);
    squares += slope * slope;
  }
  return z.size() > 6 ? std::sqrt(squares / static_cast<double>(z.size() - 6))
                      : std::numeric_limits<double>::quiet_NaN();
}

// What is left of a profile by the half of a length that a filter lacks at both ends; how much that was.
std::size_t takeEndsOff(std::vector<double>& heights, double half_mm, double step_mm) {
  const std::size_t end =
      std::min(static_cast<std::size_t>(std::ceil(half_mm / step_mm - 1e-6)), heights.size() / 2);
  heights.erase(heights.begin(), heights.begin() + static_cast<std::ptrdiff_t>(end));
  heights.resize(heights.size() - end);
  return end;
}

constexpr ProfileInfo kProfiles[] = {
    {ProfileKind::kRoughness, "roughness", 'R', "waves shorter than the cut-off", true},
    {ProfileKind::kPrimary, "primary", 'P', "all but the line that is taken out, without a cut-off", false},
    {ProfileKind::kWaviness, "waviness", 'W', "waves longer than the cut-off", true},
};

using Unit = RoughnessInfo::Unit;

constexpr RoughnessInfo kRoughness[] = {
    {"ra", "Ra", Unit::kHeight, &Roughness::ra, "mean height, signs left out"},
    {"rq", "Rq", Unit::kHeight, &Roughness::rq, "root mean square height"},
    {"rz", "Rz", Unit::kHeight, &Roughness::rz, "mean of the section lengths' heights"},
    {"rzx", "Rzx", Unit::kHeight, &Roughness::rzx, "greatest height of a section length (Rmax)"},
    {"rp", "Rp", Unit::kHeight, &Roughness::rp, "mean of their highest peaks"},
    {"rv", "Rv", Unit::kHeight, &Roughness::rv, "mean of their deepest dales"},
    {"rt", "Rt", Unit::kHeight, &Roughness::rt, "height of the whole profile"},
    {"rc", "Rc", Unit::kHeight, &Roughness::rc, "mean height of the profile elements"},
    {"rsm", "RSm", Unit::kAlong, &Roughness::rsm, "mean width of the profile elements"},
    {"rsk", "Rsk", Unit::kNone, &Roughness::rsk, "skewness"},
    {"rku", "Rku", Unit::kNone, &Roughness::rku, "kurtosis"},
    {"rdq", "Rdq", Unit::kNone, &Roughness::rdq, "root mean square slope"},
    {"rk", "Rk", Unit::kHeight, &Roughness::rk, "core height"},
    {"rpk", "Rpk", Unit::kHeight, &Roughness::rpk, "reduced peak height"},
    {"rvk", "Rvk", Unit::kHeight, &Roughness::rvk, "reduced dale height"},
    {"rmrk1", "Rmrk1", Unit::kRatio, &Roughness::rmrk1, "material ratio of the peaks"},
    {"rmrk2", "Rmrk2", Unit::kRatio, &Roughness::rmrk2, "material ratio where the dales begin"},
};

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
  const double step = section.step_mm, lambda_s_mm = filters.lambda_s_mm;
  const bool primary = filters.kind == ProfileKind::kPrimary;
  const double cutoff_mm = primary ? 0.0 : filters.cutoff_mm;
  constexpr double kLeastPlaces = 4.0;
  const double least = kLeastPlaces * step;
  const auto is_short = [least](double length_mm) { return !(length_mm >= least * (1.0 - 1e-9)); };
  const bool short_cutoff = !primary && is_short(cutoff_mm);
  if (short_cutoff || (lambda_s_mm != 0.0 && is_short(lambda_s_mm)))
    return inputError(
        fmt::format("a {} of {:.6g} mm is shorter than 4 places of the section",
                    short_cutoff ? "cut-off" : "lambda s", short_cutoff ? cutoff_mm : lambda_s_mm),
        "section", fmt::format("give {:.6g} mm or more", least));
  if (!primary && !(lambda_s_mm < cutoff_mm))
    return inputError(fmt::format("a lambda s of {:.6g} mm leaves nothing below a cut-off of {:.6g} mm",
                                  lambda_s_mm, cutoff_mm),
                      "section", "give a shorter lambda s: a hundredth or a three-hundredth is usual");
  std::vector<double> heights(section.height.begin() + static_cast<std::ptrdiff_t>(run.from),
                              section.height.begin() + static_cast<std::ptrdiff_t>(run.to));
  takeLineOut(heights);
  std::size_t first = run.from;  // place of the section
  if (lambda_s_mm > 0.0) {
    heights = gaussianMeanLine(heights, step, lambda_s_mm);
    first += takeEndsOff(heights, 0.5 * lambda_s_mm, step);
  }
  const double length = heights.empty() ? 0.0 : static_cast<double>(heights.size() - 1) * step;
  const char* const left_out = lambda_s_mm > 0.0 ? " or an end of the S-filter" : "";
  if (primary && !(length >= (kLeastPlaces - 1.0) * step * (1.0 - 1e-9)))
    return inputError(fmt::format("the section has {} places without a hole{}, fewer than {:.0f}",
                                  heights.size(), left_out, kLeastPlaces),
                      "section", "give a longer line");
  if (!(length >= 2.0 * cutoff_mm * (1.0 - 1e-9)))
    return inputError(
        fmt::format("the section has {:.6g} mm without a hole{}, less than two cut-offs of {:.6g} mm", length,
                    left_out, cutoff_mm),
        "section", "give a longer line or a shorter cut-off");

  RoughnessProfile result;
  result.lengths = 1;
  std::size_t from = 0, to = heights.size() - 1;
  if (filters.kind == ProfileKind::kWaviness) {
    heights = gaussianMeanLine(heights, step, cutoff_mm);
    first += takeEndsOff(heights, 0.5 * cutoff_mm, step);
    to = heights.size() - 1;
  }
  if (filters.kind == ProfileKind::kRoughness) {
    const std::vector<double> line = gaussianMeanLine(heights, step, cutoff_mm);
    for (std::size_t i = 0; i < heights.size(); ++i) heights[i] -= line[i];
    result.lengths = static_cast<int>(std::floor((length - cutoff_mm) / cutoff_mm + 1e-6));
    // In the middle of the run.
    const double start = 0.5 * (length - result.lengths * cutoff_mm);
    const auto placeAt = [&](double at) {
      return std::min(heights.size() - 1, static_cast<std::size_t>(std::ceil(at / step - 1e-6)));
    };
    from = placeAt(start);
    to = placeAt(start + result.lengths * cutoff_mm);
    for (int k = 0; k <= result.lengths; ++k)
      result.lengths_begin.push_back(placeAt(start + k * cutoff_mm) - from);
  } else {
    result.lengths_begin = {from, to};
  }
  const double begin = section.along(first);
  result.evaluated = {begin + static_cast<double>(from) * step, begin + static_cast<double>(to) * step};
  result.heights.assign(heights.begin() + static_cast<std::ptrdiff_t>(from),
                        heights.begin() + static_cast<std::ptrdiff_t>(to) + 1);
  // The mean line of all is not exactly the mean of the evaluated part.
  const double mean = meanAlong(result.heights, [](double z) { return z; });
  for (double& z : result.heights) z -= mean;
  return result;
}

std::span<const ProfileInfo> profileInfos() noexcept {
  return kProfiles;
}

const ProfileInfo& profileInfo(ProfileKind kind) noexcept {
  return kProfiles[static_cast<std::size_t>(kind)];
}

std::span<const RoughnessInfo> roughnessInfos() noexcept {
  return kRoughness;
}

Result<Roughness> roughnessOf(const Section& section, const Stretch& within, const ProfileFilters& filters,
                              const AskedRatios& asked) {
  const auto found = roughnessProfile(section, within, filters);
  if (!found) return tl::unexpected(found.error());
  const std::vector<double>& profile = found->heights;
  Roughness result;
  result.evaluated = found->evaluated;
  result.lengths = found->lengths;
  const double second = meanAlong(profile, [](double z) { return z * z; });
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  result.ra = meanAlong(profile, [](double z) { return std::abs(z); });
  result.rq = std::sqrt(second);
  result.rsk =
      second > 0.0 ? meanAlong(profile, [](double z) { return z * z * z; }) / (second * result.rq) : kNone;
  result.rku =
      second > 0.0 ? meanAlong(profile, [](double z) { return z * z * z * z; }) / (second * second) : kNone;
  for (std::size_t k = 0; k + 1 < found->lengths_begin.size(); ++k) {
    const auto low = static_cast<std::ptrdiff_t>(found->lengths_begin[k]),
               high = static_cast<std::ptrdiff_t>(found->lengths_begin[k + 1]);
    const auto [least, most] = std::minmax_element(profile.begin() + low, profile.begin() + high + 1);
    result.rp += *most / result.lengths;
    result.rv -= *least / result.lengths;
    result.rzx = std::max(result.rzx, *most - *least);
  }
  result.rz = result.rp + result.rv;
  const auto [lowest, highest] = std::ranges::minmax(profile);
  result.rt = highest - lowest;
  const Elements elements = elementsOf(profile, section.step_mm, 0.1 * result.rz);
  result.rsm = elements.width_mm;
  result.rc = elements.height;
  result.rdq = slopeOf(profile, section.step_mm);
  std::vector<float> sorted(profile.begin(), profile.end());
  std::ranges::sort(sorted);
  const MaterialRatio ratio = materialRatio(sorted);
  result.rk = ratio.sk;
  result.rpk = ratio.spk;
  result.rvk = ratio.svk;
  result.rmrk1 = ratio.smrk1;
  result.rmrk2 = ratio.smrk2;
  result.ratios.reserve(asked.at_heights_mm.size());
  for (const double height : asked.at_heights_mm) result.ratios.push_back(materialRatioAt(profile, height));
  result.differences.reserve(asked.between.size());
  for (const RatioPair& pair : asked.between)
    result.differences.push_back(heightOfRatio(profile, pair.first) - heightOfRatio(profile, pair.second));
  return result;
}

}  // namespace fettle::engine
