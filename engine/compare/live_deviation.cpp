#include "engine/compare/live_deviation.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <new>

#include <tbb/parallel_for.h>

#include "engine/compare/tile_sums.h"
#include "engine/field/difference.h"

namespace fettle::engine {

namespace {

tl::unexpected<Error> noMemory() {
  return failure("memory is exhausted", "comparing", "close other programs");
}

// Extent of the tile within the field.
struct Extent {
  int columns, rows;
};
Extent extentOf(const FieldReader& field, std::int32_t tc, std::int32_t tr) noexcept {
  return {std::min(kTileSide, field.width() - tc * kTileSide),
          std::min(kTileSide, field.height() - tr * kTileSide)};
}

// Sums over a whole field, and the plane that fits its residuals best.
struct Fit {
  double n = 0.0, residual = 0.0, square = 0.0, absolute = 0.0;
  double level = 0.0, by_column = 0.0, by_row = 0.0;  // about the centre of the grid
  double explained = 0.0;                             // part of the squares that the plane explains

  void solve(double c, double r, double cc, double cr, double rr, double ec, double er) noexcept {
    if (n == 0.0) return;
    const double mc = c / n, mr = r / n, me = residual / n;
    const double scc = cc - c * mc, scr = cr - c * mr, srr = rr - r * mr;
    const double sce = ec - residual * mc, sre = er - residual * mr;
    const double determinant = scc * srr - scr * scr;
    // Samples on one line do not determine the tilt across it: level across it, as Plane::fit.
    if (determinant > 1e-12 * scc * srr) {
      by_column = (srr * sce - scr * sre) / determinant;
      by_row = (scc * sre - scr * sce) / determinant;
    } else if (scc + srr > 0.0) {
      by_column = sce / (scc + srr);
      by_row = sre / (scc + srr);
    }
    level = me - by_column * mc - by_row * mr;
    explained = std::max(0.0, n * me * me + by_column * sce + by_row * sre);
  }
};

template <class Sums>
Fit fitOf(const std::vector<Sums>& sums) {
  Fit fit;
  double c = 0.0, r = 0.0, cc = 0.0, cr = 0.0, rr = 0.0, ec = 0.0, er = 0.0;
  for (const Sums& s : sums) {
    fit.n += s.n, fit.residual += s.residual, fit.square += s.square, fit.absolute += s.absolute;
    c += s.c, r += s.r, cc += s.cc, cr += s.cr, rr += s.rr, ec += s.column, er += s.row;
  }
  fit.solve(c, r, cc, cr, rr, ec, er);
  return fit;
}

// A power of two that no change exceeds.
double reachOf(double most) noexcept {
  if (!(most > 0.0)) return 0.0;
  int exponent = 0;
  const double mantissa = std::frexp(most, &exponent);  // most = mantissa 2^exponent, mantissa in [0.5, 1)
  return std::ldexp(1.0, mantissa < 1.0 ? exponent : exponent + 1);
}

}  // namespace

std::size_t LiveDeviation::index(std::int32_t tc, std::int32_t tr) const noexcept {
  return static_cast<std::size_t>(tr) * static_cast<std::size_t>(original_.reader().tileColumns()) +
         static_cast<std::size_t>(tc);
}

void LiveDeviation::measure(const FieldReader& now, std::int32_t tc, std::int32_t tr, TileSums& sums) const {
  sums = {};
  const Tile& tile = now.tile(tc, tr);
  const Tile& before = original_.reader().tile(tc, tr);
  const Extent extent = extentOf(now, tc, tr);
  for (int r = 0; r < extent.rows; ++r) {
    const double y = tr * kTileSide + r - centre_row_;
    double n = 0.0, x_sum = 0.0, xx = 0.0, e_sum = 0.0, ex = 0.0;
    for (int c = 0; c < extent.columns; ++c) {
      const auto i = static_cast<std::size_t>(r * kTileSide + c);
      const double z = static_cast<double>(tile.samples[i]), old = static_cast<double>(before.samples[i]);
      const double x = tc * kTileSide + c - centre_column_;
      if (!std::isnan(z)) {
        const double e = z - level_ - slope_column_ * x - slope_row_ * y;
        n += 1.0, x_sum += x, xx += x * x, e_sum += e, ex += e * x;
        sums.square += e * e;
        sums.absolute += std::abs(e);
      }
      const double d = z - old;
      if (std::isnan(d)) continue;
      ++sums.both;
      sums.same += d == 0.0;
      sums.change_square += d * d;
      sums.change_max = std::max(sums.change_max, std::abs(d));
    }
    sums.n += n, sums.c += x_sum, sums.r += n * y;
    sums.cc += xx, sums.cr += x_sum * y, sums.rr += n * y * y;
    sums.residual += e_sum, sums.column += ex, sums.row += e_sum * y;
  }
}

void LiveDeviation::count(const FieldReader& now, std::int32_t tc, std::int32_t tr, double reach,
                          TileCounts& counts) const {
  counts.fill(0);
  const Tile& tile = now.tile(tc, tr);
  const Tile& before = original_.reader().tile(tc, tr);
  if (&tile == &before || reach == 0.0) return;
  const double scale = 0.5 * ChangeHistogram::kClasses / reach;  // a power of two: exact
  for (int i = 0; i < kTileSamples; ++i) {
    const auto k = static_cast<std::size_t>(i);
    const double d = static_cast<double>(tile.samples[k]) - static_cast<double>(before.samples[k]);
    if (std::isnan(d) || d == 0.0) continue;
    const auto kind = static_cast<int>(std::floor(d * scale)) + ChangeHistogram::kClasses / 2;
    ++counts[static_cast<std::size_t>(std::clamp(kind, 0, ChangeHistogram::kClasses - 1))];
  }
}

Result<LiveDeviation> LiveDeviation::create(const Version& original, JobControl& job) try {
  LiveDeviation live;
  live.original_ = live.last_ = original;
  const FieldReader reader = original.reader();
  const Grid& grid = original.grid();
  live.centre_column_ = 0.5 * (grid.width - 1);
  live.centre_row_ = 0.5 * (grid.height - 1);
  const HeightBounds bounds = reader.bounds();
  if (!bounds.empty())
    live.level_ = static_cast<double>(reader.sign()) * 0.5 *
                  (static_cast<double>(bounds.min) + static_cast<double>(bounds.max));
  job.begin("comparing", 2 * tileCount(reader));
  // Once to find the plane, once about it, so that no precision is lost to the mean height.
  for (int pass = 0; pass < 2; ++pass) {
    live.sums_ = forEachTile<TileSums>(reader, job, [&](const SampleRect& rect, TileSums& sums) {
      live.measure(reader, rect.column / kTileSide, rect.row / kTileSide, sums);
    });
    if (job.cancelled()) return cancelled();
    const Fit fit = fitOf(live.sums_);
    if (pass == 0) {
      live.level_ += fit.level;
      live.slope_column_ += fit.by_column;
      live.slope_row_ += fit.by_row;
    } else if (fit.n > 0.0) {
      live.sq_original_ = std::sqrt(std::max(0.0, fit.square - fit.explained) / fit.n);
      live.sa_original_ = fit.absolute / fit.n;
    }
  }
  live.counts_.resize(live.sums_.size());
  return live;
} catch (const std::bad_alloc&) {
  return noMemory();
}

Result<LiveFigures> LiveDeviation::update(const Version& now, JobControl& job) try {
  assert(now.memory() == original_.memory());
  const FieldReader reader = now.reader();
  const std::vector<TileChange> changes = changedTiles(last_, now);
  job.begin("comparing", changes.size());
  std::vector<TileSums> fresh(changes.size());
  tbb::parallel_for(std::size_t{0}, changes.size(), [&](std::size_t i) {
    if (job.cancelled()) return;
    measure(reader, changes[i].tile_column, changes[i].tile_row, fresh[i]);
    job.advance();
  });
  if (job.cancelled()) return cancelled();
  for (std::size_t i = 0; i < changes.size(); ++i)
    sums_[index(changes[i].tile_column, changes[i].tile_row)] = fresh[i];
  double most = 0.0;
  for (const TileSums& s : sums_) most = std::max(most, s.change_max);
  if (const double reach = reachOf(most); reach != reach_) {
    reach_ = reach;
    const std::int64_t across = reader.tileColumns();
    tbb::parallel_for(std::int64_t{0}, static_cast<std::int64_t>(counts_.size()), [&](std::int64_t i) {
      count(reader, static_cast<std::int32_t>(i % across), static_cast<std::int32_t>(i / across), reach_,
            counts_[static_cast<std::size_t>(i)]);
    });
  } else {
    tbb::parallel_for(std::size_t{0}, changes.size(), [&](std::size_t i) {
      count(reader, changes[i].tile_column, changes[i].tile_row, reach_,
            counts_[index(changes[i].tile_column, changes[i].tile_row)]);
    });
  }
  last_ = now;
  LiveFigures figures;
  fold(figures);
  return figures;
} catch (const std::bad_alloc&) {
  return noMemory();
}

void LiveDeviation::fold(LiveFigures& figures) const {
  const Fit fit = fitOf(sums_);
  double square = 0.0;
  std::int64_t same = 0;
  for (const TileSums& s : sums_) {
    figures.samples += s.both;
    same += s.same;
    square += s.change_square;
    figures.max_abs = std::max(figures.max_abs, s.change_max);
  }
  if (figures.samples > 0) figures.rms = std::sqrt(square / static_cast<double>(figures.samples));
  figures.sq_original = sq_original_;
  figures.sa_original = sa_original_;
  if (fit.n > 0.0) {
    figures.sq = std::sqrt(std::max(0.0, fit.square - fit.explained) / fit.n);
    figures.sa = fit.absolute / fit.n;
    // The mean of |x| is at most the root of the mean of its squares.
    figures.sa_plane_shift = std::sqrt(fit.explained / fit.n);
  }
  figures.histogram.reach = reach_;
  figures.histogram.unchanged = same;
  for (const TileCounts& counts : counts_)
    for (std::size_t i = 0; i < counts.size(); ++i) figures.histogram.counts[i] += counts[i];
}

}  // namespace fettle::engine
