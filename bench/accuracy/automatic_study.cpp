#include <array>
#include <cstddef>
#include <iterator>
#include <vector>

#include <fmt/format.h>

#include "bench/accuracy/drawn_scan.h"
#include "bench/accuracy/measure.h"
#include "bench/accuracy/studies.h"
#include "bench/accuracy/truth_errors.h"
#include "engine/base/stopwatch.h"
#include "engine/filter/catalogue.h"
#include "engine/filter/noise_range.h"

namespace fettle::bench {
namespace {

struct Scanned {
  PartSubject part;
  int side;  // of the field at full effort [samples]
};
constexpr Scanned kScanned[] = {
    {{"bracket", "bracket", 1.0}, 2048},
    {{"steps, noise x 3", "steps", 3.0}, 1024},
    {{"ribs, noise x 3", "ribs", 3.0}, 1024},
    {{"wedges", "wedges", 1.0}, 1024},
    {{"housing", "housing", 1.0}, 1024},
    {{"bracket, 2 % mixed pixels", "bracket", 1.0, 0.02}, 1024},
    {{"steps, 2 % mixed pixels", "steps", 1.0, 0.02}, 1024},
};

struct Method {
  const char* name;
  engine::FilterKind kind;
  int window;
  int passes;
};
constexpr Method kMethods[] = {
    {"median 5, 2 passes", engine::FilterKind::kMedian, 5, 2},
    {"bilateral 7", engine::FilterKind::kBilateral, 7, 1},
    {"tv 31", engine::FilterKind::kTotalVariation, 31, 1},
    {"planes", engine::FilterKind::kPlanes, 3, 1},
    {"tgv", engine::FilterKind::kGeneralisedVariation, 3, 1},
};

constexpr std::size_t kNear = 1;  // of the columns

// What one method left of all seeds of a scan.
struct Figures {
  std::vector<TruthErrors> errors;
  std::vector<double> ns_per_sample;
};

// With one thread and the range that the filter's own measure of the noise gives.
engine::Result<engine::Version> filteredBy(const Method& method, const engine::Version& scan, double& ns) {
  engine::FilterSpec spec;
  spec.kind = method.kind;
  spec.window = method.window;
  spec.passes = method.passes;
  spec.threads = 1;
  engine::JobControl quiet;
  const auto ready = engine::withMeasuredRange(spec, scan, quiet);
  if (!ready) return tl::unexpected(ready.error());
  const engine::Stopwatch watch;
  auto filtered = engine::applyFilter(scan, scan, *ready, quiet);
  if (!filtered) return tl::unexpected(filtered.error());
  ns = watch.ns() / (static_cast<double>(scan.grid().width) * scan.grid().height);
  return std::move(filtered->field);
}

}  // namespace

engine::Result<Study> automaticStudy(const AccuracyOptions& options, engine::JobControl& job) {
  Study study{"automatic",
              "Automatic filters: what is left without a hand",
              "How near the truth does a filter come by itself, on which part?",
              {"time per sample, one thread", "ns"},
              {"RMSE against the truth", "um"}};
  study.columns = {"flats [um]", "near edges [um]", "near edges, worst seed [um]"};
  const int seeds = scanSizes(options.effort).seeds;
  const int shrink = options.effort >= 0.5 ? 1 : options.effort >= 0.05 ? 2 : 4;
  job.begin("automatic filters",
            std::size(kScanned) * static_cast<std::size_t>(seeds) * (std::size(kMethods) + 1));
  for (const Scanned& scanned : kScanned) {
    std::array<Figures, std::size(kMethods) + 1> found;  // the scan itself first
    for (int seed = 1; seed <= seeds; ++seed) {
      const auto scan = scanOf(scanned.part, scanned.side / shrink, seed);
      if (!scan) return tl::unexpected(scan.error());
      for (std::size_t m = 0; m < found.size(); ++m) {
        if (job.cancelled()) return engine::cancelled();
        double ns = 0.0;
        engine::Result<engine::Version> result = scan->scan;
        if (m > 0) result = filteredBy(kMethods[m - 1], scan->scan, ns);
        if (!result) return tl::unexpected(result.error());
        const auto errors = truthErrors(*result, *scan);
        if (!errors) return tl::unexpected(errors.error());
        found[m].errors.push_back(*errors);
        found[m].ns_per_sample.push_back(ns);
        job.advance();
      }
    }
    for (std::size_t m = 0; m < found.size(); ++m)
      study.rows.push_back(rowOfErrors(scanned.part.name, m == 0 ? "nothing" : kMethods[m - 1].name,
                                       found[m].errors, found[m].ns_per_sample));
  }
  study.reference = fmt::format(
      "The simulated parts' truth, formulas in millimetres (fettle synth), with {} {} of noise each. Near "
      "edges: within 3 samples of a true edge; flats: further than 12. Every filter takes its range sigma "
      "from the scan's noise as it measures it; no parameter was chosen by the part.",
      seeds, seeds == 1 ? "seed" : "seeds");
  const AccuracyRow& bracket = rowOf(study, "bracket", "tgv");
  const AccuracyRow& plain = rowOf(study, "bracket", "tv 31");
  const AccuracyRow& steps = rowOf(study, "steps, noise x 3", "tgv");
  const AccuracyRow& plain_steps = rowOf(study, "steps, noise x 3", "tv 31");
  study.answer = fmt::format(
      "On the bracket tgv leaves {:.1f} um over all and {:.1f} near edges, tv {:.1f} and {:.1f}; on steps of "
      "the noise's own size {:.1f} and {:.1f} against {:.1f} and {:.1f}. Where scanners leave mixed pixels, "
      "tgv leaves {:.0f} um of the bracket's {:.0f}.",
      bracket.error, bracket.more[kNear], plain.error, plain.more[kNear], steps.error, steps.more[kNear],
      plain_steps.error, plain_steps.more[kNear], rowOf(study, "bracket, 2 % mixed pixels", "tgv").error,
      rowOf(study, "bracket, 2 % mixed pixels", "nothing").error);
  return study;
}

}  // namespace fettle::bench
