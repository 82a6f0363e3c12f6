#include "engine/suggest/filter_suggestion.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <new>
#include <numeric>

#include <fmt/format.h>

#include "engine/base/stopwatch.h"
#include "engine/filter/catalogue.h"
#include "engine/inspect/height_counts.h"
#include "engine/inspect/noise.h"
#include "engine/inspect/noise_model.h"
#include "engine/marks/edge_suggestion.h"
#include "engine/suggest/mosaic.h"
#include "engine/suggest/sample_errors.h"
#include "engine/suggest/synthetic_sample.h"

namespace fettle::engine {

namespace {

constexpr double kClearlyLess = 0.9;  // an error than another, as far as expectations are certain
constexpr double kEdgeCost = 280.0;   // of finding edges and marking them, as FilterTrial::cost

std::vector<FilterCandidate> candidatesFor(double sigma, int threads) {
  std::vector<FilterCandidate> all(1);
  all[0].spec.window = 1;
  for (const Filter& filter : filters())
    for (const FilterTrial& trial : filter.trials) {
      FilterCandidate c;
      c.spec.kind = filter.kind;
      c.spec.window = trial.window;
      c.spec.passes = trial.passes;
      c.spec.threads = threads;
      if (hasRange(filter.kind)) c.noises = trial.noises;
      // Three digits: the value may be typed.
      if (hasRange(filter.kind)) c.spec.range_sigma = std::stod(fmt::format("{:.3g}", trial.noises * sigma));
      c.around_edges = trial.around_edges;
      c.cost = trial.passes * trial.cost + (trial.around_edges ? kEdgeCost : 0.0);
      if (trial.around_edges) c.thickness = reachOf(c.spec) + 1.0;
      all.push_back(c);
    }
  return all;
}

// Indices, the cheapest first, of equal cost in their order.
std::vector<std::size_t> byCost(const std::vector<FilterCandidate>& candidates) {
  std::vector<std::size_t> order(candidates.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(order, {}, [&](std::size_t i) { return candidates[i].cost; });
  return order;
}

// Runs a candidate on the sample: its errors and its time.
Status tryOn(const SyntheticSample& sample, const SampleJudge& judge, FilterCandidate& candidate,
             const JobControl& job) {
  JobControl quiet = JobControl::partOf(job);
  const Stopwatch watch;
  Version start = sample.scan;
  if (candidate.around_edges) {
    const auto map = findEdges(start, EdgeMap::kUsualSigma, quiet);
    if (!map) return tl::unexpected(map.error());
    EdgeChoice choice;
    choice.thickness = candidate.thickness;
    auto marked = suggestMarks(start, *map, choice, quiet);
    if (!marked) return tl::unexpected(marked.error());
    start = std::move(marked->field);
  }
  if (candidate.spec.window > 1) {
    auto filtered = applyFilter(start, start, candidate.spec, quiet);
    if (!filtered) return tl::unexpected(filtered.error());
    start = std::move(filtered->field);
    candidate.seconds = watch.seconds();
  }
  const SampleErrors errors = judge.errorsOf(start, candidate.spec.kind == FilterKind::kGeneralisedVariation
                                                        ? SampleJudge::Rare::kLeftOut
                                                        : SampleJudge::Rare::kCount);
  candidate.error_flat = errors.flat;
  candidate.error_edge = errors.edge;
  return {};
}

Status checked(double value, const char* what, const char* where) {
  if (std::isfinite(value) && value > 0.0) return {};
  return inputError(fmt::format("a {} of {} cannot be used", what, value), where, "give more than 0");
}

}  // namespace

double FilterCandidate::error() const noexcept {
  return std::fmax(error_flat, error_edge);  // NaN is ignored if the other is a number
}

bool FilterCandidate::betterThan(const FilterCandidate& other) const noexcept {
  return cost != other.cost ? cost < other.cost : error() < kClearlyLess * other.error();
}

std::string methodOf(const FilterCandidate& candidate) {
  if (candidate.spec.window == 1) return "the unchanged scan";
  const Filter& filter = filterOf(candidate.spec.kind);
  std::string words(filter.word);
  if (filter.window.exists()) words += fmt::format(" {}", candidate.spec.window);
  if (candidate.spec.passes > 1) words += fmt::format(", {} passes", candidate.spec.passes);
  return words + detailsOf(candidate);
}

std::string detailsOf(const FilterCandidate& candidate) {
  const Filter& filter = filterOf(candidate.spec.kind);
  std::string words;
  if (candidate.noises != (hasRange(filter.kind) ? filter.noises : 0.0))
    words = fmt::format(", range {:g} noises", candidate.noises);
  return words + (candidate.around_edges ? " around suggested edges" : "");
}

Result<FilterSuggestion> suggestFilter(const Version& field, const SuggestionRequest& request,
                                       JobControl& job) try {
  if (auto ok = checked(request.tolerance, "tolerance", "tolerance"); !ok) return tl::unexpected(ok.error());
  if (request.budget_s)
    if (auto ok = checked(*request.budget_s, "budget", "budget"); !ok) return tl::unexpected(ok.error());
  const auto finest = estimateNoise(field, job);
  if (!finest) return tl::unexpected(finest.error());
  const auto noise = measureNoise(field, job);
  if (!noise) return tl::unexpected(noise.error());
  if (!(finest->sigma > 0.0 && noise->sigma > 0.0))
    return inputError("no noise that a filter could remove was found in the scan", "suggestion",
                      "choose a filter yourself");
  FilterSuggestion found;
  found.sigma = noise->sigma;
  found.rows = std::sqrt(std::max(noise->whole_rows, 0.0));
  found.columns = std::sqrt(std::max(noise->whole_columns, 0.0));
  found.candidates = candidatesFor(finest->sigma, request.threads);
  job.begin("trying filters", found.candidates.size() + 2);
  JobControl quiet = JobControl::partOf(job);
  const Mosaic pieces = makeMosaic(field, noise->sigma);
  const auto sample = makeSyntheticSample(pieces, field.grid(), *noise, findHeightCounts(field), 1, quiet);
  if (!sample) return tl::unexpected(sample.error());
  const SampleJudge judge(field, pieces, *sample, noise->sigma);
  job.advance(2);
  const double scale =
      static_cast<double>(field.grid().samples()) / static_cast<double>(pieces.field.grid().samples());
  const FilterCandidate* best = nullptr;
  for (const std::size_t i : byCost(found.candidates)) {
    if (job.cancelled()) return cancelled();
    FilterCandidate& c = found.candidates[i];
    if (request.only_named && best != nullptr && best->within && c.cost > best->cost) {
      c.error_flat = c.error_edge = std::numeric_limits<double>::quiet_NaN();
      job.advance();
      continue;
    }
    if (auto ok = tryOn(*sample, judge, c, job); !ok) return tl::unexpected(ok.error());
    job.advance();
    c.seconds *= scale;
    const bool affordable = !request.budget_s || c.seconds <= *request.budget_s;
    c.within = affordable && c.error() <= request.tolerance;
    if (!affordable || std::isnan(c.error())) continue;
    if (best == nullptr || (c.within && !best->within) ||
        (c.within == best->within && (c.within ? c.betterThan(*best) : c.error() < best->error()))) {
      best = &c;
      found.pick = i;
    }
  }
  if (std::ranges::all_of(found.candidates, [](const FilterCandidate& c) { return std::isnan(c.error()); }))
    return inputError("no error of any filter could be expected for this scan", "suggestion",
                      "choose a filter yourself");
  found.samples = pieces.field.grid().samples() - summarize(pieces.field).no_data;
  found.outlier_share =
      static_cast<double>(sample->outliers) / static_cast<double>(std::max<std::int64_t>(found.samples, 1));
  found.edge_share = judge.edgeShare();
  return found;
} catch (const std::bad_alloc&) {
  return failure("memory for trying filters could not be allocated", "suggestion", "close other programs");
}

}  // namespace fettle::engine
