#include "engine/suggest/filter_suggestion.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "engine/compare/compare.h"
#include "engine/field/builder.h"
#include "engine/marks/edge_suggestion.h"
#include "engine/scanner/scanner.h"

namespace fettle::engine {
namespace {

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

// The pick alone and what must not be far off: filters that keep edges. A box alone is off by the steps
// themselves, which pieces taken where it is steepest have more of.
TEST(FilterSuggestion, ExpectsWhatIsTrulyLeftWithinItsFactor) {
  JobControl job;
  for (const char* part : {"bracket", "wedges", "steps", "die"})
    for (const double noise : {1.0, 3.0}) {
      if (noise > 1.0 && std::string(part) != "bracket") continue;
      const SimulatedScan scan = scanOf(part, noise);
      SuggestionRequest request;
      request.tolerance = 0.7 * noise * 0.02;
      const auto found = suggestFilter(scan.scan, request, job);
      ASSERT_TRUE(found) << found.error().line();
      for (const FilterCandidate& c : found->candidates) {
        if (!hasRange(c.spec.kind) && &c != &found->picked()) continue;
        const TruthFigures true_figures = truly(scan, c);
        const std::string what =
            fmt::format("{} {} {} {} x{} flat {:.4f} true {:.4f} edge {:.4f} true {:.4f}", part, noise,
                        name(c.spec.kind), c.spec.window, c.spec.passes, c.error_flat, true_figures.rmse_flat,
                        c.error_edge, true_figures.rmse_edge);
        EXPECT_LT(c.error_flat, 1.8 * true_figures.rmse_flat) << what;
        EXPECT_GT(c.error_flat, true_figures.rmse_flat / 1.4) << what;
        EXPECT_LT(c.error_edge, 1.8 * true_figures.rmse_edge) << what;
        EXPECT_GT(c.error_edge, true_figures.rmse_edge / 1.4) << what;
      }
      if (found->met()) {
        const TruthFigures left = truly(scan, found->picked());
        EXPECT_LT(left.rmse_flat, 1.2 * request.tolerance) << part << noise;
        EXPECT_LT(left.rmse_edge, 1.2 * request.tolerance) << part << noise;
      }
    }
}

TEST(FilterSuggestion, AnswersByToleranceAndBudget) {
  const SimulatedScan scan = scanOf("bracket", 1.0);
  JobControl job;
  const auto suggested = [&](double tolerance, std::optional<double> budget) {
    SuggestionRequest request;
    request.tolerance = tolerance;
    request.budget_s = budget;
    return *suggestFilter(scan.scan, request, job);
  };
  const FilterSuggestion loose = suggested(0.03, {});
  EXPECT_TRUE(loose.met());
  EXPECT_EQ(loose.picked().spec.window, 1) << "the scan as it is";
  const FilterSuggestion usual = suggested(0.015, {});
  EXPECT_TRUE(usual.met());
  EXPECT_TRUE(hasRange(usual.picked().spec.kind));
  for (const FilterCandidate& c : usual.candidates)
    if (c.within) {
      EXPECT_GE(c.seconds, usual.picked().seconds);
    }
  EXPECT_NEAR(usual.sigma, 0.02, 0.001);
  EXPECT_GT(usual.edge_share, 0.05);
  const FilterSuggestion tight = suggested(0.001, {});
  EXPECT_FALSE(tight.met());
  for (const FilterCandidate& c : tight.candidates) EXPECT_GE(c.error(), tight.picked().error());
  // No time at all: the scan stays as it is.
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

}  // namespace
}  // namespace fettle::engine
