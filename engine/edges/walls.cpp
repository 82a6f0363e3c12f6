#include "engine/edges/walls.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>
#include <glm/vec3.hpp>

#include "engine/edges/neighbours.h"
#include "engine/edges/sides.h"
#include "engine/edges/surroundings.h"

namespace fettle::engine {

namespace {

constexpr double kTall = 24.0;         // of a wall, standard deviations of the noise
constexpr double kOfASide = 0.25;      // of the wall: heights as near to a surface are that side's
constexpr double kWallDepth = 5.0;     // of the surfaces [samples]
constexpr double kWallGuard = 0.75;    // samples nearer to the line are not of the surfaces [samples]
constexpr int kWallSurfaceHalf = 5;    // points before and after whose samples are of the surfaces
constexpr int kWallTangent = 3;        // points before and after that give the tangent
constexpr int kWallGrain = 16;         // points of a task
constexpr double kBeside = 1.75;       // samples farther from the line decide nothing [samples]
constexpr int kFewestOfASide = 4;      // samples
constexpr double kSharpness = 0.08;    // of the penalty [samples]
constexpr double kWrongSide = 0.2;     // samples farther on the wrong side are left out, [samples]
constexpr double kMostWrong = 0.05;    // if they are no more of those within a sample of the line; or one
constexpr double kOneWall = 1.0;       // lines nearer to each other are at one wall [samples]
constexpr double kLeastAcross = 0.05;  // deviation: what the parabola does not know [samples]
// Half of the curvature [1 / samples]. Where a sample is left out, the line may not be so bent that it cuts a corner.
constexpr double kMostBend = 0.06, kMostBendWithWrong = 0.035;
constexpr std::array<int, 3> kWallHalves{12, 8, 5};  // points before and after: the first that can be divided
constexpr int kNewtonSteps = 8;
constexpr double kCertainly = 12.0;    // samples so many kSharpness inside add nothing
constexpr double kLongestStep = 0.25;  // of the offset [samples]
// What a parabola may differ from the located line: offset, slope, half of the curvature.
constexpr glm::dvec3 kFreedom{0.5, 0.1, 0.02};

// A sample beside a line.
struct Sided {
  glm::dvec2 position{0.0};
  double side = 0.0;  // 1 left, -1 right
};

// Those whose side is certain, by point.
using SidedSamples = std::vector<std::vector<Sided>>;

SidedSamples sidedSamples(const SideContext& context, double noise) {
  const std::size_t n = context.line.points.size();
  const std::vector<double> on_line(n, 0.0);
  const StripLine line{on_line, on_line, std::vector<Extent>(n, Extent{-kWallDepth, kWallDepth})};
  SidedSamples samples(n);
  tbb::parallel_for(tbb::blocked_range<int>(0, context.line.size(), kWallGrain), [&](const auto& points) {
    for (int i = points.begin(); i < points.end(); ++i) {
      const auto at = static_cast<std::size_t>(i);
      const Sides sides = sidesAt(context, line, i, kWallGuard);
      if (!sides.supported()) continue;
      if (std::abs(sides.left.at(0.0, 0.0) - sides.right.at(0.0, 0.0)) < kTall * noise) continue;
      const glm::dvec2 tangent = context.strip.tangents[at], normal = context.strip.normal(i);
      for (const StripSample& sample : context.strip.at(i)) {
        if (std::abs(sample.d) > kBeside || !context.ranges[at].contains(sample.d)) continue;
        const double right = sides.right.at(sample.d, sample.s);
        const double part = (sample.z - right) / (sides.left.at(sample.d, sample.s) - right);
        const bool is_left = std::abs(part - 1.0) < kOfASide, is_right = std::abs(part) < kOfASide;
        if (is_left || is_right)
          samples[at].push_back(
              {context.line.points[at] + tangent * sample.s + normal * sample.d, is_left ? 1.0 : -1.0});
      }
    }
  });
  return samples;
}

// A sample in the coordinates of a point.
struct Witness {
  double along = 0.0, across = 0.0;
  double side = 0.0;
  bool counts = true;

  [[nodiscard]] glm::dvec3 powers() const noexcept { return {1.0, along, along * along}; }
  // How far it is on its own side of a parabola; negative on the wrong one.
  [[nodiscard]] double inside(glm::dvec3 parabola) const noexcept {
    return side * (across - glm::dot(parabola, powers()));
  }
};

// Least squares through the points of the line.
glm::dvec3 parabolaOf(const Polyline& line, int i, int half, glm::dvec2 tangent) {
  glm::dmat3 squares(1e-9);
  glm::dvec3 sums(0.0);
  for (int along = -half; along <= half; ++along) {
    const int j = line.wrapped(i + along);
    if (j < 0) continue;
    const glm::dvec2 off =
        line.points[static_cast<std::size_t>(j)] - line.points[static_cast<std::size_t>(i)];
    const double s = glm::dot(off, tangent);
    const glm::dvec3 powers{1.0, s, s * s};
    squares += glm::outerProduct(powers, powers);
    sums += powers * (off.y * tangent.x - off.x * tangent.y);
  }
  return glm::inverse(squares) * sums;
}

struct Division {
  glm::dvec3 parabola{0.0};
  double variance = 0.0;  // of its offset
};

// Newton's steps on the sum of log(1 + exp(-inside / kSharpness)), which is convex.
Division divide(const std::vector<Witness>& witnesses, glm::dvec3 from, glm::dvec3 start) {
  const glm::dvec3 hold = 1.0 / (kFreedom * kFreedom);
  Division result{start, 0.0};
  glm::dmat3 bending(1.0);
  for (int step = 0; step < kNewtonSteps; ++step) {
    glm::dvec3 slope = hold * (result.parabola - from);
    bending = glm::dmat3(0.0);
    for (int k = 0; k < 3; ++k) bending[k][k] = hold[k];
    for (const Witness& w : witnesses) {
      const double u = w.inside(result.parabola) / kSharpness;
      if (!w.counts || u > kCertainly) continue;
      const double wrong = 1.0 / (1.0 + std::exp(u));
      const glm::dvec3 powers = w.powers();
      slope += powers * (w.side * wrong / kSharpness);
      // Far on the wrong side the penalty is a straight line, and a step without a bend would be too long.
      bending += glm::outerProduct(powers, powers) *
                 (std::max(wrong * (1.0 - wrong), 0.02 * wrong) / (kSharpness * kSharpness));
    }
    glm::dvec3 change = glm::inverse(bending) * slope;
    const double most = std::abs(change.x);
    if (most > kLongestStep) change *= kLongestStep / most;
    result.parabola -= change;
    if (most < 1e-3) break;
  }
  result.variance = glm::inverse(bending)[0][0];
  return result;
}

WallPlace placeAt(const Polyline& line, const SidedSamples& samples, int i, int half, glm::dvec2 tangent) {
  if (line.closed && 2 * half + 1 > line.size()) return {};
  const glm::dvec2 centre = line.points[static_cast<std::size_t>(i)];
  std::vector<Witness> witnesses;
  int left = 0, right = 0;
  for (int along = -half; along <= half; ++along) {
    const int j = line.wrapped(i + along);
    if (j < 0) continue;
    for (const Sided& sample : samples[static_cast<std::size_t>(j)]) {
      const glm::dvec2 off = sample.position - centre;
      witnesses.push_back({glm::dot(off, tangent), off.y * tangent.x - off.x * tangent.y, sample.side, true});
      ++(sample.side > 0.0 ? left : right);
    }
  }
  if (std::min(left, right) < kFewestOfASide) return {};
  const glm::dvec3 from = parabolaOf(line, i, half, tangent);
  Division division = divide(witnesses, from, from);
  for (int turn = 0; turn < 2; ++turn) {
    bool changed = false;
    for (Witness& w : witnesses) {
      const bool counts = w.inside(division.parabola) > -kWrongSide;
      changed = changed || counts != w.counts;
      w.counts = counts;
    }
    if (!changed) break;
    division = divide(witnesses, from, division.parabola);
  }
  int wrong = 0, near = 0;
  for (const Witness& w : witnesses) {
    const double inside = w.inside(division.parabola);
    wrong += inside <= -kWrongSide ? 1 : 0;
    near += std::abs(inside) <= 1.0 ? 1 : 0;
  }
  if (wrong > std::max(1.0, kMostWrong * near)) return {};
  if (std::abs(division.parabola.z) > (wrong > 0 ? kMostBendWithWrong : kMostBend)) return {};
  return {division.parabola.x, std::max(kLeastAcross, std::sqrt(division.variance)), true};
}

std::vector<WallPlace> placesOf(const SideContext& context, double noise, const JobControl& job) {
  const SidedSamples samples = sidedSamples(context, noise);
  std::vector<WallPlace> places(context.line.points.size());
  tbb::parallel_for(tbb::blocked_range<int>(0, context.line.size(), kWallGrain), [&](const auto& points) {
    for (int i = points.begin(); i < points.end() && !job.cancelled(); ++i) {
      const auto at = static_cast<std::size_t>(i);
      if (samples[at].empty()) continue;
      for (const int half : kWallHalves) {
        places[at] = placeAt(context.line, samples, i, half, context.strip.tangents[at]);
        if (places[at].found) break;
      }
    }
  });
  return places;
}

// Where lines of two strokes settle at one wall, the stroke of one is along another edge: nothing says which.
void leaveShared(const std::vector<Polyline>& lines, const std::vector<std::vector<glm::dvec2>>& tangents,
                 std::vector<std::vector<WallPlace>>& places) {
  const LineIndex index(lines);
  const std::vector<std::vector<WallPlace>> settled = places;
  for (std::size_t k = 0; k < lines.size(); ++k)
    for (int i = 0; i < lines[k].size(); ++i) {
      const auto at = static_cast<std::size_t>(i);
      if (!settled[k][at].found) continue;
      for (const Neighbour& other : index.around(static_cast<int>(k), i, tangents[k][at], kOneWall))
        if (other.line != static_cast<int>(k) &&
            settled[static_cast<std::size_t>(other.line)][static_cast<std::size_t>(other.point)].found)
          places[k][at].found = false;
    }
}

}  // namespace

std::vector<std::vector<WallPlace>> settleAtWalls(std::vector<Polyline>& lines, double noise,
                                                  SampleWindow& window, const JobControl& job) {
  const LineIndex index(lines);
  const std::vector<bool> known(lines.size(), true);
  std::vector<std::vector<WallPlace>> places;
  std::vector<std::vector<glm::dvec2>> tangents;
  std::vector<Polyline> next = lines;
  for (std::size_t k = 0; k < lines.size() && !job.cancelled(); ++k) {
    const Polyline& line = lines[k];
    const Strip strip = stripAlong(line, window, kWallDepth, kWallTangent);
    const LineNeighbours neighbours = neighboursOf(index, static_cast<int>(k), strip.tangents, kWallDepth);
    std::vector<OffsetRange> ranges;
    for (const Surroundings& here : surroundingsOf(line, neighbours, Stage::kRefine, true, known))
      ranges.push_back(here.range);
    const SideContext context{line, strip, window, ranges, kWallSurfaceHalf, noise * noise};
    places.push_back(placesOf(context, noise, job));
    tangents.push_back(strip.tangents);
    for (int i = 0; i < line.size(); ++i)
      next[k].points[static_cast<std::size_t>(i)] +=
          strip.normal(i) * places[k][static_cast<std::size_t>(i)].offset;
  }
  lines = std::move(next);
  if (!job.cancelled()) leaveShared(lines, tangents, places);
  return places;
}

}  // namespace fettle::engine
