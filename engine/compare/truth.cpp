#include <algorithm>
#include <cmath>
#include <limits>
#include <new>
#include <vector>

#include <fmt/format.h>

#include "engine/compare/compare.h"
#include "engine/compare/edge_width.h"
#include "engine/compare/mark_distance.h"
#include "engine/compare/tile_sums.h"

namespace fettle::engine {

namespace {

struct Errors {
  std::int64_t samples = 0;
  double max_abs = 0.0;
  CompensatedSum square;

  void add(double e) noexcept {
    ++samples;
    max_abs = std::max(max_abs, std::abs(e));
    square.add(e * e);
  }
  void add(const Errors& other) noexcept {
    samples += other.samples;
    max_abs = std::max(max_abs, other.max_abs);
    square.add(other.square);
  }
  [[nodiscard]] double rms() const noexcept {
    return samples > 0 ? std::sqrt(square.value() / static_cast<double>(samples)) : kNoFigure;
  }
};

struct TruthTile {
  std::int64_t lost = 0;
  Errors all;
  Errors flat;
  Errors near;
  std::vector<EdgeWidth> widths;
};

// Mean of the two middle ones for an even count; NaN without values.
double median(std::vector<double> values) {
  if (values.empty()) return kNoFigure;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  if (values.size() % 2 != 0) return *middle;
  return 0.5 * (*middle + *std::max_element(values.begin(), middle));
}

Status check(const Version& field, const Version& truth, const Version& edges, const TruthOptions& o) {
  for (const Version* other : {&field, &edges})
    if (other->grid().width != truth.grid().width || other->grid().height != truth.grid().height)
      return inputError(
          fmt::format("a truth of {} x {} samples cannot be compared with {} of {} x {}", truth.grid().width,
                      truth.grid().height, other == &field ? "a field" : "edges", other->grid().width,
                      other->grid().height),
          {}, "give field, truth and edges of one size");
  if (!(o.near_edge >= 0.0 && o.near_edge <= o.flat && o.flat <= 64.0))
    return inputError(fmt::format("\"near\" within {} and \"flat\" beyond {} samples cannot be distinguished",
                                  o.near_edge, o.flat),
                      {}, "give 0 <= near <= flat <= 64");
  if (o.profile_reach < 4 || o.profile_reach > 64 || o.profile_half_length < 2 || o.profile_half_length > 64)
    return inputError("a profile across an edge cannot be that long or wide", {},
                      "reach 4 to 64, half length 2 to 64 samples");
  return {};
}

TruthFigures measure(const Version& field, const Version& truth, const Version& edges, JobControl& job,
                     const TruthOptions& options) {
  const FieldReader f = field.reader();
  const FieldReader t = truth.reader();
  const FieldReader e = edges.reader();
  const double field_in_truth = field.grid().height_unit.mm / truth.grid().height_unit.mm;
  const int reach = static_cast<int>(std::floor(options.flat));
  const std::vector<TruthTile> tiles =
      forEachTile<TruthTile>(t, job, [&](const SampleRect& rect, TruthTile& part) {
        MarkDistance distance(reach);
        const std::vector<int>& squared = distance.measure(e, rect);
        float zf[kTileSamples];
        float zt[kTileSamples];
        f.readHeights(rect.column, rect.row, rect.columns, rect.rows, zf, kTileSide);
        t.readHeights(rect.column, rect.row, rect.columns, rect.rows, zt, kTileSide);
        for (int r = 0; r < rect.rows; ++r)
          for (int c = 0; c < rect.columns; ++c) {
            const int i = r * kTileSide + c;
            if (std::isnan(zt[i])) continue;
            if (std::isnan(zf[i])) {
              ++part.lost;
              continue;
            }
            const double error = static_cast<double>(zf[i]) * field_in_truth - static_cast<double>(zt[i]);
            const double d2 = squared[static_cast<std::size_t>(i)];
            part.all.add(error);
            if (d2 <= options.near_edge * options.near_edge) part.near.add(error);
            if (d2 > options.flat * options.flat) part.flat.add(error);
          }
        part.widths = edgeWidths(f, field_in_truth, t, e, options, rect);
      });
  TruthFigures figures;
  Errors all;
  Errors flat;
  Errors near;
  std::vector<double> of_field;
  std::vector<double> of_truth;
  for (const TruthTile& tile : tiles) {
    figures.lost += tile.lost;
    all.add(tile.all);
    flat.add(tile.flat);
    near.add(tile.near);
    for (const EdgeWidth& width : tile.widths) {
      if (std::isnan(width.field)) {
        ++figures.unresolved_profiles;
        continue;
      }
      of_field.push_back(width.field);
      of_truth.push_back(width.truth);
    }
  }
  figures.samples = all.samples;
  figures.flat_samples = flat.samples;
  figures.edge_samples = near.samples;
  figures.rmse = all.rms();
  figures.rmse_flat = flat.rms();
  figures.rmse_edge = near.rms();
  figures.max_abs_edge = near.samples > 0 ? near.max_abs : kNoFigure;
  figures.edge_profiles = static_cast<std::int64_t>(of_field.size());
  figures.edge_width = median(of_field);
  figures.edge_width_truth = median(of_truth);
  return figures;
}

}  // namespace

Result<TruthFigures> compareToTruth(const Version& field, const Version& truth, const Version& edges,
                                    JobControl& job, const TruthOptions& options) {
  if (const Status status = check(field, truth, edges, options); !status)
    return tl::unexpected(status.error());
  job.begin("comparing with the truth", tileCount(truth.reader()));
  try {
    const TruthFigures figures = measure(field, truth, edges, job, options);
    if (job.cancelled()) return cancelled();
    return figures;
  } catch (const std::bad_alloc&) {
    return failure("memory is exhausted", "comparing with the truth", "compare smaller fields");
  }
}

}  // namespace fettle::engine
