#include <algorithm>
#include <iterator>
#include <memory>
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
#include "engine/filter/catalogue.h"
#include "engine/filter/noise_range.h"
#include "engine/scanner/true_lines.h"
#include "haptic/operator/operator_strokes.h"
#include "haptic/tick/replay.h"

namespace fettle::bench {
namespace {

constexpr PartSubject kProcessSubjects[] = {
    {"bracket", "bracket", 1.0},
    {"steps, noise x 3", "steps", 3.0},
    {"ribs", "ribs", 1.0},
    {"ribs, noise x 3", "ribs", 3.0},
    {"bracket, 2 % mixed pixels", "bracket", 1.0, 0.02},
    {"steps, 2 % mixed pixels", "steps", 1.0, 0.02},
};

// The window and passes of the demonstration for filters that know no edges.
constexpr int kProcessWindow = 7, kProcessPasses = 3;

constexpr const char* kBestAlone = "tgv alone";
constexpr const char* kBestByHand = "tgv, lines of the hand";

engine::FilterSpec plainSpec(engine::FilterKind kind) {
  engine::FilterSpec spec;
  spec.kind = kind;
  spec.window = kProcessWindow;
  spec.passes = kProcessPasses;
  return spec;
}

// A filter that keeps edges by itself, with the range of the noise that it measures.
engine::Result<engine::FilterSpec> measuredSpec(engine::FilterKind kind, const engine::Version& scan) {
  constexpr int kBestOfTv = 31;
  engine::FilterSpec spec;
  spec.kind = kind;
  if (engine::filterOf(kind).window.exists()) spec.window = kBestOfTv;
  engine::JobControl quiet;
  return engine::withMeasuredRange(spec, scan, quiet);
}

// The paper's process up to its global filter: a hand smooths along the edges and marks them.
struct TouchedScan {
  engine::Version field;
  double seconds = 0.0;  // of the hand
};
engine::Result<TouchedScan> touchedBy(const engine::SimulatedScan& scan, int hand) {
  int reach = 0;
  for (const engine::FilterKind kind : {engine::FilterKind::kBox, engine::FilterKind::kMedian})
    reach = std::max(reach, engine::reachOf(plainSpec(kind)));
  haptic::Scene scene = haptic::defaultScene();
  scene.level = haptic::ContactLevel::kCertified;  // a local search leaves gaps in the marks
  scene.certified_radius_cells = 8;
  scene.mark_radius_samples = reach + 3.0;  // 3 for the hand's tremor
  haptic::OperatorSpec person;
  person.seed = static_cast<std::uint64_t>(hand);
  const std::vector<haptic::StrokeSample> strokes =
      haptic::operatorStrokes(scan.scan, scan.edge_lines, haptic::offTheEdges(person, scan.scan.grid()));
  engine::JobControl quiet;
  auto touched = haptic::replay(scan.scan, scan.scan, strokes, scene, {}, quiet);
  if (!touched) return tl::unexpected(touched.error());
  return TouchedScan{std::move(touched->field), strokes.empty() ? 0.0 : strokes.back().t};
}

// What each method left of all runs of one subject, in the order of the table.
class ProcessRuns {
 public:
  engine::Status add(const char* method, double seconds, const engine::Result<TruthErrors>& errors) {
    if (!errors) return tl::unexpected(errors.error());
    auto found = std::ranges::find(methods_, method, &Method::name);
    if (found == methods_.end()) found = methods_.insert(methods_.end(), {method, {}, {}});
    found->runs.push_back(*errors);
    found->seconds.push_back(seconds);
    return {};
  }

  void appendTo(Study& study, const char* subject) const {
    for (const Method& method : methods_)
      study.rows.push_back(rowOfErrors(subject, method.name, method.runs, method.seconds));
  }

 private:
  struct Method {
    std::string name;
    std::vector<TruthErrors> runs;
    std::vector<double> seconds;
  };
  std::vector<Method> methods_;
};

engine::Result<engine::EdgeLines> linesOfHand(const engine::SimulatedScan& scan, const DrawnEdges& drawn,
                                              double noise) {
  engine::JobControl quiet;
  auto lines = engine::locateEdgeLines(scan.scan.reader(), noise, drawn.strokes, {}, quiet);
  if (!lines) return tl::unexpected(lines.error());
  engine::extendEnds(*lines, 0, scan.scan.grid().width, scan.scan.grid().height);
  return std::make_shared<const std::vector<engine::EdgeLine>>(*std::move(lines));
}

engine::Status runProcess(const PartSubject& subject, std::int32_t side, int seed, int hands,
                          ProcessRuns& runs, engine::JobControl& job) {
  const auto scan = scanOf(subject, side, seed);
  if (!scan) return tl::unexpected(scan.error());
  const engine::FilterSpec box = plainSpec(engine::FilterKind::kBox);
  const engine::FilterSpec median = plainSpec(engine::FilterKind::kMedian);
  const auto tv = measuredSpec(engine::FilterKind::kTotalVariation, scan->scan);
  if (!tv) return tl::unexpected(tv.error());
  const auto tgv = measuredSpec(engine::FilterKind::kGeneralisedVariation, scan->scan);
  if (!tgv) return tl::unexpected(tgv.error());

  engine::Status done = runs.add("nothing", 0.0, truthErrors(scan->scan, *scan));
  const auto add = [&](const char* method, double seconds, const engine::FilterSpec& spec,
                       const engine::Version& field) {
    if (done && job.cancelled()) done = engine::cancelled();
    if (done) done = runs.add(method, seconds, errorsAfter(spec, field, *scan));
  };
  add("box alone", 0.0, box, scan->scan);
  add("median alone", 0.0, median, scan->scan);
  add("tv alone", 0.0, *tv, scan->scan);
  add(kBestAlone, 0.0, *tgv, scan->scan);
  double drawing_s = 0.0;
  for (int hand = 1; done && hand <= hands; ++hand) {
    const auto touched = touchedBy(*scan, hand);
    if (!touched) return tl::unexpected(touched.error());
    add("HEG with box", touched->seconds, box, touched->field);
    add("HEG with median", touched->seconds, median, touched->field);
    const DrawnEdges drawn = drawnEdges(*scan, hand);
    const auto lines = linesOfHand(*scan, drawn, tgv->range_sigma);
    if (!lines) return tl::unexpected(lines.error());
    drawing_s = drawn.seconds;
    add(kBestByHand, drawing_s, *tgv, scan->scan.withLines(*lines));
    job.advance();
  }
  // Stands where a hand without any error would, in the time of a hand.
  add("tgv, true lines", drawing_s, *tgv,
      scan->scan.withLines(std::make_shared<const std::vector<engine::EdgeLine>>(engine::trueLines(*scan))));
  return done;
}

}  // namespace

engine::Result<Study> processStudy(const AccuracyOptions& options, engine::JobControl& job) {
  Study study{"process",
              "The paper's process and its opponents",
              "What does a hand bring, beside the same filter without it and beside better filters?",
              {"time of the hand", "s"},
              {"RMSE against the truth", "um"}};
  study.cost_from_zero = true;
  study.columns = {"flats [um]", "near edges [um]", "near edges, worst run [um]"};
  const auto [seeds, hands, side] = scanSizes(options.effort);
  std::vector<PartSubject> subjects;
  for (const PartSubject& subject : kProcessSubjects)
    if (options.parts.empty() || std::ranges::find(options.parts, subject.part) != options.parts.end())
      subjects.push_back(subject);
  if (subjects.empty())
    return engine::inputError("the study process scans none of these parts", "--parts",
                              "name bracket, steps or ribs");
  job.begin("the paper's process", subjects.size() * static_cast<std::size_t>(seeds * hands));
  std::string gains;
  for (const PartSubject& subject : subjects) {
    ProcessRuns runs;
    for (int seed = 1; seed <= seeds; ++seed)
      if (engine::Status done = runProcess(subject, side, seed, hands, runs, job); !done)
        return tl::unexpected(done.error());
    runs.appendTo(study, subject.name);
    constexpr std::size_t kNear = 1;  // of the columns
    gains += fmt::format("{}{} {:.1f}, {:.1f}, {:.1f}, {:.1f}", gains.empty() ? "" : "; ", subject.name,
                         rowOf(study, subject.name, "median alone").more[kNear],
                         rowOf(study, subject.name, "HEG with median").more[kNear],
                         rowOf(study, subject.name, kBestAlone).more[kNear],
                         rowOf(study, subject.name, kBestByHand).more[kNear]);
  }
  study.reference = fmt::format(
      "The simulated parts' truth; parts of {} x {} samples, {} {} of noise, {} {} on each. Near edges: "
      "within 3 samples of a true edge; flats: further than 12. Box and median: {} x {}, {} passes. HEG: a "
      "hand smooths along all edges and marks them as far as these filters reach, as in the "
      "demonstration. tv and tgv take their range from the noise that they measure.",
      side, side, seeds, seeds == 1 ? "seed" : "seeds", hands, hands == 1 ? "hand" : "hands", kProcessWindow,
      kProcessWindow, kProcessPasses);
  study.answer = fmt::format(
      "Near edges [um], median alone, the same with the paper's process, tgv alone, the same with the "
      "hand's lines: {}.",
      gains);
  return study;
}

}  // namespace fettle::bench
