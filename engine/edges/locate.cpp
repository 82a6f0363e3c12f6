#include <algorithm>
#include <cmath>
#include <cstddef>

#include "engine/edges/line_round.h"
#include "engine/edges/locate.h"
#include "engine/edges/separate.h"
#include "engine/edges/walls.h"

namespace fettle::engine {

namespace {

constexpr double kFarthest = 1048576.0;         // of a coordinate [samples]
constexpr std::size_t kMostPoints = 1U << 22U;  // of all lines
constexpr double kPositionStep = 0x1p-20;       // of a position [samples]

constexpr int kRounds = 4;
constexpr double kReaches[kRounds] = {0.0, 2.0, 1.25, 1.25};  // the first follows the hand [samples]
constexpr double kLaterDepth = 10.0;

RoundPlan firstRound(double hand_deviation) {
  RoundPlan plan;
  plan.offsets.reach = std::ceil(2.75 * hand_deviation);
  plan.depth = std::max(12.0, 2.0 * plan.offsets.reach);
  plan.half = 4;
  plan.step_deviation = 0.25;
  plan.smoothing = 2.5;
  plan.tangent_half = 6;
  plan.deviation = hand_deviation;
  return plan;
}

RoundPlan laterRound(int round) {
  RoundPlan plan;
  plan.offsets.reach = kReaches[round];
  plan.depth = kLaterDepth;
  plan.half = round + 1 < kRounds ? 6 : 5;
  plan.step_deviation = round == 1 ? 0.15 : 0.1;
  plan.smoothing = 2.0;
  plan.tangent_half = 3;
  plan.deviation = 0.7 * kReaches[round];
  return plan;
}

// Multiples of kPositionStep move by whole samples without rounding.
double rounded(double x) {
  return std::round(x / kPositionStep) * kPositionStep;
}

Status checked(double noise, std::span<const EdgeStroke> strokes, const LocateOptions& options) {
  const auto refuse = [](const char* what, const char* remedy) {
    return tl::unexpected(inputError(what, "locating edge lines", remedy));
  };
  if (!(noise > 0.0) || !std::isfinite(noise))
    return refuse("the noise is not above 0", "give its standard deviation, or add noise to an exact field");
  if (!(options.hand_deviation >= LocateOptions::kLeastHand &&
        options.hand_deviation <= LocateOptions::kMostHand))
    return refuse("the deviation of the hand is out of range", "0.25 to 3 samples");
  double length = 0.0;
  for (const EdgeStroke& stroke : strokes) {
    for (const glm::dvec2& p : stroke.points)
      if (!(std::abs(p.x) <= kFarthest && std::abs(p.y) <= kFarthest))
        return refuse("a stroke has a point far outside the field", "leave the stroke out");
    length += lengthOf(stroke.points, stroke.closed) + 1.0;
  }
  if (length > static_cast<double>(kMostPoints))
    return refuse("the strokes are too long", "locate fewer of them at a time");
  return {};
}

// Strokes relative to their lowest whole sample, so that results do not depend on where the field begins.
glm::ivec2 lowestSample(std::span<const EdgeStroke> strokes) {
  glm::dvec2 low(kFarthest);
  for (const EdgeStroke& stroke : strokes)
    for (const glm::dvec2& p : stroke.points) low = {std::min(low.x, p.x), std::min(low.y, p.y)};
  return {static_cast<int>(std::floor(low.x)), static_cast<int>(std::floor(low.y))};
}

std::vector<Polyline> linesOf(std::span<const EdgeStroke> strokes, glm::ivec2 origin) {
  std::vector<Polyline> lines;
  for (const EdgeStroke& stroke : strokes) {
    std::vector<glm::dvec2> points;
    points.reserve(stroke.points.size());
    for (const glm::dvec2& p : stroke.points)
      points.emplace_back(rounded(p.x) - origin.x, rounded(p.y) - origin.y);
    lines.push_back(polylineOf(points, stroke.closed));
  }
  return lines;
}

EdgeLine finished(const EdgeStroke& stroke, const Polyline& hand, const Polyline& line,
                  const std::vector<Finding>& findings, const std::vector<WallPlace>& walls,
                  glm::ivec2 origin) {
  EdgeLine result;
  result.id = stroke.id;
  result.closed = stroke.closed;
  for (std::size_t i = 0; i < line.points.size(); ++i) {
    EdgePoint point;
    if (i < findings.size() && findings[i].located) point = edgePointOf(findings[i]);
    if (point.located && walls[i].found) point.deviation = walls[i].deviation;
    const glm::dvec2 position = point.located ? line.points[i] : pointAt(hand, line.origins[i]);
    point.position = {rounded(position.x) + origin.x, rounded(position.y) + origin.y};
    result.points.push_back(point);
  }
  return result;
}

}  // namespace

int locateReach(const LocateOptions& options) {
  const RoundPlan first = firstRound(options.hand_deviation);
  double reach = first.depth + first.offsets.reach;
  for (const double later : kReaches) reach += later;
  return static_cast<int>(std::ceil(reach)) + SampleWindow::kSpikeReach + 1;
}

Result<std::vector<EdgeLine>> locateEdgeLines(const FieldReader& field, double noise,
                                              std::span<const EdgeStroke> strokes,
                                              const LocateOptions& options, JobControl& job) {
  if (auto ok = checked(noise, strokes, options); !ok) return tl::unexpected(ok.error());
  const glm::ivec2 origin = lowestSample(strokes);
  const std::vector<Polyline> hands = linesOf(strokes, origin);
  std::size_t points = 0;
  for (const Polyline& hand : hands) points += hand.points.size();
  job.begin("locating edge lines", points * kRounds);
  SampleWindow window(field, origin, hands, locateReach(options) - SampleWindow::kSpikeReach, noise);

  std::vector<Polyline> lines = hands;
  std::vector<bool> strong(lines.size(), true);
  std::vector<std::vector<Finding>> findings(lines.size());
  for (int round = 0; round < kRounds; ++round) {
    const Stage stage = round == 0 ? Stage::kFirst : round == 1 ? Stage::kRestart : Stage::kRefine;
    // A weak line may have taken the edge of a strong neighbour, which is known from now on.
    if (stage == Stage::kRestart)
      for (std::size_t k = 0; k < lines.size(); ++k)
        if (!strong[k]) lines[k] = hands[k];
    const LineIndex index(lines);
    std::vector<Polyline> next = lines;
    std::vector<bool> next_strong = strong;
    for (std::size_t k = 0; k < lines.size(); ++k) {
      const bool from_hand = round == 0 || (stage == Stage::kRestart && !strong[k]);
      const LineRound task{lines,
                           index,
                           strong,
                           static_cast<int>(k),
                           stage,
                           noise,
                           from_hand ? firstRound(options.hand_deviation) : laterRound(round)};
      if (lines[k].size() >= LineRound::kLeastPoints) {
        LocatedLine located = task.run(window, job);
        if (job.cancelled()) return cancelled();
        next_strong[k] = round == 0 ? located.strong : strong[k];
        next[k].points = std::move(located.points);
        findings[k] = std::move(located.findings);
        if (round + 1 < kRounds) next[k] = resampled(next[k]);
      }
      job.advance(hands[k].points.size());
    }
    lines = std::move(next);
    strong = std::move(next_strong);
    window.applyMisfits();
  }
  const std::vector<std::vector<WallPlace>> walls = settleAtWalls(lines, noise, window, job);
  if (job.cancelled()) return cancelled();
  separate(lines);

  std::vector<EdgeLine> result;
  for (std::size_t k = 0; k < lines.size(); ++k)
    result.push_back(finished(strokes[k], hands[k], lines[k], findings[k], walls[k], origin));
  return result;
}

}  // namespace fettle::engine
