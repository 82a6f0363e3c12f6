#include "engine/edges/edge_profile.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <numbers>

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <glm/geometric.hpp>

#include "engine/edges/sides.h"
#include "engine/edges/surroundings.h"

namespace fettle::engine {

namespace {

constexpr double kSectionDepths[] = {10.0, 7.0, 5.0,
                                     4.0};  // of the surfaces [samples], the first that fits counts
constexpr double kSectionGuard = 0.75;      // samples nearer to the line may lie on either side
constexpr double kSharedNoise = 1.3;        // of the variance: neighbouring samples share some noise
constexpr double kFitsNoPlane = 1.5;        // residual variance over that of the noise
constexpr double kStandsOut = 3.5;          // of a surface [standard deviations]
constexpr int kRoundsOfMisfits = 3;
constexpr int kTangentPointsHalf = 3;
constexpr double kDegrees = 180.0 / std::numbers::pi;

Polyline polylineAt(const EdgeLine& line, glm::dvec2 origin) {
  Polyline polyline;
  polyline.closed = line.closed;
  polyline.period = static_cast<double>(line.points.size());
  for (const EdgePoint& point : line.points) {
    polyline.origins.push_back(static_cast<double>(polyline.points.size()));
    polyline.points.push_back(point.position - origin);
  }
  return polyline;
}

glm::dvec2 lowestSample(const std::vector<EdgeLine>& lines) {
  glm::dvec2 low(HUGE_VAL);
  for (const EdgeLine& line : lines)
    for (const EdgePoint& point : line.points) low = glm::min(low, point.position);
  return glm::floor(low);
}

// The samples up to `depth` from a line that follows the strip's own points.
StripLine lineOf(std::size_t points, double depth) {
  const auto reach = static_cast<float>(depth);
  return {std::vector<double>(points, 0.0), std::vector<double>(points, 0.0),
          std::vector<Extent>(points, {-reach, reach})};
}

// Inclination of a fitted surface across a line, in radians, and its variance for noise of variance 1.
struct Inclination {
  double angle, variance;
};

// How slopes along the strip's axes, in height units per sample, become a slope across the line in millimetres.
class Across {
 public:
  Across(const Grid& grid, glm::dvec2 tangent) {
    const glm::dvec2 spacing(grid.spacingXMm(), grid.spacingYMm());
    const glm::dvec2 along = glm::normalize(tangent * spacing);
    const glm::dvec2 per_mm = glm::dvec2(-along.y, along.x) / spacing * grid.height_unit.mm;
    d_ = glm::dot(per_mm, glm::dvec2(-tangent.y, tangent.x));
    s_ = glm::dot(per_mm, tangent);
  }
  // By how much it rises with the height of a sample at (d, s).
  [[nodiscard]] double weightOf(const PlaneFit& plane, double d, double s) const noexcept {
    const double x = d - plane.centre_d, y = s - plane.centre_s;
    const double slope = d_ * plane.slope_d + s_ * plane.slope_s;
    return (d_ * (plane.inverse_dd * x + plane.inverse_ds * y) +
            s_ * (plane.inverse_ds * x + plane.inverse_ss * y)) /
           (1.0 + slope * slope);
  }
  [[nodiscard]] Inclination of(const PlaneFit& plane) const noexcept {
    const double slope = d_ * plane.slope_d + s_ * plane.slope_s;
    const double variance =
        d_ * d_ * plane.inverse_dd + 2.0 * d_ * s_ * plane.inverse_ds + s_ * s_ * plane.inverse_ss;
    const double per_slope = 1.0 / (1.0 + slope * slope);
    return {std::atan(slope), variance * per_slope * per_slope};
  }

 private:
  double d_, s_;
};

// A line with the strip of samples along it, which refers to its neighbours.
struct MeasuredStrip {
  const Polyline& line;
  Strip strip;
  std::vector<OffsetRange> ranges;
};

MeasuredStrip stripOf(const std::vector<Polyline>& lines, std::size_t number, const LineIndex& index,
                      SampleWindow& window) {
  const Polyline& line = lines[number];
  MeasuredStrip measured{line, stripAlong(line, window, kSectionDepths[0], kTangentPointsHalf), {}};
  const LineNeighbours neighbours =
      neighboursOf(index, static_cast<int>(number), measured.strip.tangents, measured.strip.depth);
  const std::vector<bool> known(lines.size(), true);
  for (const Surroundings& here : surroundingsOf(line, neighbours, Stage::kRefine, false, known))
    measured.ranges.push_back(here.range);
  return measured;
}

// Samples that neither surface at a line explains, as mixed pixels, are not kept from now on: those that stand out of the
// surface's own scatter. A few of them hide others: in rounds.
void dropMisfits(const MeasuredStrip& along, double noise, SampleWindow& window) {
  const StripLine reach = lineOf(along.line.points.size(), kSectionDepths[0]);
  const SideContext context{along.line, along.strip, window, along.ranges, EdgeMeans::kHalf, noise * noise};
  for (int i = 0; i < along.line.size(); ++i) {
    const Sides sides = sidesAt(context, reach, i, kSectionGuard);
    if (!sides.supported()) continue;
    for (const StripSample& sample : along.strip.at(i)) {
      const PlaneFit& side = sample.d > 0.0 ? sides.left : sides.right;
      SampleWindow::Sample& known = window.at(sample.index);
      const double off = std::abs(sample.z - side.at(sample.d, sample.s));
      const double most = kStandsOut * std::max(noise, std::sqrt(side.variance()));
      known.misfit = std::min(known.misfit, off <= most ? 1.0F : 1e3F);
    }
  }
}

// The scatter of the samples about the surfaces at the points of the lines: the median of the better sides. [height_unit]
double scatterOf(const std::vector<MeasuredStrip>& strips, const SampleWindow& window) {
  std::vector<double> scatter;
  for (const MeasuredStrip& along : strips) {
    const StripLine reach = lineOf(along.line.points.size(), kSectionDepths[std::size(kSectionDepths) - 1]);
    const SideContext context{along.line, along.strip, window, along.ranges, EdgeMeans::kHalf, 0.0};
    for (int i = 0; i < along.line.size(); i += EdgeMeans::kHalf) {
      const Sides sides = sidesAt(context, reach, i, kSectionGuard);
      if (sides.supported())
        scatter.push_back(std::sqrt(std::min(sides.left.variance(), sides.right.variance())));
    }
  }
  if (scatter.empty()) return 0.0;
  const auto middle = scatter.begin() + static_cast<std::ptrdiff_t>(scatter.size() / 2);
  std::nth_element(scatter.begin(), middle, scatter.end());
  return *middle;
}

// A step and a turn, or what they rise with.
struct StepAndTurn {
  double step = 0.0, turn = 0.0;
};

// How what whole rows are off, or whole columns, enters the sections of a line and their means.
class OffsetShares {
 public:
  // `axis`: 1 for rows, 0 for columns.
  OffsetShares(const Polyline& line, int axis) : axis_(axis) {
    double low = HUGE_VAL, high = -HUGE_VAL;
    for (const glm::dvec2& point : line.points) {
      low = std::min(low, point[axis]);
      high = std::max(high, point[axis]);
    }
    const double margin = kSectionDepths[0] + 2.0;
    first_ = static_cast<int>(std::floor(low - margin));
    all_.resize(static_cast<std::size_t>(std::ceil(high + margin) - first_) + 1);
    section_.resize(all_.size());
    low_ = all_.size();
  }
  void add(const StripSample& sample, const StepAndTurn& weight) {
    const int number = (axis_ == 1 ? sample.row : sample.column) - first_;
    const auto at = static_cast<std::size_t>(std::clamp(number, 0, static_cast<int>(all_.size()) - 1));
    section_[at].step += weight.step;
    section_[at].turn += weight.turn;
    low_ = std::min(low_, at);
    high_ = std::max(high_, at);
  }
  // Ends a section: variances of its figures for offsets of variance 1.
  StepAndTurn endSection() {
    StepAndTurn squares;
    for (std::size_t at = low_; at <= high_ && at < all_.size(); ++at) {
      addSquares(section_[at], squares);
      all_[at].step += section_[at].step;
      all_[at].turn += section_[at].turn;
      section_[at] = {};
    }
    low_ = all_.size();
    high_ = 0;
    return squares;
  }
  // The same of the sums over all sections.
  [[nodiscard]] StepAndTurn ofSums() const noexcept {
    StepAndTurn squares;
    for (const StepAndTurn& weight : all_) addSquares(weight, squares);
    return squares;
  }

 private:
  static void addSquares(const StepAndTurn& weight, StepAndTurn& squares) noexcept {
    squares.step += weight.step * weight.step;
    squares.turn += weight.turn * weight.turn;
  }

  int axis_, first_ = 0;
  std::vector<StepAndTurn> section_, all_;  // weights, from row or column first_ on
  std::size_t low_ = 0, high_ = 0;          // of what the section has
};

EdgeMeans meansOf(const std::vector<EdgeSection>& sections) noexcept {
  EdgeMeans means;
  double step_squares = 0.0, turn_squares = 0.0;  // of the deviations
  double step_spread = 0.0, turn_spread = 0.0;    // squares of the values
  for (const EdgeSection& section : sections) {
    if (!section.measured) continue;
    if (means.measured++ == 0) {
      means.step_low = means.step_high = section.step;
      means.turn_low = means.turn_high = section.turn;
    }
    means.step += section.step;
    means.turn += section.turn;
    means.step_low = std::min(means.step_low, section.step);
    means.step_high = std::max(means.step_high, section.step);
    means.turn_low = std::min(means.turn_low, section.turn);
    means.turn_high = std::max(means.turn_high, section.turn);
    step_squares += section.step_deviation * section.step_deviation;
    turn_squares += section.turn_deviation * section.turn_deviation;
  }
  if (means.measured == 0) return means;
  for (const EdgeSection& section : sections) {
    if (!section.measured) continue;
    step_spread += std::pow(section.step - means.step / means.measured, 2);
    turn_spread += std::pow(section.turn - means.turn / means.measured, 2);
  }
  const double n = means.measured, independent = std::max(1.0, n / (2.0 * EdgeMeans::kHalf + 1.0));
  means.step /= n;
  means.turn /= n;
  // Where step or turn change along the line, by their spread.
  means.step_deviation = std::sqrt(std::max(step_squares, step_spread) / n / independent);
  means.turn_deviation = std::sqrt(std::max(turn_squares, turn_spread) / n / independent);
  return means;
}

class LineSections {
 public:
  LineSections(const Version& field, double variance, const EdgeLine& line, const SideContext& context)
      : grid_(field.grid()), variance_(variance), line_(line), context_(context), found_(line.points.size()) {
    for (const double depth : kSectionDepths) at_depth_.push_back(lineOf(line.points.size(), depth));
  }

  // Different points from any threads.
  void measure(int i, EdgeSection& section) {
    if (!line_.points[static_cast<std::size_t>(i)].located) return;
    for (const StripLine& reach : at_depth_) {
      const Sides sides = sidesAt(context_, reach, i, kSectionGuard);
      if (!sides.supported()) return;
      const double left = std::max(variance_, sides.left.variance());
      const double right = std::max(variance_, sides.right.variance());
      if (std::max(left, right) > kFitsNoPlane * variance_ && &reach != &at_depth_.back()) continue;
      const EdgePoint& point = line_.points[static_cast<std::size_t>(i)];
      section.measured = true;
      section.step = sides.left.at(0.0, 0.0) - sides.right.at(0.0, 0.0);
      const double off = (sides.left.slope_d - sides.right.slope_d) * point.deviation;
      section.step_deviation = std::sqrt(left * sides.left.varianceAt(0.0, 0.0) +
                                         right * sides.right.varianceAt(0.0, 0.0) + off * off);
      const Across across = acrossAt(i);
      const Inclination up = across.of(sides.left), down = across.of(sides.right);
      section.turn = kDegrees * (up.angle - down.angle);
      section.turn_deviation = kDegrees * std::sqrt(left * up.variance + right * down.variance);
      found_[static_cast<std::size_t>(i)] = {&reach, sides.left, sides.right};
      return;
    }
  }

  // Adds what rows, or columns, of the standard deviation `offset` do to the sections that were measured and to their
  // means.
  void addOffsets(int axis, double offset, std::vector<EdgeSection>& sections, EdgeMeans& means) const {
    if (means.measured == 0 || !(offset > 0.0)) return;
    OffsetShares shares(context_.line, axis);
    for (int i = 0; i < context_.line.size(); ++i) {
      const Found& found = found_[static_cast<std::size_t>(i)];
      if (found.reach == nullptr) continue;
      const Across across = acrossAt(i);
      forEachBeside(context_, *found.reach, i, kSectionGuard,
                    [&](const StripSample& sample, double s, bool is_left) {
                      const PlaneFit& plane = is_left ? found.left : found.right;
                      const double sign = is_left ? 1.0 : -1.0;
                      shares.add(sample, {sign * plane.weightAt(0.0, 0.0, sample.d, s),
                                          sign * kDegrees * across.weightOf(plane, sample.d, s)});
                    });
      const StepAndTurn squares = shares.endSection();
      EdgeSection& section = sections[static_cast<std::size_t>(i)];
      section.step_deviation = std::hypot(section.step_deviation, offset * std::sqrt(squares.step));
      section.turn_deviation = std::hypot(section.turn_deviation, offset * std::sqrt(squares.turn));
    }
    const StepAndTurn squares = shares.ofSums();
    means.step_deviation =
        std::hypot(means.step_deviation, offset * std::sqrt(squares.step) / means.measured);
    means.turn_deviation =
        std::hypot(means.turn_deviation, offset * std::sqrt(squares.turn) / means.measured);
  }

 private:
  struct Found {
    const StripLine* reach = nullptr;  // null: not measured
    PlaneFit left, right;
  };
  [[nodiscard]] Across acrossAt(int i) const {
    return Across(grid_, context_.strip.tangents[static_cast<std::size_t>(i)]);
  }

  const Grid& grid_;
  double variance_;
  const EdgeLine& line_;
  const SideContext& context_;
  std::vector<StripLine> at_depth_;
  std::vector<Found> found_;  // at each point
};

}  // namespace

Result<std::vector<MeasuredEdge>> measureEdges(const Version& field, const EdgeNoise& noise,
                                               const std::vector<EdgeLine>& lines, JobControl& job) {
  for (const double deviation : {noise.sigma, noise.rows, noise.columns})
    if (!(deviation >= 0.0) || !std::isfinite(deviation))
      return inputError("the noise is not 0 or more", "measuring edges", "give its standard deviation");
  std::vector<MeasuredEdge> all(lines.size());
  const std::int64_t points = countPoints(lines);
  job.begin("measuring edges", 2 * static_cast<std::uint64_t>(points));
  if (points == 0) return all;
  const glm::dvec2 origin = lowestSample(lines);
  std::vector<Polyline> polylines;
  polylines.reserve(lines.size());
  for (const EdgeLine& line : lines) polylines.push_back(polylineAt(line, origin));
  // Spikes are found by the surfaces: by their neighbours' heights alone steep surfaces would count as spikes.
  constexpr double kNoSpikes = std::numeric_limits<double>::infinity();
  SampleWindow window(field.reader(), glm::ivec2(origin), polylines, kSectionDepths[0] + 1.0, kNoSpikes);
  const LineIndex index(polylines);
  std::vector<MeasuredStrip> strips;
  for (std::size_t k = 0; k < lines.size(); ++k) {
    if (job.cancelled()) return cancelled();
    strips.push_back(stripOf(polylines, k, index, window));
    job.advance(lines[k].points.size());
  }
  const double scatter = std::max(noise.sigma, scatterOf(strips, window));
  for (int round = 0; round < kRoundsOfMisfits; ++round) {
    if (job.cancelled()) return cancelled();
    for (const MeasuredStrip& along : strips) dropMisfits(along, scatter, window);
    window.applyMisfits();
  }
  const double least = std::numeric_limits<double>::min();
  const double deviation = std::max(noise.sigma, scatterOf(strips, window));
  const double variance = std::max(least, kSharedNoise * deviation * deviation);
  const glm::dvec2 spacing(field.grid().spacingXMm(), field.grid().spacingYMm());
  for (std::size_t k = 0; k < lines.size(); ++k) {
    if (job.cancelled()) return cancelled();
    const Polyline& line = polylines[k];
    const SideContext context{line, strips[k].strip, window, strips[k].ranges, EdgeMeans::kHalf, variance};
    LineSections measuring(field, variance, lines[k], context);
    std::vector<EdgeSection>& sections = all[k].sections;
    sections.resize(line.points.size());
    for (std::size_t i = 0; i < line.points.size(); ++i) {
      sections[i].position = lines[k].points[i].position;
      if (i > 0)
        sections[i].along_mm =
            sections[i - 1].along_mm + glm::length((line.points[i] - line.points[i - 1]) * spacing);
    }
    tbb::parallel_for(tbb::blocked_range<int>(0, line.size(), 16), [&](const auto& range) {
      for (int i = range.begin(); i < range.end(); ++i)
        measuring.measure(i, sections[static_cast<std::size_t>(i)]);
    });
    all[k].means = meansOf(sections);
    measuring.addOffsets(1, noise.rows, sections, all[k].means);
    measuring.addOffsets(0, noise.columns, sections, all[k].means);
    job.advance(line.points.size());
  }
  return all;
}

}  // namespace fettle::engine
