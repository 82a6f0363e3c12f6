#include <algorithm>
#include <iterator>
#include <limits>

#include <fmt/format.h>

#include "bench/accuracy/measure.h"
#include "bench/accuracy/plane.h"
#include "bench/accuracy/studies.h"
#include "engine/base/stopwatch.h"
#include "engine/compare/compare.h"
#include "engine/filter/catalogue.h"
#include "engine/filter/noise_range.h"
#include "engine/marks/edge_suggestion.h"
#include "engine/scanner/scanner.h"
#include "haptic/operator/operator_strokes.h"
#include "haptic/tick/replay.h"

namespace fettle::bench {
namespace {

// Input of a filter, and the machine time and manual time it took.
struct Start {
  const char* name;
  engine::Version field;
  double machine_s = 0.0;
  double hand_s = 0.0;
};

struct FilterSetting {
  engine::FilterKind kind;
  int window;
  int passes;
};
constexpr FilterSetting kFilterSettings[] = {
    {engine::FilterKind::kBox, 3, 2},
    {engine::FilterKind::kBox, 5, 2},
    {engine::FilterKind::kBox, 9, 2},
    {engine::FilterKind::kGaussian, 3, 2},
    {engine::FilterKind::kGaussian, 5, 2},
    {engine::FilterKind::kGaussian, 9, 2},
    {engine::FilterKind::kMedian, 3, 2},
    {engine::FilterKind::kMedian, 5, 2},
    {engine::FilterKind::kMedian, 9, 2},
    {engine::FilterKind::kBilateral, 5, 1},
    {engine::FilterKind::kBilateral, 7, 1},
    {engine::FilterKind::kTotalVariation, 17, 1},
    {engine::FilterKind::kTotalVariation, 31, 1},
    {engine::FilterKind::kGeneralisedVariation, engine::FilterSpec{}.window, 1},
};
// Marks keep a box of 9, applied twice, away from the edge itself. Edge-preserving filters need less.
constexpr int kReach = 2 * (9 / 2);

enum Column : std::uint8_t { kFlats, kNearEdges, kWidth, kHand };

engine::FilterSpec specOf(const FilterSetting& setting) {
  engine::FilterSpec spec;
  spec.kind = setting.kind;
  spec.window = setting.window;
  spec.passes = setting.passes;
  return spec;
}

// How a hand works: what it smooths and marks, and which edges it omits.
struct Care {
  const char* name;
  int smooth_passes;
  double shortest_mm;
};
constexpr Care kCares[] = {
    {"by hand: long edges", 0, 60.0},
    {"by hand: all edges", 0, 0.0},
    {"by hand: all, smoothed too", 1, 0.0},
};

engine::Result<std::vector<Start>> startsOf(const engine::SimulatedScan& scan, engine::JobControl& job) {
  std::vector<Start> starts{{"alone", scan.scan}};
  {
    const engine::Stopwatch watch;
    const auto map = engine::findEdges(scan.scan, engine::EdgeMap::kUsualSigma, job);
    if (!map) return tl::unexpected(map.error());
    engine::EdgeChoice choice;
    choice.thickness = kReach + 1.0;
    auto marked = engine::suggestMarks(scan.scan, *map, choice, job);
    if (!marked) return tl::unexpected(marked.error());
    starts.push_back({"around suggested edges", std::move(marked->field), watch.seconds(), 0.0});
  }
  for (const Care& care : kCares) {
    haptic::Scene scene = haptic::defaultScene();
    scene.level = haptic::ContactLevel::kCertified;
    scene.certified_radius_cells = 8;
    scene.mark_radius_samples = kReach + 3.0;
    haptic::OperatorSpec hand;
    hand.smooth_passes = care.smooth_passes;
    hand.shortest_mm = care.shortest_mm;
    const std::vector<haptic::StrokeSample> strokes =
        haptic::operatorStrokes(scan.scan, scan.edge_lines, haptic::offTheEdges(hand, scan.scan.grid()));
    auto touched = haptic::replay(scan.scan, scan.scan, strokes, scene, {}, job);
    if (!touched) return tl::unexpected(touched.error());
    starts.push_back({care.name, std::move(touched->field), 0.0, strokes.empty() ? 0.0 : strokes.back().t});
  }
  return starts;
}

bool keepsEdges(const std::string& method) {
  return std::ranges::any_of(engine::filters(), [&](const engine::Filter& filter) {
    return filter.keeps_edges && method.starts_with(filter.word);
  });
}

const AccuracyRow* bestOf(const Study& study, const std::string& subject, bool edge_preserving) {
  const AccuracyRow* least = nullptr;
  for (const AccuracyRow& row : study.rows)
    if (row.subject == subject && keepsEdges(row.method) == edge_preserving &&
        (least == nullptr || row.error < least->error))
      least = &row;
  return least;
}

// The effect of manual time: for each start, the best filter of either family.
Study effortView(const Study& study, const std::vector<Start>& starts) {
  Study view;
  view.id = "restoration_effort";
  view.title = "The same over the operator's time, best filter of each family";
  view.cost.name = "operator's time";
  view.cost.unit = "s";
  view.cost_from_zero = true;
  view.error.name = study.error.name;
  view.error.unit = study.error.unit;
  for (const bool edge_preserving : {false, true})
    for (const Start& start : starts) {
      AccuracyRow row = *bestOf(study, start.name, edge_preserving);
      row.subject = edge_preserving ? "bilateral, tv, tgv" : "box, Gaussian, median";
      row.method = start.name;
      row.cost = row.cost_worst = start.hand_s;
      view.rows.push_back(std::move(row));
    }
  return view;
}

}  // namespace

engine::Result<Study> restorationStudy(const AccuracyOptions& options, engine::JobControl& job) {
  Study study{"restoration",
              "Restoration: how near the truth, in what time",
              "Which filter, and is marking the edges worth it?",
              {"machine time", "s"},
              {"RMSE against the truth", "um"}};
  study.columns = {"flats [um]", "near edges [um]", "edge width [mm]", "by hand [s]"};
  engine::ScannerSpec scanner;
  scanner.width = scanner.height = options.effort >= 0.5 ? 1024 : options.effort >= 0.05 ? 512 : 256;
  auto simulated = engine::simulateScan(scanner, job);
  if (!simulated) return tl::unexpected(simulated.error());
  const engine::SimulatedScan& scan = *simulated;
  const auto starts = startsOf(scan, job);
  if (!starts) return tl::unexpected(starts.error());

  job.begin("restoration", starts->size() * std::size(kFilterSettings) + 1);
  const auto judge = [&](const std::string& subject, const std::string& method, const engine::Version& field,
                         double seconds, double hand_s) -> engine::Status {
    engine::JobControl quiet;
    const auto figures = engine::compareToTruth(field, scan.truth, scan.edges, quiet);
    if (!figures) return tl::unexpected(figures.error());
    AccuracyRow row{subject, method};
    row.cost = row.cost_worst = seconds;
    row.error = 1e3 * figures->rmse;
    row.error_p99 = std::numeric_limits<double>::quiet_NaN();
    row.error_worst = std::numeric_limits<double>::quiet_NaN();
    row.wrong = std::numeric_limits<double>::quiet_NaN();
    row.hash = engine::contentHash(field);
    row.more = {1e3 * figures->rmse_flat, 1e3 * figures->rmse_edge, figures->edge_width, hand_s};
    study.rows.push_back(std::move(row));
    job.advance();
    return {};
  };
  if (auto ok = judge("unfiltered scan", "nothing", scan.scan, 0.0, 0.0); !ok)
    return tl::unexpected(ok.error());
  for (const Start& start : *starts)
    for (const FilterSetting& setting : kFilterSettings) {
      if (job.cancelled()) return engine::cancelled();
      engine::JobControl quiet;
      const engine::Stopwatch watch;
      const auto spec = engine::withMeasuredRange(specOf(setting), scan.scan, quiet);
      if (!spec) return tl::unexpected(spec.error());
      const auto filtered = engine::applyFilter(start.field, scan.scan, *spec, quiet);
      if (!filtered) return tl::unexpected(filtered.error());
      const double seconds = start.machine_s + watch.seconds();
      std::string method(engine::name(setting.kind));
      if (engine::filterOf(setting.kind).window.exists()) method += fmt::format(" {}", setting.window);
      if (setting.passes > 1) method += fmt::format(", {} passes", setting.passes);
      if (auto ok = judge(start.name, method, filtered->field, seconds, start.hand_s); !ok)
        return tl::unexpected(ok.error());
    }
  study.reference =
      "The simulated part's truth, a formula in millimetres (fettle synth). Near edges: within 3 samples of "
      "a true edge; flats: further than 12. Bilateral, tv and tgv take their range sigma from the scan's "
      "noise, which their time includes. The hand is simulated (tremor and wander as measured on surgeons) "
      "and traces the part's edges once for each thing it does.";
  const auto figures = [](const AccuracyRow& row) {
    return fmt::format("{:.1f} um ({}: flats {:.1f}, near edges {:.1f}, edges {:.2f} mm wide)", row.error,
                       row.method, row.more[kFlats], row.more[kNearEdges], row.more[kWidth]);
  };
  const char* by_hand = kCares[1].name;
  const double hand_s = bestOf(study, by_hand, true)->more[kHand];
  study.answer = fmt::format(
      "Over the whole part the scan is {:.1f} um off. Of the filters that know no edges the best alone "
      "brings {}, around edges that the program suggests {}, around all edges marked by hand in {:.0f} s {}. "
      "A filter that keeps edges by itself brings {} alone and {} around those marked by hand: marked "
      "samples keep their noise, so that marking pays for a box, and for these only where not a sample of "
      "an edge may move.",
      study.rows.front().error, figures(*bestOf(study, "alone", false)),
      figures(*bestOf(study, "around suggested edges", false)), hand_s,
      figures(*bestOf(study, by_hand, false)), figures(*bestOf(study, "alone", true)),
      figures(*bestOf(study, by_hand, true)));
  study.views.push_back(effortView(study, *starts));
  return study;
}

}  // namespace fettle::bench
