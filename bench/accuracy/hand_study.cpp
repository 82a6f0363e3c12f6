#include <algorithm>
#include <iterator>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "bench/accuracy/drawn_scan.h"
#include "bench/accuracy/measure.h"
#include "bench/accuracy/studies.h"
#include "bench/accuracy/truth_errors.h"
#include "engine/edges/corners.h"
#include "engine/edges/locate.h"
#include "engine/filter/noise_range.h"
#include "engine/scanner/true_lines.h"

namespace fettle::bench {
namespace {

constexpr PartSubject kHandSubjects[] = {
    {"bracket", "bracket", 1.0, 0.0},
    {"bracket, noise x 3", "bracket", 3.0, 0.0},
    {"steps, noise x 3", "steps", 3.0, 0.0},
    {"ribs, noise x 3", "ribs", 3.0, 0.0},
    {"wedges", "wedges", 1.0, 0.0},
    {"wedges, noise x 3", "wedges", 3.0, 0.0},
    {"housing", "housing", 1.0, 0.0},
    {"bracket, 2 % mixed pixels", "bracket", 1.0, 0.02},
    {"steps, 2 % mixed pixels", "steps", 1.0, 0.02},
    {"bracket, spot of a sample", "bracket", 1.0, 0.0, 1.0},
    {"steps, noise x 3, spot of a sample", "steps", 3.0, 0.0, 1.0},
};

constexpr const char* kAlone = "tgv alone";
constexpr const char* kDrawn = "tgv, lines as drawn";
constexpr const char* kLocated = "tgv, lines located";
constexpr const char* kTrue = "tgv, true lines";
constexpr std::size_t kNearColumn = 1, kRatioColumn = 3;

// `alone` has the errors without lines of the same runs.
AccuracyRow rowOfRuns(const char* subject, const char* method, const std::vector<TruthErrors>& runs,
                      const std::vector<TruthErrors>& alone, const std::vector<double>& seconds) {
  AccuracyRow row = rowOfErrors(subject, method, runs, seconds);
  double ratio = 0.0;
  for (std::size_t i = 0; i < runs.size(); ++i) ratio = std::max(ratio, runs[i].all / alone[i].all);
  row.more.push_back(ratio);
  return row;
}

engine::Result<TruthErrors> errorsWith(const engine::SimulatedScan& scan, std::vector<engine::EdgeLine> lines,
                                       const engine::FilterSpec& spec) {
  engine::Version field = scan.scan;
  if (!lines.empty())
    field = field.withLines(std::make_shared<const std::vector<engine::EdgeLine>>(std::move(lines)));
  return errorsAfter(spec, field, scan);
}

// Strokes taken for lines as they are.
std::vector<engine::EdgeLine> asDrawn(const std::vector<engine::EdgeStroke>& strokes) {
  std::vector<engine::EdgeLine> lines;
  for (const engine::EdgeStroke& stroke : strokes) {
    engine::EdgeLine line{stroke.id, stroke.closed, {}};
    for (const glm::dvec2& p : stroke.points) {
      engine::EdgePoint point;
      point.position = p;
      point.located = true;
      line.points.push_back(point);
    }
    lines.push_back(std::move(line));
  }
  return lines;
}

// All runs of a subject; `alone` and `ceiling` are repeated for each hand.
struct HandRuns {
  std::vector<TruthErrors> alone, raw, located, ceiling;
  std::vector<double> seconds;
};

engine::Status runHands(const PartSubject& subject, std::int32_t side, int seed, int hands, HandRuns& runs,
                        engine::JobControl& job) {
  engine::JobControl quiet;
  const auto scan = scanOf(subject, side, seed);
  if (!scan) return tl::unexpected(scan.error());
  engine::FilterSpec spec;
  spec.kind = engine::FilterKind::kGeneralisedVariation;
  const auto ready = engine::withMeasuredRange(spec, scan->scan, quiet);
  if (!ready) return tl::unexpected(ready.error());
  const auto alone = errorsWith(*scan, {}, *ready);
  if (!alone) return tl::unexpected(alone.error());
  const auto ceiling = errorsWith(*scan, engine::trueLines(*scan), *ready);
  if (!ceiling) return tl::unexpected(ceiling.error());
  for (int hand = 1; hand <= hands; ++hand) {
    if (job.cancelled()) return engine::cancelled();
    const DrawnEdges drawn = drawnEdges(*scan, hand);
    auto lines = engine::locateEdgeLines(scan->scan.reader(), ready->range_sigma, drawn.strokes, {}, quiet);
    if (!lines) return tl::unexpected(lines.error());
    engine::extendEnds(*lines, 0, scan->scan.grid().width, scan->scan.grid().height);
    const auto located = errorsWith(*scan, *std::move(lines), *ready);
    if (!located) return tl::unexpected(located.error());
    const auto raw = errorsWith(*scan, asDrawn(drawn.strokes), *ready);
    if (!raw) return tl::unexpected(raw.error());
    runs.alone.push_back(*alone);
    runs.raw.push_back(*raw);
    runs.located.push_back(*located);
    runs.ceiling.push_back(*ceiling);
    runs.seconds.push_back(drawn.seconds);
    job.advance();
  }
  return {};
}

// The share of what true lines gain near edges that those of the hand gain; nothing where true lines gain less
// than a tenth.
std::optional<double> shareOf(const Study& study, const char* subject) {
  const double alone = rowOf(study, subject, kAlone).more[kNearColumn];
  const double hand = rowOf(study, subject, kLocated).more[kNearColumn];
  const double ceiling = rowOf(study, subject, kTrue).more[kNearColumn];
  if (alone < 1.1 * ceiling) return std::nullopt;
  return (alone - hand) / (alone - ceiling);
}

}  // namespace

engine::Result<Study> handStudy(const AccuracyOptions& options, engine::JobControl& job) {
  Study study{"hand",
              "What the lines of a hand add",
              "How much nearer to the truth does a person's hand bring the best automatic filter?",
              {"time of the hand", "s"},
              {"RMSE against the truth", "um"}};
  study.cost_from_zero = true;
  study.columns = {"flats [um]", "near edges [um]", "near edges, worst run [um]",
                   "largest ratio to tgv alone"};
  const auto [seeds, hands, side] = scanSizes(options.effort);
  job.begin("lines of a hand", std::size(kHandSubjects) * static_cast<std::size_t>(seeds * hands));
  double most = 0.0;
  std::string shares, without;
  for (const PartSubject& subject : kHandSubjects) {
    HandRuns runs;
    for (int seed = 1; seed <= seeds; ++seed)
      if (engine::Status done = runHands(subject, side, seed, hands, runs, job); !done)
        return tl::unexpected(done.error());
    const std::vector<double> no_hand(runs.alone.size(), 0.0);
    study.rows.push_back(rowOfRuns(subject.name, kAlone, runs.alone, runs.alone, no_hand));
    study.rows.push_back(rowOfRuns(subject.name, kDrawn, runs.raw, runs.alone, runs.seconds));
    study.rows.push_back(rowOfRuns(subject.name, kLocated, runs.located, runs.alone, runs.seconds));
    study.rows.push_back(rowOfRuns(subject.name, kTrue, runs.ceiling, runs.alone, runs.seconds));
    most = std::max(most, rowOf(study, subject.name, kLocated).more[kRatioColumn]);
    if (const auto share = shareOf(study, subject.name))
      shares += fmt::format("{}{:.0f} % on {}", shares.empty() ? "" : ", ", 100.0 * *share, subject.name);
    else
      without += fmt::format("{}{}", without.empty() ? "" : "; ", subject.name);
  }
  study.reference = fmt::format(
      "The simulated parts' truth; parts of {} x {} samples, {} {} of noise, {} {} along all edges of each; "
      "every row is tgv with the range of its own measure of the noise. Near edges: within 3 samples of a "
      "true edge. As drawn: the hand's strokes cut as they are, 1.3 to 1.6 samples off.",
      side, side, seeds, seeds == 1 ? "seed" : "seeds", hands, hands == 1 ? "hand" : "hands");
  study.answer = fmt::format(
      "Of what true lines would gain near edges, the located lines of a hand gain {}. Where the filter finds "
      "the edges by itself true lines gain less than a tenth, and so does the hand: {}. Over a whole part "
      "the hand leaves at most {:.3f} times what the filter leaves alone.",
      shares.empty() ? "nothing" : shares, without.empty() ? "none" : without, most);
  return study;
}

}  // namespace fettle::bench
