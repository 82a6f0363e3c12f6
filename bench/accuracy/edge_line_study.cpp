#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include <fmt/format.h>

#include "bench/accuracy/drawn_scan.h"
#include "bench/accuracy/measure.h"
#include "bench/accuracy/studies.h"
#include "engine/base/stopwatch.h"
#include "engine/edges/locate.h"
#include "engine/scanner/true_lines.h"

namespace fettle::bench {
namespace {

struct LineSubject {
  PartSubject part;
  double roughness;       // of the hand, see drawnEdges()
  double hand_deviation;  // LocateOptions::hand_deviation of the search [samples]
};
constexpr LineSubject kLineSubjects[] = {
    {{"bracket x1", "bracket", 1.0}, 1.0, 1.2},
    {{"bracket x3", "bracket", 3.0}, 1.0, 1.2},
    {{"steps x3", "steps", 3.0}, 1.0, 1.2},
    {{"ribs x3", "ribs", 3.0}, 1.0, 1.2},
    {{"steps x3, rough hand", "steps", 3.0}, 1.8, 2.5},
};
constexpr const char* kHandMethod = "hand";
constexpr const char* kLocatedMethod = "located line";

enum LineColumn : std::uint8_t { kShareLocated, kNormalised, kKindRight };

// Sums over the points of all lines of one run.
struct OffSums {
  double squares = 0.0, count = 0.0;

  void add(double off) {
    squares += off * off;
    count += 1.0;
  }
  [[nodiscard]] double rms() const { return count > 0.0 ? std::sqrt(squares / count) : 0.0; }
};

// One scan and one hand.
struct LineRun {
  OffSums hand, located, normalised;
  double points = 0.0, kind_right = 0.0, seconds = 0.0;
  std::uint64_t hash = 0;
};

engine::Result<LineRun> runLines(const LineSubject& subject, std::int32_t side, int noise_seed,
                                 int hand_seed) {
  const auto scan = scanOf(subject.part, side, noise_seed);
  if (!scan) return tl::unexpected(scan.error());
  const DrawnEdges drawn = drawnEdges(*scan, hand_seed, subject.roughness);
  LineRun run;
  engine::JobControl quiet;
  const engine::Stopwatch watch;
  const auto lines = engine::locateEdgeLines(scan->scan.reader(), scan->sigma_mm, drawn.strokes,
                                             {subject.hand_deviation}, quiet);
  if (!lines) return tl::unexpected(lines.error());
  run.seconds = watch.seconds();
  const double spacing = scan->scan.grid().spacingXMm();
  for (std::size_t k = 0; k < lines->size(); ++k) {
    const engine::Edge& edge = scan->edge_lines[k];
    const auto off = [&](glm::dvec2 p) { return engine::distanceFrom(edge, p * spacing) / spacing; };
    for (const glm::dvec2& p : drawn.strokes[k].points) run.hand.add(off(p));
    for (const engine::EdgePoint& p : (*lines)[k].points) {
      run.points += 1.0;
      if (!p.located) continue;
      const double error = off(p.position);
      run.located.add(error);
      run.normalised.add(error / p.deviation);
      const bool step = p.kind == engine::LineKind::kStep;
      run.kind_right += step == (edge.kind == engine::EdgeKind::kStep) ? 1.0 : 0.0;
      run.hash = run.hash * 1099511628211U +
                 static_cast<std::uint64_t>(std::llround(p.position.x * 0x1p20)) * 3 +
                 static_cast<std::uint64_t>(std::llround(p.position.y * 0x1p20));
    }
  }
  return run;
}

// Means and worst of the runs of a subject: a row for the hand, one for its located lines.
void addRows(const LineSubject& subject, const std::vector<LineRun>& runs, Study& study) {
  const double none = std::numeric_limits<double>::quiet_NaN();
  AccuracyRow hand, located;
  hand.subject = located.subject = subject.part.name;
  hand.method = kHandMethod;
  located.method = kLocatedMethod;
  hand.error_p99 = located.error_p99 = none;
  hand.wrong = located.wrong = none;
  hand.more = {none, none, none};
  located.more = {0.0, 0.0, 0.0};
  std::vector<double> costs;
  for (const LineRun& run : runs) {
    const auto n = static_cast<double>(runs.size());
    hand.error += run.hand.rms() / n;
    hand.error_worst = std::max(hand.error_worst, run.hand.rms());
    located.error += run.located.rms() / n;
    located.error_worst = std::max(located.error_worst, run.located.rms());
    located.more[kShareLocated] += run.located.count / run.points / n;
    located.more[kNormalised] += run.normalised.rms() / n;
    located.more[kKindRight] += run.kind_right / std::max(1.0, run.located.count) / n;
    located.hash = located.hash * 31 + run.hash;
    costs.push_back(1e6 * run.seconds / run.points);
  }
  spread(costs, located);
  study.rows.push_back(std::move(hand));
  study.rows.push_back(std::move(located));
}

}  // namespace

engine::Result<Study> edgeLineStudy(const AccuracyOptions& options, engine::JobControl& job) {
  Study study{"lines",
              "Edge lines located from strokes",
              "How near the true edge does a line get that starts from a hand?",
              {"time per 1,000 points of stroke", "ms"},
              {"root mean square distance from the true edge", "samples"}};
  study.cost_from_zero = true;
  study.columns = {"share located", "error over stated deviation", "kind right"};
  const auto [seeds, hands, side] = scanSizes(options.effort);
  job.begin("edge lines", std::size(kLineSubjects) * static_cast<std::size_t>(seeds * hands));
  for (const LineSubject& subject : kLineSubjects) {
    std::vector<LineRun> runs;
    for (int seed = 1; seed <= seeds; ++seed)
      for (int hand = 1; hand <= hands; ++hand) {
        if (job.cancelled()) return engine::cancelled();
        auto run = runLines(subject, side, seed, hand);
        if (!run) return tl::unexpected(run.error());
        runs.push_back(*run);
        job.advance();
      }
    addRows(subject, runs, study);
  }
  study.reference = fmt::format(
      "The true edges of simulated parts of {} x {} samples, exact to a millionth of a millimetre; strokes "
      "with the tremor and drift measured on surgeons along each of them. {} seeds of noise and {} of the "
      "hand: mean and worst run. Of the located lines only points that the program states as located count.",
      side, side, seeds, hands);
  std::string figures;
  for (const LineSubject& subject : kLineSubjects) {
    const AccuracyRow& hand = rowOf(study, subject.part.name, kHandMethod);
    const AccuracyRow& line = rowOf(study, subject.part.name, kLocatedMethod);
    figures += fmt::format("{}{}: {:.2f} instead of {:.2f} samples", figures.empty() ? "" : "; ",
                           subject.part.name, line.error, hand.error);
  }
  double least = std::numeric_limits<double>::infinity(), most = 0.0;
  for (const AccuracyRow& row : study.rows)
    if (row.method == kLocatedMethod) {
      least = std::min(least, row.more[kNormalised]);
      most = std::max(most, row.more[kNormalised]);
    }
  study.answer = fmt::format(
      "{}. On the bracket {:.0f} ms for 1,000 points. An error is {:.2f} to {:.2f} times the stated standard "
      "deviation.",
      figures, rowOf(study, kLineSubjects[0].part.name, kLocatedMethod).cost, least, most);
  return study;
}

}  // namespace fettle::bench
