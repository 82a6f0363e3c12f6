#include "engine/suggest/filter_suggestion.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <optional>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "engine/base/stopwatch.h"
#include "engine/compare/compare.h"
#include "engine/field/builder.h"
#include "engine/filter/catalogue.h"
#include "engine/marks/edge_suggestion.h"
#include "engine/scanner/scanner.h"

namespace fettle::engine {
namespace {

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
constexpr bool kInstrumented = true;
#else
constexpr bool kInstrumented = false;
#endif

SimulatedScan scanOf(const char* part, double noise) {
  ScannerSpec spec;
  spec.part = part;
  spec.width = spec.height = 384;
  spec.noise = noise;
  JobControl job;
  auto scan = simulateScan(spec, job);
  if (!scan) std::abort();
  return *std::move(scan);
}

TruthFigures truly(const SimulatedScan& scan, const FilterCandidate& c) {
  JobControl job;
  Version start = scan.scan;
  if (c.around_edges) {
    EdgeChoice choice;
    choice.thickness = c.thickness;
    start = suggestMarks(start, *findEdges(start, EdgeMap::kUsualSigma, job), choice, job)->field;
  }
  return *compareToTruth(applyFilter(start, start, c.spec, job)->field, scan.truth, scan.edges, job);
}

struct PartAndNoise {
  const char* part;
  double noise;
};

class FilterSuggestionOf : public testing::TestWithParam<PartAndNoise> {};

// The pick alone and what must not be far off: filters that keep edges. A box alone is off by the steps
// themselves, which pieces taken where it is steepest have more of.
TEST_P(FilterSuggestionOf, APartExpectsWhatIsTrulyLeftWithinItsFactor) {
  const auto [part, noise] = GetParam();
  if (kInstrumented && std::string(part) != "wedges")
    GTEST_SKIP() << "its figures are those of any build, and take minutes in this one";
  JobControl job;
  const SimulatedScan scan = scanOf(part, noise);
  SuggestionRequest request;
  request.tolerance = 0.7 * noise * 0.02;
  const auto found = suggestFilter(scan.scan, request, job);
  ASSERT_TRUE(found) << found.error().line();
  for (const FilterCandidate& c : found->candidates) {
    if (!hasRange(c.spec.kind) && &c != &found->picked()) continue;
    const TruthFigures true_figures = truly(scan, c);
    const std::string what = fmt::format("{} {} x{} flat {:.4f} true {:.4f} edge {:.4f} true {:.4f}",
                                         name(c.spec.kind), c.spec.window, c.spec.passes, c.error_flat,
                                         true_figures.rmse_flat, c.error_edge, true_figures.rmse_edge);
    // The most that was found on these, 384 samples a side, 1.39 and 1.22 on the steps, whose noise is found 1.5 % too large:
    // generalised variation and planes leave little of the noise, and the surface, which the former made, has some of it.
    const double most =
        c.spec.kind == FilterKind::kGeneralisedVariation || c.spec.kind == FilterKind::kPlanes ? 1.4 : 1.24;
    EXPECT_LT(c.error_flat, most * true_figures.rmse_flat) << what;
    EXPECT_GT(c.error_flat, true_figures.rmse_flat / 1.16) << what;
    EXPECT_LT(c.error_edge, most * true_figures.rmse_edge) << what;
    EXPECT_GT(c.error_edge, true_figures.rmse_edge / 1.15) << what;
  }
  if (!found->met()) return;
  const TruthFigures left = truly(scan, found->picked());
  EXPECT_LT(left.rmse_flat, 1.1 * request.tolerance);
  EXPECT_LT(left.rmse_edge, 1.1 * request.tolerance);
}

INSTANTIATE_TEST_SUITE_P(Parts, FilterSuggestionOf,
                         testing::Values(PartAndNoise{"bracket", 1.0}, PartAndNoise{"bracket", 3.0},
                                         PartAndNoise{"wedges", 1.0}, PartAndNoise{"steps", 1.0},
                                         PartAndNoise{"die", 1.0}),
                         [](const auto& tried) {
                           return fmt::format("{}_noise_{:.0f}", tried.param.part, tried.param.noise);
                         });

FilterSuggestion suggested(double tolerance, std::optional<double> budget = {}) {
  SuggestionRequest request;
  request.tolerance = tolerance;
  request.budget_s = budget;
  JobControl job;
  return *suggestFilter(scanOf("bracket", 1.0).scan, request, job);
}

TEST(FilterSuggestion, NamesEachCandidateDifferently) {
  std::set<std::string> names;
  const FilterSuggestion found = suggested(0.015);
  for (const FilterCandidate& c : found.candidates)
    EXPECT_TRUE(names.insert(methodOf(c)).second) << methodOf(c);
  EXPECT_TRUE(names.contains("tgv"));
  EXPECT_TRUE(names.contains("tgv, range 1.3 noises"));
}

TEST(FilterSuggestion, LeavesTheScanAsItIsForALooseTolerance) {
  const FilterSuggestion loose = suggested(0.03);
  EXPECT_TRUE(loose.met());
  EXPECT_EQ(loose.picked().spec.window, 1);
}

TEST(FilterSuggestion, PicksTheCheapestWithinTheTolerance) {
  const FilterSuggestion usual = suggested(0.015);
  EXPECT_TRUE(usual.met());
  EXPECT_TRUE(hasRange(usual.picked().spec.kind));
  for (const FilterCandidate& c : usual.candidates)
    if (c.within && &c != &usual.picked()) {
      EXPECT_FALSE(c.betterThan(usual.picked())) << methodOf(c);
    }
  // What the scanner adds to this part: 0.021.
  EXPECT_NEAR(usual.sigma, 0.021, 0.001);
  EXPECT_GT(usual.edge_share, 0.05);

  // Without what costs more than the one that is named, the same is named.
  SuggestionRequest request;
  request.tolerance = 0.015;
  request.only_named = true;
  JobControl job;
  const FilterSuggestion named = *suggestFilter(scanOf("bracket", 1.0).scan, request, job);
  EXPECT_EQ(named.pick, usual.pick);
  EXPECT_EQ(named.picked().error_edge, usual.picked().error_edge);
  for (const FilterCandidate& c : named.candidates)
    EXPECT_EQ(std::isnan(c.error()), c.cost > named.picked().cost) << methodOf(c);
}

TEST(FilterSuggestion, PicksTheNearestWhenNoneIsWithinTheTolerance) {
  const FilterSuggestion tight = suggested(0.001);
  EXPECT_FALSE(tight.met());
  for (const FilterCandidate& c : tight.candidates) EXPECT_GE(c.error(), tight.picked().error());
}

TEST(FilterSuggestion, LeavesTheScanAsItIsWhenThereIsNoTime) {
  EXPECT_EQ(suggested(0.015, 1e-9).picked().spec.window, 1);
}

TEST(FilterSuggestion, SeesOutliers) {
  JobControl job;
  ScannerSpec spec;
  spec.width = spec.height = 300;
  spec.part = "plate";
  const SimulatedScan scan = *simulateScan(spec, job);
  std::vector<float> z(300 * 300);
  scan.scan.reader().readHeights(0, 0, 300, 300, z.data(), 300);
  for (std::size_t i = 50; i < z.size(); i += 103) z[i] += 1.0F;
  SuggestionRequest request;
  request.tolerance = 0.01;  // a box of 9 leaves a tenth of each outlier
  const auto found = suggestFilter(makeField(scan.scan.grid(), z, {}), request, job);
  ASSERT_TRUE(found);
  EXPECT_NEAR(found->outlier_share, 0.01, 0.002);
  EXPECT_TRUE(found->met());
  EXPECT_EQ(found->picked().spec.kind, FilterKind::kMedian);
}

TEST(FilterSuggestion, RefusesWhatItCannotAnswer) {
  JobControl job;
  Grid grid;
  grid.width = grid.height = 40;
  const Version still = makeField(grid, std::vector<float>(1600, 1.0F), {});
  SuggestionRequest request;
  request.tolerance = 1.0;
  EXPECT_EQ(suggestFilter(still, request, job).error().kind, ErrorKind::kInput);
  request.tolerance = 0.0;
  EXPECT_EQ(suggestFilter(still, request, job).error().kind, ErrorKind::kInput);
  const SimulatedScan scan = scanOf("bracket", 1.0);
  request.tolerance = 0.01;
  job.cancel();
  EXPECT_EQ(suggestFilter(scan.scan, request, job).error().kind, ErrorKind::kCancelled);
}

// From the time that generalised variation, a second of the trial, is under way: the time after the cancel beside that of
// the whole, in one run, so that a busy machine slows both.
TEST(FilterSuggestion, StopsInTheMiddleOfAFilterThatItTries) {
  const SimulatedScan scan = scanOf("bracket", 1.0);
  SuggestionRequest request;
  request.tolerance = 0.01;
  JobControl whole_job;
  const Stopwatch whole;
  ASSERT_TRUE(suggestFilter(scan.scan, request, whole_job));
  const double seconds = whole.seconds();
  int cancelled = 0;
  // At several moments, as one alone may be between two candidates.
  for (const double share : {0.3, 0.5, 0.7, 0.9}) {
    JobControl job;
    const Stopwatch watch;
    double cancelled_at = 0.0;
    std::thread canceller([&] {
      std::this_thread::sleep_for(std::chrono::duration<double>(share * seconds));
      cancelled_at = watch.seconds();
      job.cancel();
    });
    const auto found = suggestFilter(scan.scan, request, job);
    const double ended_at = watch.seconds();
    canceller.join();
    if (found) continue;  // it was done before
    ++cancelled;
    EXPECT_EQ(found.error().kind, ErrorKind::kCancelled);
    EXPECT_LT(ended_at - cancelled_at, 0.1 * seconds)
        << "cancelled after " << share << " of " << seconds << " s";
  }
  EXPECT_GE(cancelled, 2);
}

}  // namespace
}  // namespace fettle::engine
