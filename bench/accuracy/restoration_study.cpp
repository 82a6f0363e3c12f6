#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "bench/accuracy/measure.h"
#include "bench/accuracy/plane.h"
#include "bench/accuracy/studies.h"
#include "engine/compare/compare.h"
#include "engine/filter/filter.h"
#include "engine/marks/edge_suggestion.h"
#include "engine/scanner/scanner.h"
#include "haptic/operator/operator_strokes.h"
#include "haptic/replay.h"

namespace fettle::bench {
namespace {

double secondsSince(std::chrono::steady_clock::time_point begin) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

// Where a filter starts from, and what that took of machine and hand.
struct Start {
  const char* name;
  engine::Version field;
  double machine_s = 0.0;
  double hand_s = 0.0;
};

}  // namespace

engine::Result<Study> restorationStudy(const AccuracyOptions& options, engine::JobControl& job) {
  Study study;
  study.id = "restoration";
  study.title = "Restoration: how near the truth, in what time";
  study.question = "Which filter, and is marking the edges worth it?";
  study.cost_name = "machine time";
  study.cost_unit = "s";
  study.error_name = "RMSE against the truth";
  study.error_unit = "um";
  engine::ScannerSpec scanner;
  scanner.width = scanner.height = options.effort >= 0.5 ? 1024 : 512;
  auto simulated = engine::simulateScan(scanner, job);
  if (!simulated) return tl::unexpected(simulated.error());
  const engine::SimulatedScan& scan = *simulated;
  constexpr int kPasses = 2;
  constexpr int kWindows[] = {3, 5, 9};
  constexpr engine::FilterKind kKinds[] = {engine::FilterKind::kBox, engine::FilterKind::kGaussian,
                                           engine::FilterKind::kMedian};

  std::vector<Start> starts{{"alone", scan.scan}};
  {
    const auto begin = std::chrono::steady_clock::now();
    const auto map = engine::findEdges(scan.scan, engine::EdgeMap::kUsualSigma, job);
    if (!map) return tl::unexpected(map.error());
    engine::EdgeChoice choice;
    choice.thickness = kPasses * (kWindows[std::size(kWindows) - 1] / 2) + 1.0;
    auto marked = engine::suggestMarks(scan.scan, *map, choice, job);
    if (!marked) return tl::unexpected(marked.error());
    starts.push_back({"around suggested edges", std::move(marked->field), secondsSince(begin), 0.0});
  }
  {
    haptic::Scene scene = haptic::defaultScene();
    scene.level = haptic::ContactLevel::kCertified;
    scene.certified_radius_cells = 8;
    scene.mark_radius_samples = kPasses * (kWindows[std::size(kWindows) - 1] / 2) + 3.0;
    const std::vector<haptic::StrokeSample> strokes =
        haptic::operatorStrokes(scan.scan, scan.edge_lines, haptic::OperatorSpec{});
    auto touched = haptic::replay(scan.scan, scan.scan, strokes, scene, {}, job);
    if (!touched) return tl::unexpected(touched.error());
    const double hand_s = strokes.empty() ? 0.0 : strokes.back().t;
    starts.push_back({"around edges traced by hand", std::move(touched->field), 0.0, hand_s});
  }

  job.begin("restoration", starts.size() * std::size(kKinds) * std::size(kWindows) + 1);
  const auto judge = [&](const std::string& subject, const std::string& method, const engine::Version& field,
                         double seconds, double hand_s) -> engine::Status {
    engine::JobControl quiet;
    const auto figures = engine::compareToTruth(field, scan.truth, scan.edges, quiet);
    if (!figures) return tl::unexpected(figures.error());
    AccuracyRow row;
    row.subject = subject;
    row.method = method;
    row.cost = row.cost_worst = seconds;
    row.error = 1e3 * figures->rmse;
    row.error_p99 = std::numeric_limits<double>::quiet_NaN();
    row.error_worst = std::numeric_limits<double>::quiet_NaN();
    row.wrong = std::numeric_limits<double>::quiet_NaN();
    row.hash = engine::contentHash(field);
    row.note = fmt::format("flats {:.2f}, near edges {:.1f} um, edge width {:.3f} mm{}",
                           1e3 * figures->rmse_flat, 1e3 * figures->rmse_edge, figures->edge_width,
                           hand_s > 0.0 ? fmt::format(", {:.0f} s by hand", hand_s) : "");
    study.rows.push_back(std::move(row));
    job.advance();
    return {};
  };
  if (auto ok = judge("scan as it came", "nothing", scan.scan, 0.0, 0.0); !ok)
    return tl::unexpected(ok.error());
  for (const Start& start : starts)
    for (const engine::FilterKind kind : kKinds)
      for (const int window : kWindows) {
        if (job.cancelled()) return engine::cancelled();
        engine::FilterSpec spec;
        spec.kind = kind;
        spec.window = window;
        spec.passes = kPasses;
        engine::JobControl quiet;
        const auto begin = std::chrono::steady_clock::now();
        const auto filtered = engine::applyFilter(start.field, scan.scan, spec, quiet);
        if (!filtered) return tl::unexpected(filtered.error());
        const double seconds = start.machine_s + secondsSince(begin);
        if (auto ok = judge(start.name, fmt::format("{} {}", engine::name(kind), window), filtered->field,
                            seconds, start.hand_s);
            !ok)
          return tl::unexpected(ok.error());
      }
  study.reference =
      "The simulated part's truth, a formula in millimetres (fettle synth). Near edges: within 3 samples of "
      "a true "
      "edge. Figures on flats, near edges (within 3 samples) and edge width are in the notes; two "
      "passes each.";
  const auto best = [&](const std::string& subject) -> const AccuracyRow& {
    const AccuracyRow* least = nullptr;
    for (const AccuracyRow& row : study.rows)
      if (row.subject == subject && (least == nullptr || row.error < least->error)) least = &row;
    return *least;
  };
  const AccuracyRow &alone = best("alone"), &suggested = best("around suggested edges"),
                    &traced = best("around edges traced by hand");
  study.answer = fmt::format(
      "Over the whole part the scan is {:.1f} um off. The best filter alone ({}) brings {:.1f} um, around "
      "edges that the "
      "program suggests {:.1f} um ({}), around edges traced by hand {:.1f} um ({}). Marked samples keep "
      "their noise; "
      "what the filter did not reach over is what a filter alone destroys.",
      study.rows.front().error, alone.method, alone.error, suggested.error, suggested.method, traced.error,
      traced.method);
  return study;
}

}  // namespace fettle::bench
