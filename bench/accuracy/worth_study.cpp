#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <limits>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "bench/accuracy/drawn_scan.h"
#include "bench/accuracy/measure.h"
#include "bench/accuracy/studies.h"
#include "bench/accuracy/timed_strokes.h"
#include "engine/base/stopwatch.h"
#include "engine/compare/compare.h"
#include "engine/edges/locate.h"
#include "engine/filter/noise_range.h"
#include "engine/marks/edge_traces.h"
#include "engine/scanner/true_lines.h"
#include "engine/suggest/worth_places.h"

namespace fettle::bench {
namespace {

constexpr PartSubject kWorthSubjects[] = {
    {"bracket", "bracket", 1.0, 0.0},
    {"bracket, noise x 3", "bracket", 3.0, 0.0},
    {"steps", "steps", 1.0, 0.0},
    {"steps, noise x 3", "steps", 3.0, 0.0},
    {"ribs", "ribs", 1.0, 0.0},
    {"ribs, noise x 3", "ribs", 3.0, 0.0},
    {"wedges", "wedges", 1.0, 0.0},
    {"wedges, noise x 3", "wedges", 3.0, 0.0},
    {"housing", "housing", 1.0, 0.0},
    {"housing, noise x 3", "housing", 3.0, 0.0},
    {"bracket, 2 % mixed pixels", "bracket", 1.0, 0.02},
    {"steps, 2 % mixed pixels", "steps", 1.0, 0.02},
};

// The search for places was chosen on seeds 1 to 4.
constexpr int kFirstSeed = 21;

constexpr double kMoments_s[] = {15.0, 30.0, 60.0, 120.0};
constexpr std::size_t kMoments = std::size(kMoments_s) + 1;  // and the end

enum WorthColumn : std::uint8_t { kNear, kShareGained, kExpected };

// Errors of one run over the whole part and near edges [um].
struct Left {
  double all = 0.0, near = 0.0;
};

// What is left when a person stops at a moment, of both orders.
struct Moment {
  double seconds = 0.0;
  Left by_list, by_length;
};

struct WorthRun {
  Left alone, ceiling;  // nothing, true lines
  Left suggested;       // lines along the suggested edges, without a hand
  std::array<Moment, kMoments> moments;
  Left all_edges;  // drawn
  double all_edges_s = 0.0;
  double expected = 0.0;  // RMSE after the list, as the list says [um]
  double places = 0.0, search_s = 0.0;
};

engine::Result<Left> leftWith(const engine::SimulatedScan& scan, std::vector<engine::EdgeLine> lines,
                              const engine::FilterSpec& spec) {
  engine::JobControl quiet;
  engine::Version field = scan.scan;
  if (!lines.empty())
    field = field.withLines(std::make_shared<const std::vector<engine::EdgeLine>>(std::move(lines)));
  const auto filtered = engine::applyFilter(field, field, spec, quiet);
  if (!filtered) return tl::unexpected(filtered.error());
  const auto figures = engine::compareToTruth(filtered->field, scan.truth, scan.edges, quiet);
  if (!figures) return tl::unexpected(figures.error());
  return Left{1e3 * figures->rmse, 1e3 * figures->rmse_edge};
}

engine::Result<Left> leftAfter(const engine::SimulatedScan& scan,
                               const std::vector<engine::EdgeStroke>& strokes,
                               const engine::FilterSpec& spec) {
  engine::JobControl quiet;
  auto lines = engine::locateEdgeLines(scan.scan.reader(), spec.range_sigma, strokes, {}, quiet);
  if (!lines) return tl::unexpected(lines.error());
  return leftWith(scan, *std::move(lines), spec);
}

// What the window's suggestion of edges gives when it is taken as it is.
engine::Result<Left> leftBySuggestion(const engine::SimulatedScan& scan, const engine::FilterSpec& spec) {
  engine::JobControl quiet;
  const auto map = engine::findEdges(scan.scan, engine::EdgeMap::kUsualSigma, quiet);
  if (!map) return tl::unexpected(map.error());
  auto traces = engine::traceEdges(scan.scan.grid(), *map, {}, quiet);
  if (!traces) return tl::unexpected(traces.error());
  std::vector<engine::EdgeStroke> strokes;
  for (engine::EdgeTrace& trace : *traces)
    strokes.push_back({static_cast<std::int64_t>(strokes.size()), std::move(trace.points), trace.closed});
  return leftAfter(scan, strokes, spec);
}

engine::Result<WorthRun> runWorth(const PartSubject& subject, std::int32_t side, int seed,
                                  engine::JobControl& job) {
  engine::JobControl quiet;
  const auto scan = scanOf(subject, side, seed);
  if (!scan) return tl::unexpected(scan.error());
  engine::FilterSpec spec;
  spec.kind = engine::FilterKind::kGeneralisedVariation;
  const auto ready = engine::withMeasuredRange(spec, scan->scan, quiet);
  if (!ready) return tl::unexpected(ready.error());
  WorthRun run;
  const auto alone = leftWith(*scan, {}, *ready);
  if (!alone) return tl::unexpected(alone.error());
  run.alone = *alone;
  const auto ceiling = leftWith(*scan, engine::trueLines(*scan), *ready);
  if (!ceiling) return tl::unexpected(ceiling.error());
  run.ceiling = *ceiling;
  const auto suggested = leftBySuggestion(*scan, *ready);
  if (!suggested) return tl::unexpected(suggested.error());
  run.suggested = *suggested;

  engine::WorthRequest request;
  request.noise = ready->range_sigma;
  const engine::Stopwatch watch;
  const auto found = engine::findWorthPlaces(scan->scan, request, quiet);
  if (!found) return tl::unexpected(found.error());
  run.search_s = watch.seconds();
  double gain = 0.0;
  for (const engine::WorthPlace& place : found->places) gain += place.gain;
  run.expected = 1e3 * std::sqrt(std::max(0.0, 1e-6 * run.alone.all * run.alone.all -
                                                   gain / static_cast<double>(scan->scan.grid().samples())));
  run.places = static_cast<double>(found->places.size());
  const DrawnEdges drawn = drawnEdges(*scan, seed);
  const auto listed = strokesAtPlaces(*scan, drawn, found->places, request.pace.reach_s);
  const auto longest = strokesByLength(*scan, drawn, request.pace.reach_s);
  const double end_s = listed.empty() ? 0.0 : listed.back().ends_s;
  for (std::size_t m = 0; m < kMoments; ++m) {
    if (job.cancelled()) return engine::cancelled();
    Moment& now = run.moments[m];
    now.seconds = m + 1 < kMoments ? std::min(kMoments_s[m], end_s) : end_s;
    if (m > 0 && now.seconds == run.moments[m - 1].seconds) {
      now = run.moments[m - 1];
    } else {
      const auto by_list = leftAfter(*scan, drawnUntil(listed, now.seconds), *ready);
      if (!by_list) return tl::unexpected(by_list.error());
      const auto by_length = leftAfter(*scan, drawnUntil(longest, now.seconds), *ready);
      if (!by_length) return tl::unexpected(by_length.error());
      now.by_list = *by_list;
      now.by_length = *by_length;
    }
    job.advance();
  }
  run.all_edges_s = longest.back().ends_s;
  const auto all_edges = leftAfter(*scan, drawn.strokes, *ready);
  if (!all_edges) return tl::unexpected(all_edges.error());
  run.all_edges = *all_edges;
  return run;
}

std::string momentName(std::size_t m) {
  return m + 1 < kMoments ? fmt::format("{:g} s", kMoments_s[m]) : std::string("end of the list");
}

// Mean over the runs.
template <class Of>
double meanOf(const std::vector<WorthRun>& runs, Of&& of) {
  double sum = 0.0;
  for (const WorthRun& run : runs) sum += of(run);
  return sum / static_cast<double>(runs.size());
}

AccuracyRow plainRow(std::string subject, std::string method, double seconds, double error) {
  AccuracyRow row;
  row.subject = std::move(subject);
  row.method = std::move(method);
  row.cost = row.cost_worst = seconds;
  row.error = error;
  row.error_p99 = row.error_worst = row.wrong = std::numeric_limits<double>::quiet_NaN();
  return row;
}

// Rows of a scan: following the list, as a share of what the filter leaves alone.
void addScanRows(const char* name, const std::vector<WorthRun>& runs, Study& study) {
  const double ceiling = meanOf(runs, [](const WorthRun& r) { return r.ceiling.all; });
  const double suggested = meanOf(runs, [](const WorthRun& r) { return r.suggested.all; });
  const double all_edges = meanOf(runs, [](const WorthRun& r) { return r.all_edges.all; });
  const double all_edges_s = meanOf(runs, [](const WorthRun& r) { return r.all_edges_s; });
  const auto add = [&](std::string method, double seconds, auto list, auto length) {
    AccuracyRow row =
        plainRow(name, std::move(method), seconds,
                 meanOf(runs, [&](const WorthRun& r) { return 100.0 * list(r).all / r.alone.all; }));
    row.error_worst = 0.0;
    for (const WorthRun& r : runs)
      row.error_worst = std::max(row.error_worst, 100.0 * list(r).all / r.alone.all);
    row.more = {meanOf(runs, [&](const WorthRun& r) { return list(r).all; }),
                meanOf(runs, [&](const WorthRun& r) { return list(r).near; }),
                meanOf(runs, [&](const WorthRun& r) { return length(r).all; }),
                all_edges,
                all_edges_s,
                ceiling,
                suggested,
                meanOf(runs, [](const WorthRun& r) { return r.expected; }),
                meanOf(runs, [](const WorthRun& r) { return r.places; }),
                meanOf(runs, [](const WorthRun& r) { return r.search_s; })};
    study.rows.push_back(std::move(row));
  };
  const auto alone = [](const WorthRun& r) { return r.alone; };
  add("nothing", 0.0, alone, alone);
  for (std::size_t m = 0; m < kMoments; ++m)
    add(
        momentName(m), meanOf(runs, [&](const WorthRun& r) { return r.moments[m].seconds; }),
        [m](const WorthRun& r) { return r.moments[m].by_list; },
        [m](const WorthRun& r) { return r.moments[m].by_length; });
}

// Both orders on one scan, and what they could come to.
Study viewOfScan(const char* name, std::size_t number, const std::vector<WorthRun>& runs) {
  Study view;
  view.id = fmt::format("worth_{}", number);
  view.title = fmt::format("On {}", name);
  view.cost.name = "time of the hand";
  view.cost.unit = "s";
  view.cost_from_zero = true;
  view.error.name = "RMSE against the truth";
  view.error.unit = "um";
  const double alone = meanOf(runs, [](const WorthRun& r) { return r.alone.all; });
  const double all_edges_s = meanOf(runs, [](const WorthRun& r) { return r.all_edges_s; });
  view.rows.push_back(plainRow("the list", "nothing", 0.0, alone));
  view.rows.push_back(plainRow("longest edges first", "nothing", 0.0, alone));
  for (std::size_t m = 0; m < kMoments; ++m) {
    const double seconds = meanOf(runs, [&](const WorthRun& r) { return r.moments[m].seconds; });
    view.rows.push_back(plainRow("the list", momentName(m), seconds,
                                 meanOf(runs, [&](const WorthRun& r) { return r.moments[m].by_list.all; })));
    view.rows.push_back(
        plainRow("longest edges first", momentName(m), seconds,
                 meanOf(runs, [&](const WorthRun& r) { return r.moments[m].by_length.all; })));
  }
  view.rows.push_back(plainRow("longest edges first", "all edges", all_edges_s,
                               meanOf(runs, [](const WorthRun& r) { return r.all_edges.all; })));
  view.rows.push_back(plainRow("suggested lines, no hand", "suggested lines", 0.0,
                               meanOf(runs, [](const WorthRun& r) { return r.suggested.all; })));
  view.rows.push_back(plainRow("true lines", "true lines", all_edges_s,
                               meanOf(runs, [](const WorthRun& r) { return r.ceiling.all; })));
  return view;
}

}  // namespace

engine::Result<Study> worthStudy(const AccuracyOptions& options, engine::JobControl& job) {
  Study study;
  study.id = "worth";
  study.title = "What a minute of a person's time buys";
  study.question = "How much does a hand gain that goes where the program expects the most, and when?";
  study.cost.name = "time of the hand";
  study.cost.unit = "s";
  study.cost_from_zero = true;
  study.error.name = "RMSE against the truth, over that of tgv alone";
  study.error.unit = "%";
  study.columns = {"RMSE [um]",
                   "near edges [um]",
                   "longest edges first [um]",
                   "all edges drawn [um]",
                   "all edges drawn [s]",
                   "true lines [um]",
                   "suggested lines, no hand [um]",
                   "expected at the end [um]",
                   "places",
                   "search [s]"};
  const ScanSizes sizes = scanSizes(options.effort);
  job.begin("places of most worth",
            std::size(kWorthSubjects) * static_cast<std::size_t>(sizes.seeds) * kMoments);
  std::string gains, nothing;
  std::size_t number = 0;
  for (const PartSubject& subject : kWorthSubjects) {
    std::vector<WorthRun> runs;
    for (int seed = kFirstSeed; seed < kFirstSeed + sizes.seeds; ++seed) {
      auto run = runWorth(subject, sizes.side, seed, job);
      if (!run) return tl::unexpected(run.error());
      runs.push_back(*run);
    }
    addScanRows(subject.name, runs, study);
    study.views.push_back(viewOfScan(subject.name, ++number, runs));
    const double alone = meanOf(runs, [](const WorthRun& r) { return r.alone.all; });
    const double all_edges = meanOf(runs, [](const WorthRun& r) { return r.all_edges.all; });
    const double listed = meanOf(runs, [](const WorthRun& r) { return r.moments.back().by_list.all; });
    const double list_s = meanOf(runs, [](const WorthRun& r) { return r.moments.back().seconds; });
    const double at_length = meanOf(runs, [](const WorthRun& r) { return r.moments.back().by_length.all; });
    const double all_s = meanOf(runs, [](const WorthRun& r) { return r.all_edges_s; });
    if (std::min(all_edges, listed) > 0.97 * alone)
      nothing += fmt::format("{}{} ({:.0f} s)", nothing.empty() ? "" : "; ", subject.name, list_s);
    else
      gains += fmt::format(
          "{}{}: {:.1f} um alone, {:.1f} with suggested lines and no hand, {:.1f} after the list's {:.0f} s, "
          "{:.1f} after as many on the longest edges, {:.1f} after all edges' {:.0f} s",
          gains.empty() ? "" : "; ", subject.name, alone,
          meanOf(runs, [](const WorthRun& r) { return r.suggested.all; }), listed, list_s, at_length,
          all_edges, all_s);
  }
  study.reference = fmt::format(
      "The simulated parts' truth; parts of {} x {} samples, {} {} of noise and of the hand that the search "
      "for places was "
      "not chosen by. A hand needs {:.2f} s to come to each stroke, whatever its order, and draws 20 mm/s "
      "along the true "
      "edge nearest to a place; where a place shows none it loses the time. Every row is tgv with the lines "
      "located from "
      "the strokes drawn so far.",
      sizes.side, sizes.side, sizes.seeds, sizes.seeds == 1 ? "seed" : "seeds", engine::HandPace{}.reach_s);
  study.answer = fmt::format("{}. Less than 3 % to gain, with all edges as with the list's (its time): {}.",
                             gains.empty() ? "Nothing" : gains, nothing.empty() ? "none" : nothing);
  return study;
}

}  // namespace fettle::bench
