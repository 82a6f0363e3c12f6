#include "engine/measure/section_figures.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <Eigen/Dense>
#include <glm/geometric.hpp>

namespace fettle::engine {

namespace {

constexpr double kDegrees = 180.0 / std::numbers::pi;
constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

// The places of a stretch that have a height.
std::vector<std::size_t> placesIn(const Section& section, const Stretch& stretch) {
  std::vector<std::size_t> places;
  // Ends that were typed as places include them.
  const double slack = 1e-6 * section.step_mm;
  for (std::size_t i = 0; i < section.size(); ++i)
    if (section.along(i) >= stretch.from_mm - slack && section.along(i) <= stretch.to_mm + slack &&
        !std::isnan(section.height[i]))
      places.push_back(i);
  return places;
}

// Least squares of a linear model: row i of `model` and `right` belongs to the height of places[i], whose errors it has
// by `gain`: the weight of a row is 1 / gain^2.
struct Solved {
  Eigen::VectorXd x;
  Eigen::MatrixXd covariance;  // of x, with the noise
  double rms = 0.0;            // of the residuals
};
struct LinearModel {
  const std::vector<std::size_t>& places;
  Eigen::MatrixXd rows;
  Eigen::VectorXd right;
  Eigen::VectorXd gain;
};

Solved solved(const Section& section, const LinearModel& model, const SectionNoise& noise) {
  const Eigen::Index n = model.rows.rows(), p = model.rows.cols();
  const Eigen::VectorXd root = model.gain.cwiseInverse();
  // Columns of one size: their units say nothing about what is determined.
  Eigen::MatrixXd scaled = root.asDiagonal() * model.rows;
  Eigen::VectorXd sizes(p);
  for (Eigen::Index j = 0; j < p; ++j) {
    sizes[j] = std::max(scaled.col(j).norm(), std::numeric_limits<double>::min());
    scaled.col(j) /= sizes[j];
  }
  const Eigen::MatrixXd normal = scaled.transpose() * scaled;
  const Eigen::MatrixXd half = normal.ldlt().solve(scaled.transpose() * root.asDiagonal());
  const Eigen::MatrixXd inverse = sizes.cwiseInverse().asDiagonal() * half;  // x = inverse * right
  Solved result;
  result.x = inverse * model.right;
  const Eigen::VectorXd residual = model.right - model.rows * result.x;
  result.rms = std::sqrt(residual.squaredNorm() / static_cast<double>(n));

  // Rows of the inverse over all places, as sums of heights.
  std::vector<std::vector<double>> sums(static_cast<std::size_t>(p),
                                        std::vector<double>(section.size(), 0.0));
  for (Eigen::Index j = 0; j < p; ++j)
    for (Eigen::Index i = 0; i < n; ++i)
      sums[static_cast<std::size_t>(j)][model.places[static_cast<std::size_t>(i)]] =
          inverse(j, i) * model.gain[i];
  result.covariance.resize(p, p);
  for (Eigen::Index j = 0; j < p; ++j)
    for (Eigen::Index k = j; k < p; ++k)
      result.covariance(j, k) = result.covariance(k, j) =
          section.covarianceOf(sums[static_cast<std::size_t>(j)], sums[static_cast<std::size_t>(k)]);

  // What noise of variance 1 leaves of weighted squares, and how many independent ones these are.
  const auto band = static_cast<std::size_t>(section.band);
  double squares = 0.0, trace = 0.0, pairs = 0.0;
  std::vector<bool> used(section.size(), false);
  for (const std::size_t i : model.places) used[i] = true;
  for (Eigen::Index i = 0; i < n; ++i) {
    const std::size_t at = model.places[static_cast<std::size_t>(i)];
    squares += residual[i] * residual[i] * root[i] * root[i];
    // Rows have the errors of heights times their gain, which their weight takes out again.
    trace += section.covariance[at * band];
    pairs += section.covariance[at * band] * section.covariance[at * band];
    for (std::size_t k = 1; k < band && at + k < section.size(); ++k)
      if (used[at + k]) pairs += 2.0 * section.covariance[at * band + k] * section.covariance[at * band + k];
  }
  const Eigen::MatrixXd whole = sizes.asDiagonal() * normal * sizes.asDiagonal();
  const double left = trace - (whole * result.covariance).trace();
  const double freedom = std::max(1.0, trace * trace / pairs - static_cast<double>(p));
  // The same of noise of whole rows and columns. What all heights have in common no fit leaves.
  Eigen::MatrixXd by_lines = Eigen::MatrixXd::Zero(p, p);
  double lines_left = 0.0, lines_scatter = 0.0;
  if (noise.rows_mm > 0.0 || noise.columns_mm > 0.0) {
    const Section::LineCovariance lines = section.lineCovariance(sums);
    const auto add = [&](const std::vector<double>& of, double heights, int met, double mm) {
      const Eigen::MatrixXd part =
          mm * mm * Eigen::Map<const Eigen::MatrixXd>(of.data(), p, p);  // symmetrical
      by_lines += part;
      const double rest = std::max(0.0, mm * mm * heights - (whole * part).trace());
      lines_left += rest;
      lines_scatter += 2.0 * rest * rest / std::max(1.0, met - static_cast<double>(p));
    };
    add(lines.rows, lines.heights.rows, lines.rows_met, noise.rows_mm);
    add(lines.columns, lines.heights.columns, lines.columns_met, noise.columns_mm);
  }
  double variance = noise.sample_mm * noise.sample_mm;
  // A fit through as many heights as it has numbers leaves nothing that could be compared.
  if (left > 1e-9 * trace) {
    const double of_samples = variance * left;
    const double scatter = std::sqrt(2.0 * of_samples * of_samples / freedom + lines_scatter);
    if (std::isnan(variance) || squares > of_samples + lines_left + 3.0 * scatter)
      variance = std::max(0.0, squares - lines_left) / left;
  }
  result.covariance = variance * result.covariance + by_lines;
  return result;
}

double errorOf(const Solved& fit, Eigen::Index i) {
  return std::sqrt(std::max(0.0, fit.covariance(i, i)));
}

double inclinationDeg(double slope) noexcept {
  return std::atan(slope) * kDegrees;
}
// Standard error of it, from that of the slope.
double inclinationError(double slope, double error) noexcept {
  return error / (1.0 + slope * slope) * kDegrees;
}

Eigen::VectorXd heightsOf(const Section& section, const std::vector<std::size_t>& places) {
  Eigen::VectorXd heights(static_cast<Eigen::Index>(places.size()));
  for (std::size_t i = 0; i < places.size(); ++i)
    heights[static_cast<Eigen::Index>(i)] = section.height[places[i]];
  return heights;
}

double middleOf(const Stretch& stretch) noexcept {
  return 0.5 * (stretch.from_mm + stretch.to_mm);
}

std::string shown(const Stretch& stretch) {
  return fmt::format("{:.6g} to {:.6g} mm", stretch.from_mm, stretch.to_mm);
}

tl::unexpected<Error> tooFew(const Stretch& stretch, std::size_t found, int needed) {
  return inputError(fmt::format("{} heights from {} of the section are too few, {} are needed", found,
                                shown(stretch), needed),
                    "section", "give a longer stretch");
}

// Mean of the places of a stretch: heights there and slopes are independent.
double meanAlong(const Section& section, const std::vector<std::size_t>& places) noexcept {
  double sum = 0.0;
  for (const std::size_t i : places) sum += section.along(i);
  return sum / static_cast<double>(places.size());
}

struct LinePart {
  std::vector<std::size_t> places;
  double middle = 0.0;
};

// What of a stretch lies on the section: beyond its ends there is nothing to be in the middle of.
Stretch onSection(const Section& section, const Stretch& stretch) {
  return {std::max(stretch.from_mm, 0.0), std::min(stretch.to_mm, section.lengthMm())};
}

LineFigures figuresOf(const Solved& fit, Eigen::Index first, const Stretch& stretch, const LinePart& part) {
  const double slope = fit.x[first + 1], away = middleOf(stretch) - part.middle;
  LineFigures line;
  line.slope = {slope, errorOf(fit, first + 1)};
  line.inclination_deg = {inclinationDeg(slope), inclinationError(slope, line.slope.error)};
  const double variance = fit.covariance(first, first) + 2.0 * away * fit.covariance(first, first + 1) +
                          away * away * fit.covariance(first + 1, first + 1);
  line.height_mm = {fit.x[first] + slope * away, std::sqrt(std::max(0.0, variance))};
  line.rms_mm = fit.rms;
  line.places = static_cast<int>(part.places.size());
  return line;
}

// Lines of several stretches as one model: what their heights have in common counts once.
Result<Solved> linesThrough(const Section& section, const std::vector<Stretch>& stretches,
                            std::vector<LinePart>& parts, const SectionNoise& noise) {
  constexpr int kLeast = 3;
  std::vector<std::size_t> all;
  for (const Stretch& stretch : stretches) {
    LinePart part{placesIn(section, stretch), 0.0};
    if (part.places.size() < kLeast) return tooFew(stretch, part.places.size(), kLeast);
    part.middle = meanAlong(section, part.places);
    all.insert(all.end(), part.places.begin(), part.places.end());
    parts.push_back(std::move(part));
  }
  const auto n = static_cast<Eigen::Index>(all.size());
  LinearModel model{all, Eigen::MatrixXd::Zero(n, static_cast<Eigen::Index>(2 * parts.size())),
                    heightsOf(section, all), Eigen::VectorXd::Ones(n)};
  Eigen::Index row = 0, column = 0;
  for (const LinePart& part : parts) {
    for (const std::size_t i : part.places) {
      model.rows(row, column) = 1.0;
      model.rows(row++, column + 1) = section.along(i) - part.middle;
    }
    column += 2;
  }
  return solved(section, model, noise);
}

// Two parallel lines: z = a + b x + h d, d = 1 on the far stretch.
Result<StepFigures> parallelLines(const Section& section, const std::vector<Stretch>& outside,
                                  const Stretch& inside, const SectionNoise& noise) {
  constexpr int kLeast = 2;
  std::vector<std::size_t> all;
  std::size_t far_from = 0;
  const auto take = [&](const Stretch& stretch) -> Status {
    const std::vector<std::size_t> places = placesIn(section, stretch);
    if (places.size() < kLeast) return tooFew(stretch, places.size(), kLeast);
    all.insert(all.end(), places.begin(), places.end());
    return {};
  };
  for (const Stretch& stretch : outside)
    if (auto status = take(stretch); !status) return tl::unexpected(status.error());
  far_from = all.size();
  if (auto status = take(inside); !status) return tl::unexpected(status.error());
  const auto n = static_cast<Eigen::Index>(all.size());
  const double middle = meanAlong(section, all);
  LinearModel model{all, Eigen::MatrixXd::Zero(n, 3), heightsOf(section, all), Eigen::VectorXd::Ones(n)};
  for (Eigen::Index i = 0; i < n; ++i) {
    const auto at = static_cast<std::size_t>(i);
    model.rows(i, 0) = 1.0;
    model.rows(i, 1) = section.along(all[at]) - middle;
    model.rows(i, 2) = at < far_from ? 0.0 : 1.0;
  }
  const Solved fit = solved(section, model, noise);
  const double slope = fit.x[1], cosine = 1.0 / std::hypot(1.0, slope);
  // Across the lines: h cos(atan b), with both errors.
  const double by_slope = -fit.x[2] * slope * cosine * cosine * cosine;
  const double variance = cosine * cosine * fit.covariance(2, 2) +
                          2.0 * cosine * by_slope * fit.covariance(1, 2) +
                          by_slope * by_slope * fit.covariance(1, 1);
  StepFigures figures;
  figures.step_mm = {fit.x[2] * cosine, std::sqrt(std::max(0.0, variance))};
  figures.inclination_deg = {inclinationDeg(slope), inclinationError(slope, errorOf(fit, 1))};
  figures.rms_mm = fit.rms;
  figures.places = static_cast<int>(all.size());
  return figures;
}

// Sums over the first places that have a height, for lines with an offset between two of them.
struct OffsetSums {
  double n = 0.0, x = 0.0, z = 0.0, xx = 0.0, xz = 0.0, zz = 0.0;
};
class OffsetSearch {
 public:
  OffsetSearch(const Section& section, std::vector<std::size_t> places)
      : section_(section), places_(std::move(places)), sums_(places_.size() + 1) {
    if (places_.empty()) return;
    // From the first height and the middle: heights may be far from 0.
    const double base = section.height[places_.front()], middle = meanAlong(section, places_);
    for (std::size_t i = 0; i < places_.size(); ++i) {
      const double x = section.along(places_[i]) - middle, z = section.height[places_[i]] - base;
      const OffsetSums& s = sums_[i];
      sums_[i + 1] = {s.n + 1.0, s.x + x, s.z + z, s.xx + x * x, s.xz + x * z, s.zz + z * z};
    }
  }
  [[nodiscard]] std::size_t size() const noexcept { return places_.size(); }
  // How much of the squares an offset of the places [from, to) takes, beside a common line.
  [[nodiscard]] double gain(std::size_t from, std::size_t to) const noexcept {
    const OffsetSums &a = sums_[from], &b = sums_[to], &all = sums_.back();
    const double n = b.n - a.n;
    if (n < 1.0 || all.n - n < 1.0) return 0.0;
    // The indicator and the heights less their lines over all places.
    const double sxx = all.xx - all.x * all.x / all.n;
    const double sdx = (b.x - a.x) - n * all.x / all.n, sdd = n - n * n / all.n;
    const double sdz = (b.z - a.z) - n * all.z / all.n, sxz = all.xz - all.x * all.z / all.n;
    const double own = sdd - (sxx > 0.0 ? sdx * sdx / sxx : 0.0);
    const double with = sdz - (sxx > 0.0 ? sdx * sxz / sxx : 0.0);
    return own > 1e-9 * n ? with * with / own : 0.0;
  }
  // The sum of squares about the line through all.
  [[nodiscard]] double aboutLine() const noexcept {
    const OffsetSums& all = sums_.back();
    const double sxx = all.xx - all.x * all.x / all.n, sxz = all.xz - all.x * all.z / all.n;
    return all.zz - all.z * all.z / all.n - (sxx > 0.0 ? sxz * sxz / sxx : 0.0);
  }
  // Between place i - 1 and place i.
  [[nodiscard]] double edgeAt(std::size_t i) const noexcept {
    return 0.5 * (section_.along(places_[i - 1]) + section_.along(places_[i]));
  }

 private:
  const Section& section_;
  std::vector<std::size_t> places_;
  std::vector<OffsetSums> sums_;
};

}  // namespace

Result<LineFigures> lineFigures(const Section& section, const Stretch& stretch, const SectionNoise& noise) {
  std::vector<LinePart> parts;
  const auto fit = linesThrough(section, {stretch}, parts, noise);
  if (!fit) return tl::unexpected(fit.error());
  return figuresOf(*fit, 0, onSection(section, stretch), parts.front());
}

Result<AngleFigures> angleFigures(const Section& section, const Stretch& first, const Stretch& second,
                                  const SectionNoise& noise) {
  std::vector<LinePart> parts;
  const auto fit = linesThrough(section, {first, second}, parts, noise);
  if (!fit) return tl::unexpected(fit.error());
  AngleFigures figures;
  figures.first = figuresOf(*fit, 0, onSection(section, first), parts[0]);
  figures.second = figuresOf(*fit, 2, onSection(section, second), parts[1]);
  const double a = fit->x[1], b = fit->x[3];
  const double by_a = -1.0 / (1.0 + a * a), by_b = 1.0 / (1.0 + b * b);
  const double variance = by_a * by_a * fit->covariance(1, 1) + 2.0 * by_a * by_b * fit->covariance(1, 3) +
                          by_b * by_b * fit->covariance(3, 3);
  const double error = std::sqrt(std::max(0.0, variance)) * kDegrees;
  figures.turn_deg = {inclinationDeg(b) - inclinationDeg(a), error};
  figures.included_deg = {180.0 - std::abs(figures.turn_deg.value), error};
  figures.meet_along_mm = figures.meet_height_mm = {kUnknown, kUnknown};
  if (a != b) {
    const double at = (fit->x[0] - a * parts[0].middle - fit->x[2] + b * parts[1].middle) / (b - a);
    // How the place follows heights and slopes of both lines; the height follows as on the first one.
    const double first_away = at - parts[0].middle, second_away = at - parts[1].middle;
    const Eigen::Vector4d along = Eigen::Vector4d(1.0, first_away, -1.0, -second_away) / (b - a);
    const Eigen::Vector4d height = Eigen::Vector4d(1.0, first_away, 0.0, 0.0) + a * along;
    figures.meet_along_mm = {at, std::sqrt(std::max(0.0, along.dot(fit->covariance * along)))};
    figures.meet_height_mm = {fit->x[0] + a * first_away,
                              std::sqrt(std::max(0.0, height.dot(fit->covariance * height)))};
  }
  return figures;
}

Result<StepFigures> stepFigures(const Section& section, double edge_mm, const Stretch& within,
                                const SectionNoise& noise) {
  const double low = std::max(0.0, within.from_mm), high = std::min(section.lengthMm(), within.to_mm);
  const double width = std::min(edge_mm - low, high - edge_mm);
  if (!(width > 0.0))
    return inputError(fmt::format("an edge at {:.6g} mm has no surface on both sides", edge_mm), "section",
                      fmt::format("give one between {:.6g} and {:.6g}", low, high));
  const Stretch before{edge_mm - width, edge_mm - width / 3.0}, after{edge_mm + width / 3.0, edge_mm + width};
  auto figures = parallelLines(section, {before}, after, noise);
  if (!figures) return figures;
  figures->before = before;
  figures->edge_after = after;
  return figures;
}

Result<StepFigures> grooveFigures(const Section& section, double first_mm, double second_mm,
                                  const SectionNoise& noise) {
  const double width = second_mm - first_mm;
  if (!(width > 0.0))
    return inputError("the edges of a groove are not in order", "section", "give the nearer one first");
  // As long as the section is: what is stated is what counts.
  const Stretch before{std::max(0.0, first_mm - width), first_mm - width / 3.0};
  const Stretch inside{first_mm + width / 3.0, second_mm - width / 3.0};
  const Stretch behind{second_mm + width / 3.0, std::min(section.lengthMm(), second_mm + width)};
  auto figures = parallelLines(section, {before, behind}, inside, noise);
  if (!figures) return figures;
  figures->step_mm.value = -figures->step_mm.value;
  figures->before = before;
  figures->edge_after = inside;
  figures->behind = behind;
  return figures;
}

double edgeIn(const Section& section, const Stretch& within) noexcept {
  const OffsetSearch search(section, placesIn(section, within));
  if (search.size() < 4) return kUnknown;
  std::size_t best = 2;
  for (std::size_t i = 2; i + 2 <= search.size(); ++i)
    if (search.gain(i, search.size()) > search.gain(best, search.size())) best = i;
  return search.edgeAt(best);
}

Stretch grooveIn(const Section& section, const Stretch& within) {
  const OffsetSearch search(section, placesIn(section, within));
  const std::size_t n = search.size();
  // Two heights in its central third, two outside beyond a third on either side.
  constexpr std::size_t kNarrowest = 6, kBeside = 5;
  if (n < kNarrowest + 2 * kBeside) return {kUnknown, kUnknown};
  constexpr std::size_t kCoarse = 256;
  const std::size_t stride = std::max<std::size_t>(1, n / kCoarse);
  std::pair<std::size_t, std::size_t> best{n / 2 - kNarrowest / 2, n / 2 + kNarrowest / 2};
  const auto better = [&](std::size_t from, std::size_t to) {
    // Beside both edges there is a surface, beyond the third of the width that does not count.
    const std::size_t left_out = (to - from) / 3 + 3;
    if (to - from < kNarrowest || from < left_out || n - to < left_out) return;
    if (search.gain(from, to) > search.gain(best.first, best.second)) best = {from, to};
  };
  for (std::size_t from = kBeside; from + kNarrowest <= n; from += stride)
    for (std::size_t to = from + kNarrowest; to + kBeside <= n; to += stride) better(from, to);
  // One end, then the other, each place around the coarse one.
  for (int round = 0; round < 4; ++round) {
    const auto [from, to] = best;
    for (std::size_t i = std::max<std::size_t>(2, from - std::min(from, stride));
         i <= from + stride && i + 2 <= to; ++i)
      better(i, best.second);
    for (std::size_t i = std::max(best.first + 2, to - std::min(to, stride)); i <= to + stride && i + 2 <= n;
         ++i)
      better(best.first, i);
  }
  const double gain = search.gain(best.first, best.second);
  double one_edge = 0.0;
  for (std::size_t i = 2; i + 2 <= n; ++i) one_edge = std::max(one_edge, search.gain(i, n));
  const double left = std::max(0.0, search.aboutLine() - gain);
  if (!(gain - one_edge > 25.0 * left / static_cast<double>(n))) return {kUnknown, kUnknown};
  return {search.edgeAt(best.first), search.edgeAt(best.second)};
}

Result<CursorFigures> cursorFigures(const Section& section, double first_mm, double second_mm,
                                    const SectionNoise& noise) {
  std::vector<double> weights(section.size(), 0.0);
  std::array<glm::dvec2, 2> place{};
  std::array<double, 2> height{};
  const std::array<double, 2> at{first_mm, second_mm};
  for (std::size_t k = 0; k < 2; ++k) {
    if (!(at[k] >= -1e-6 * section.step_mm && at[k] <= section.lengthMm() * (1.0 + 1e-9)))
      return inputError(fmt::format("a cursor at {:.6g} mm is not on the section", at[k]), "section",
                        fmt::format("give 0 to {:.6g}", section.lengthMm()));
    const double index = std::clamp(at[k] / section.step_mm, 0.0, static_cast<double>(section.size() - 1));
    const auto low = std::min(static_cast<std::size_t>(index), section.size() - 2);
    double part = index - static_cast<double>(low);
    if (std::abs(part - std::round(part)) < 1e-6) part = std::round(part);
    for (const auto& [i, weight] : {std::pair(low, 1.0 - part), std::pair(low + 1, part)}) {
      if (weight == 0.0) continue;
      if (std::isnan(section.height[i]))
        return inputError(k == 0 ? "the first cursor is over a hole" : "the second cursor is over a hole",
                          "section", "set it beside the hole");
      height[k] += weight * section.height[i];
      weights[i] += k == 0 ? -weight : weight;
    }
    place[k] = section.position[low] * (1.0 - part) + section.position[low + 1] * part;
  }
  CursorFigures figures;
  figures.first_mm = height[0];
  figures.second_mm = height[1];
  figures.dx_mm = second_mm - first_mm;
  double variance = noise.sample_mm * noise.sample_mm * std::max(0.0, section.variance(weights));
  if (noise.rows_mm > 0.0 || noise.columns_mm > 0.0) {
    const Section::LineVariance lines = section.lineVariance(weights);
    variance +=
        noise.rows_mm * noise.rows_mm * lines.rows + noise.columns_mm * noise.columns_mm * lines.columns;
  }
  figures.dz_mm = {height[1] - height[0], std::sqrt(variance)};
  figures.slope_deg = figures.dx_mm == 0.0 ? kUnknown : inclinationDeg(figures.dz_mm.value / figures.dx_mm);
  figures.distance_mm = std::hypot(glm::length(place[1] - place[0]), figures.dz_mm.value);
  return figures;
}

// The circle by its height p, direction f and curvature k at the middle of the stretch: with q = (x, z - p) and the normal
// n = (-sin f, cos f), the distance of a point from it is d = A / (1 + sqrt(1 + k A)), A = k |q|^2 - 2 q n, without the
// cancellation of |q - n / k| - 1 / |k| (the form of N. Chernov, Circular and linear regression, 2010, section 3).
Result<ArcFigures> arcFigures(const Section& section, const Stretch& stretch, const SectionNoise& noise) {
  constexpr int kLeast = 4;
  const std::vector<std::size_t> places = placesIn(section, stretch);
  if (places.size() < kLeast) return tooFew(stretch, places.size(), kLeast);
  const auto n = static_cast<Eigen::Index>(places.size());
  const double middle = 0.5 * (section.along(places.front()) + section.along(places.back()));
  Eigen::VectorXd heights = heightsOf(section, places);
  const double base = heights.mean();
  heights.array() -= base;
  Eigen::VectorXd x(n);
  for (Eigen::Index i = 0; i < n; ++i) x[i] = section.along(places[static_cast<std::size_t>(i)]) - middle;

  Eigen::MatrixXd rows(n, 3);
  Eigen::VectorXd distance(n), gain(n);
  const auto evaluate = [&](const Eigen::Vector3d& at) {
    const double sine = std::sin(at[1]), cosine = std::cos(at[1]), k = at[2];
    double cost = 0.0;
    for (Eigen::Index i = 0; i < n; ++i) {
      const double z = heights[i] - at[0], square = x[i] * x[i] + z * z;
      const double a = k * square - 2.0 * (cosine * z - sine * x[i]);
      const double s = std::sqrt(std::max(1e-12, 1.0 + k * a));
      distance[i] = a / (1.0 + s);
      rows(i, 0) = (cosine - k * z) / s;
      rows(i, 1) = (x[i] * cosine + z * sine) / s;
      rows(i, 2) = square / (2.0 * s) - a * a / (2.0 * s * (1.0 + s) * (1.0 + s));
      // How much of an error of the height is one of the distance; steeper than 84 degrees it is taken as there.
      gain[i] = std::max(std::abs(cosine - k * z) / s, 0.1);
      cost += distance[i] * distance[i] / (gain[i] * gain[i]);
    }
    return cost;
  };
  // Starts: the parabola, and the circle of algebraic distances (I. Kasa, 1976) for more than a short arc.
  Eigen::MatrixXd parabola(n, 3), algebraic(n, 3);
  for (Eigen::Index i = 0; i < n; ++i) {
    parabola.row(i) << 1.0, x[i], x[i] * x[i];
    algebraic.row(i) << 1.0, x[i], heights[i];
  }
  const Eigen::Vector3d bent = parabola.colPivHouseholderQr().solve(heights);
  const double direction = std::atan(bent[1]);
  std::vector<Eigen::Vector3d> starts{{bent[0], direction, 2.0 * bent[2] * std::pow(std::cos(direction), 3)}};
  const Eigen::Vector3d circle =
      algebraic.colPivHouseholderQr().solve((x.array().square() + heights.array().square()).matrix());
  const double cx = 0.5 * circle[1], cz = 0.5 * circle[2], square = circle[0] + cx * cx + cz * cz;
  if (square > cx * cx) {
    const double radius = std::sqrt(square), up = heights.mean() < cz ? 1.0 : -1.0;
    // The normal points from the place at x = 0 to the centre of a hollow circle, away from that of another.
    starts.push_back({cz - up * std::sqrt(square - cx * cx),
                      std::asin(std::clamp(-up * cx / radius, -1.0, 1.0)), up / radius});
  }
  Eigen::Vector3d at = starts.front();
  double cost = evaluate(at);
  for (const Eigen::Vector3d& start : starts)
    if (const double other = evaluate(start); other < cost) {
      at = start;
      cost = other;
    }
  double damping = 1e-4;
  for (int round = 0; round < 200; ++round) {
    cost = evaluate(at);
    const Eigen::MatrixXd weighted = gain.cwiseInverse().asDiagonal() * rows;
    const Eigen::Matrix3d normal = weighted.transpose() * weighted;
    const Eigen::Vector3d downhill = weighted.transpose() * (gain.cwiseInverse().asDiagonal() * distance);
    bool moved = false;
    double size = 0.0;
    while (!moved && damping < 1e12) {
      Eigen::Matrix3d damped = normal;
      damped.diagonal() *= 1.0 + damping;
      const Eigen::Vector3d step = -damped.ldlt().solve(downhill);
      moved = evaluate(at + step) <= cost;
      if (moved) {
        at += step;
        size = (step.array() * normal.diagonal().array().sqrt()).matrix().norm();
      }
      damping *= moved ? 0.1 : 10.0;
    }
    if (!moved || size <= 1e-12 * std::sqrt(cost) + 1e-300) break;
  }
  evaluate(at);
  const Solved fit = solved(section, {places, rows, -distance, gain}, noise);
  const double error = errorOf(fit, 2), curvature = at[2];
  if (!(std::abs(curvature) > 3.0 * error) || !std::isfinite(1.0 / curvature))
    return inputError(
        fmt::format("from {} the section shows no curvature that stands out from its noise", shown(stretch)),
        "section", "give a longer stretch, or average across a width");
  ArcFigures figures;
  figures.radius_mm = {1.0 / std::abs(curvature), error / (curvature * curvature)};
  figures.hollow = curvature > 0.0;
  const double sine = std::sin(at[1]), cosine = std::cos(at[1]);
  // Centre = (0, p) + n / k, and how it follows p, f and k.
  const Eigen::Vector3d along(0.0, -cosine / curvature, sine / (curvature * curvature));
  const Eigen::Vector3d height(1.0, -sine / curvature, -cosine / (curvature * curvature));
  figures.centre_along_mm = {middle - sine / curvature, std::sqrt(along.dot(fit.covariance * along))};
  figures.centre_height_mm = {base + at[0] + cosine / curvature,
                              std::sqrt(height.dot(fit.covariance * height))};
  figures.rms_mm = std::sqrt(distance.squaredNorm() / static_cast<double>(n));
  figures.places = static_cast<int>(places.size());
  return figures;
}

}  // namespace fettle::engine
