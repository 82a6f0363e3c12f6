#include "engine/suggest/filter_suggestion.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <new>

#include <fmt/format.h>

#include "engine/base/stopwatch.h"
#include "engine/compare/compare.h"
#include "engine/field/piece.h"
#include "engine/filter/catalogue.h"
#include "engine/inspect/noise.h"
#include "engine/marks/edge_suggestion.h"
#include "engine/suggest/synthetic_sample.h"

namespace fettle::engine {

namespace {

constexpr int kPiecesASide = 4;
constexpr std::int32_t kPieceSide = 256;

struct Spot {
  std::int32_t column, row, columns, rows;
};

// The piece around the tile with the largest range of heights in [from, to) of tiles.
Spot steepestSpot(const FieldReader& field, std::int32_t tc0, std::int32_t tc1, std::int32_t tr0,
                  std::int32_t tr1) {
  std::int32_t column = tc0, row = tr0;
  double most = -1.0;
  for (std::int32_t tr = tr0; tr < tr1; ++tr)
    for (std::int32_t tc = tc0; tc < tc1; ++tc) {
      const HeightBounds& b = field.tile(tc, tr).bounds;
      if (b.empty()) continue;
      const double range = static_cast<double>(b.max) - static_cast<double>(b.min);
      if (range > most) most = range, column = tc, row = tr;
    }
  Spot spot;
  spot.columns = std::min(kPieceSide, field.width());
  spot.rows = std::min(kPieceSide, field.height());
  const auto about = [](std::int32_t tile, std::int32_t side, std::int32_t all) {
    return std::clamp(tile * kTileSide + (kTileSide - side) / 2, 0, all - side);
  };
  spot.column = about(column, spot.columns, field.width());
  spot.row = about(row, spot.rows, field.height());
  return spot;
}

std::vector<Spot> spotsOf(const FieldReader& field) {
  const auto pieces = [](std::int32_t side) {
    return std::clamp((side + kPieceSide - 1) / kPieceSide, 1, kPiecesASide);
  };
  const int across = pieces(field.width()), up = pieces(field.height());
  std::vector<Spot> spots;
  for (int y = 0; y < up; ++y)
    for (int x = 0; x < across; ++x)
      spots.push_back(steepestSpot(field, field.tileColumns() * x / across,
                                   std::max(field.tileColumns() * (x + 1) / across, 1),
                                   field.tileRows() * y / up, std::max(field.tileRows() * (y + 1) / up, 1)));
  return spots;
}

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
      // Three digits: the value may be typed.
      if (hasRange(filter.kind)) c.spec.range_sigma = std::stod(fmt::format("{:.3g}", trial.noises * sigma));
      c.around_edges = trial.around_edges;
      if (trial.around_edges) c.thickness = reachOf(c.spec) + 1.0;
      all.push_back(c);
    }
  return all;
}

// Squares of errors over all pieces.
struct Sums {
  double flat = 0.0, edge = 0.0, seconds = 0.0;
  std::int64_t flats = 0, edges = 0;

  void take(const TruthFigures& f) {
    if (f.flat_samples > 0) flat += f.rmse_flat * f.rmse_flat * static_cast<double>(f.flat_samples);
    if (f.edge_samples > 0) edge += f.rmse_edge * f.rmse_edge * static_cast<double>(f.edge_samples);
    flats += f.flat_samples;
    edges += f.edge_samples;
  }
};

double rootMean(double squares, std::int64_t count) {
  return count > 0 ? std::sqrt(squares / static_cast<double>(count))
                   : std::numeric_limits<double>::quiet_NaN();
}

Status tryOn(const SyntheticSample& piece, const FilterCandidate& candidate, Sums& sums) {
  JobControl quiet;
  const Stopwatch watch;
  Version start = piece.scan;
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
    sums.seconds += watch.seconds();
  }
  const auto figures = compareToTruth(start, piece.surface, piece.edges, quiet);
  if (!figures) return tl::unexpected(figures.error());
  sums.take(*figures);
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

Result<FilterSuggestion> suggestFilter(const Version& field, const SuggestionRequest& request,
                                       JobControl& job) try {
  if (auto ok = checked(request.tolerance, "tolerance", "tolerance"); !ok) return tl::unexpected(ok.error());
  if (request.budget_s)
    if (auto ok = checked(*request.budget_s, "budget", "budget"); !ok) return tl::unexpected(ok.error());
  const auto noise = estimateNoise(field, job);
  if (!noise) return tl::unexpected(noise.error());
  if (!(noise->sigma > 0.0))
    return inputError("no noise that a filter could remove was found in the scan", "suggestion",
                      "choose a filter yourself");
  FilterSuggestion found;
  found.sigma = noise->sigma;
  found.candidates = candidatesFor(found.sigma, request.threads);
  const std::vector<Spot> spots = spotsOf(field.reader());
  job.begin("trying filters", spots.size() * found.candidates.size());
  std::vector<Sums> sums(found.candidates.size());
  std::int64_t outliers = 0;
  std::int64_t covered = 0;
  for (std::size_t p = 0; p < spots.size(); ++p) {
    JobControl quiet;
    const Spot& spot = spots[p];
    const Version piece = pieceOf(field, spot.column, spot.row, spot.columns, spot.rows);
    covered += piece.grid().samples();
    const auto sample = makeSyntheticSample(piece, found.sigma, p, quiet);
    if (!sample) return tl::unexpected(sample.error());
    outliers += sample->outliers;
    found.samples += piece.grid().samples() - summarize(piece).no_data;
    for (std::size_t i = 0; i < found.candidates.size(); ++i) {
      if (job.cancelled()) return cancelled();
      if (auto ok = tryOn(*sample, found.candidates[i], sums[i]); !ok) return tl::unexpected(ok.error());
      job.advance();
    }
  }
  const double scale = static_cast<double>(field.grid().samples()) / static_cast<double>(covered);
  const double none = std::numeric_limits<double>::infinity();
  double best_time = none, best_error = none;
  bool met = false;
  for (std::size_t i = 0; i < found.candidates.size(); ++i) {
    FilterCandidate& c = found.candidates[i];
    c.error_flat = rootMean(sums[i].flat, sums[i].flats);
    c.error_edge = rootMean(sums[i].edge, sums[i].edges);
    c.seconds = sums[i].seconds * scale;
    const bool affordable = !request.budget_s || c.seconds <= *request.budget_s;
    c.within = affordable && c.error() <= request.tolerance;
    if (c.within ? !met || c.seconds < best_time : !met && affordable && c.error() < best_error) {
      met = c.within;
      best_time = c.seconds;
      best_error = c.error();
      found.pick = i;
    }
  }
  const auto samples = static_cast<double>(std::max<std::int64_t>(found.samples, 1));
  found.outlier_share = static_cast<double>(outliers) / samples;
  found.edge_share = static_cast<double>(sums[0].edges) / samples;
  return found;
} catch (const std::bad_alloc&) {
  return failure("memory for trying filters could not be allocated", "suggestion", "close other programs");
}

}  // namespace fettle::engine
