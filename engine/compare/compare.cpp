#include "engine/compare/compare.h"

#include <algorithm>
#include <cmath>
#include <new>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "engine/compare/tile_select.h"
#include "engine/compare/tile_sums.h"
#include "engine/field/builder.h"

namespace fettle::engine {

namespace {

// First moments of the samples (column, row, height) of a field.
struct PlaneMeans {
  std::int64_t samples = 0;
  std::int64_t columns = 0;  // sum of columns; below 2^63 for any field
  std::int64_t rows = 0;
  CompensatedSum height;

  void add(std::int32_t column, std::int32_t row, double z) noexcept {
    ++samples;
    columns += column;
    rows += row;
    height.add(z);
  }
  void add(const PlaneMeans& other) noexcept {
    samples += other.samples;
    columns += other.columns;
    rows += other.rows;
    height.add(other.height);
  }
};

// Where the centre of a field's samples lies.
struct Centre {
  double column = 0.0;
  double row = 0.0;
  double height = 0.0;

  static Centre of(const PlaneMeans& means) noexcept {
    const auto n = static_cast<double>(means.samples);
    return {static_cast<double>(means.columns) / n, static_cast<double>(means.rows) / n,
            means.height.value() / n};
  }
};

// Second moments about the centre.
struct PlaneMoments {
  CompensatedSum cc, cr, rr, cz, rz;

  void add(double c, double r, double z) noexcept {
    cc.add(c * c);
    cr.add(c * r);
    rr.add(r * r);
    cz.add(c * z);
    rz.add(r * z);
  }
  void add(const PlaneMoments& other) noexcept {
    cc.add(other.cc);
    cr.add(other.cr);
    rr.add(other.rr);
    cz.add(other.cz);
    rz.add(other.rz);
  }
};

// The least-squares plane through a field's samples: height + by_column * (c - column) + by_row * (r - row).
// The spacing cancels in the fit, so it is done in samples.
struct Plane {
  Centre centre;
  double by_column = 0.0;
  double by_row = 0.0;

  /// Samples on one line do not determine the tilt across it: then the plane is level across it.
  static Plane fit(const Centre& centre, const PlaneMoments& m) noexcept {
    Plane plane{centre, 0.0, 0.0};
    const double cc = m.cc.value();
    const double cr = m.cr.value();
    const double rr = m.rr.value();
    const double determinant = cc * rr - cr * cr;
    if (determinant > 1e-12 * cc * rr) {
      plane.by_column = (rr * m.cz.value() - cr * m.rz.value()) / determinant;
      plane.by_row = (cc * m.rz.value() - cr * m.cz.value()) / determinant;
    } else if (cc + rr > 0.0) {
      plane.by_column = m.cz.value() / (cc + rr);
      plane.by_row = m.rz.value() / (cc + rr);
    }
    return plane;
  }

  double residual(double column, double row, double z) const noexcept {
    return (z - centre.height) - by_column * (column - centre.column) - by_row * (row - centre.row);
  }
};

// Two fields sample by sample, the second in the height unit of the first.
struct Pair {
  FieldReader a;
  FieldReader b;
  double b_in_a = 1.0;

  // Calls f(column, row, height of a, height of b); NaN for a hole.
  void forEach(const SampleRect& rect, auto&& f) const {
    float za[kTileSamples];
    float zb[kTileSamples];
    a.readHeights(rect.column, rect.row, rect.columns, rect.rows, za, kTileSide);
    b.readHeights(rect.column, rect.row, rect.columns, rect.rows, zb, kTileSide);
    for (int r = 0; r < rect.rows; ++r)
      for (int c = 0; c < rect.columns; ++c) {
        const int i = r * kTileSide + c;
        f(rect.column + c, rect.row + r, static_cast<double>(za[i]), static_cast<double>(zb[i]) * b_in_a);
      }
  }
};

struct First {
  std::int64_t samples = 0;
  std::int64_t only_a = 0;
  std::int64_t only_b = 0;
  double max_abs = 0.0;
  CompensatedSum difference;
  CompensatedSum square;
  PlaneMeans a;
  PlaneMeans b;
};

First firstPass(const Pair& pair, JobControl& job) {
  const std::vector<First> parts = forEachTile<First>(pair.a, job, [&](const SampleRect& rect, First& part) {
    pair.forEach(rect, [&](std::int32_t c, std::int32_t r, double za, double zb) {
      const bool in_a = !std::isnan(za);
      const bool in_b = !std::isnan(zb);
      if (in_a) part.a.add(c, r, za);
      if (in_b) part.b.add(c, r, zb);
      if (in_a != in_b) ++(in_a ? part.only_a : part.only_b);
      if (!in_a || !in_b) return;
      const double d = zb - za;
      ++part.samples;
      part.max_abs = std::max(part.max_abs, std::abs(d));
      part.difference.add(d);
      part.square.add(d * d);
    });
  });
  First all;
  for (const First& part : parts) {
    all.samples += part.samples;
    all.only_a += part.only_a;
    all.only_b += part.only_b;
    all.max_abs = std::max(all.max_abs, part.max_abs);
    all.difference.add(part.difference);
    all.square.add(part.square);
    all.a.add(part.a);
    all.b.add(part.b);
  }
  return all;
}

struct Second {
  PlaneMoments a;
  PlaneMoments b;
};

Second secondPass(const Pair& pair, const Centre& a, const Centre& b, JobControl& job) {
  const std::vector<Second> parts =
      forEachTile<Second>(pair.a, job, [&](const SampleRect& rect, Second& part) {
        pair.forEach(rect, [&](std::int32_t c, std::int32_t r, double za, double zb) {
          if (!std::isnan(za)) part.a.add(c - a.column, r - a.row, za - a.height);
          if (!std::isnan(zb)) part.b.add(c - b.column, r - b.row, zb - b.height);
        });
      });
  Second all;
  for (const Second& part : parts) {
    all.a.add(part.a);
    all.b.add(part.b);
  }
  return all;
}

struct Roughness {
  CompensatedSum square;
  CompensatedSum absolute;

  void add(double residual) noexcept {
    square.add(residual * residual);
    absolute.add(std::abs(residual));
  }
};

struct Third {
  Roughness a;
  Roughness b;
};

Third thirdPass(const Pair& pair, const Plane& a, const Plane& b, JobControl& job) {
  const std::vector<Third> parts = forEachTile<Third>(pair.a, job, [&](const SampleRect& rect, Third& part) {
    pair.forEach(rect, [&](std::int32_t c, std::int32_t r, double za, double zb) {
      if (!std::isnan(za)) part.a.add(a.residual(c, r, za));
      if (!std::isnan(zb)) part.b.add(b.residual(c, r, zb));
    });
  });
  Third all;
  for (const Third& part : parts) {
    all.a.square.add(part.a.square);
    all.a.absolute.add(part.a.absolute);
    all.b.square.add(part.b.square);
    all.b.absolute.add(part.b.absolute);
  }
  return all;
}

double ratio(double sum, std::int64_t samples) noexcept {
  return samples > 0 ? sum / static_cast<double>(samples) : kNoFigure;
}

}  // namespace

Result<Deviation> compareFields(const Version& a, const Version& b, JobControl& job) try {
  const Grid& ga = a.grid();
  const Grid& gb = b.grid();
  if (ga.width != gb.width || ga.height != gb.height)
    return inputError(fmt::format("a field of {} x {} samples cannot be compared with one of {} x {}",
                                  ga.width, ga.height, gb.width, gb.height),
                      {}, "give two fields of one size");
  const Pair pair{a.reader(), b.reader(), gb.height_unit.mm / ga.height_unit.mm};
  job.begin("comparing", (3 + kSelectPasses) * tileCount(pair.a));

  const First first = firstPass(pair, job);
  if (job.cancelled()) return cancelled();
  const Centre centre_a = Centre::of(first.a);
  const Centre centre_b = Centre::of(first.b);
  const Second second = secondPass(pair, centre_a, centre_b, job);
  if (job.cancelled()) return cancelled();
  const Third third = thirdPass(pair, Plane::fit(centre_a, second.a), Plane::fit(centre_b, second.b), job);
  if (job.cancelled()) return cancelled();

  Deviation result;
  result.samples = first.samples;
  result.only_a = first.only_a;
  result.only_b = first.only_b;
  result.mean = ratio(first.difference.value(), first.samples);
  result.rms = std::sqrt(ratio(first.square.value(), first.samples));
  result.max_abs = first.samples > 0 ? first.max_abs : kNoFigure;
  result.sq_a = std::sqrt(ratio(third.a.square.value(), first.a.samples));
  result.sa_a = ratio(third.a.absolute.value(), first.a.samples);
  result.sq_b = std::sqrt(ratio(third.b.square.value(), first.b.samples));
  result.sa_b = ratio(third.b.absolute.value(), first.b.samples);
  result.p99 = kNoFigure;
  if (first.samples > 0) {
    // Nearest rank ceil(0.99 n), in integers: 0.99 is not representable as a double.
    result.p99 = selectFromTiles(
                     pair.a, job, [](std::int64_t n) { return (99 * n + 99) / 100 - 1; },
                     [&](const SampleRect& rect, auto&& take) {
                       pair.forEach(rect, [&](std::int32_t, std::int32_t, double za, double zb) {
                         take(std::abs(zb - za));
                       });
                     })
                     .value;
    if (job.cancelled()) return cancelled();
  }
  return result;
} catch (const std::bad_alloc&) {
  return failure("memory is exhausted", "comparing", "compare smaller fields");
}

Result<Version> deviationField(const Version& a, const Version& b, JobControl& job) {
  Grid grid = a.grid();
  if (grid.width != b.grid().width || grid.height != b.grid().height)
    return inputError(fmt::format("a field of {} x {} samples cannot be compared with one of {} x {}",
                                  grid.width, grid.height, b.grid().width, b.grid().height),
                      {}, "give two fields of one size");
  const double b_in_a = b.grid().height_unit.mm / grid.height_unit.mm;
  grid.height_per_count = 0.0;
  Result<FieldBuilder> builder = FieldBuilder::create(std::move(grid), "the deviation");
  if (!builder) return tl::unexpected(builder.error());
  const FieldReader from = a.reader();
  const FieldReader to = b.reader();
  const auto tiles = static_cast<std::int64_t>(tileCount(from));
  job.begin("taking the difference", static_cast<std::uint64_t>(tiles));
  tbb::parallel_for(std::int64_t{0}, tiles, [&](std::int64_t i) {
    if (job.cancelled()) return;
    const SampleRect rect = tileRect(from, i);
    float za[kTileSamples];
    float zb[kTileSamples];
    from.readHeights(rect.column, rect.row, rect.columns, rect.rows, za, kTileSide);
    to.readHeights(rect.column, rect.row, rect.columns, rect.rows, zb, kTileSide);
    for (int r = 0; r < rect.rows; ++r)
      for (int k = r * kTileSide; k < r * kTileSide + rect.columns; ++k)
        za[k] = static_cast<float>(zb[k] * b_in_a - double{za[k]});
    builder->writeHeights(rect.column, rect.row, rect.columns, rect.rows, za, kTileSide);
    job.advance();
  });
  if (job.cancelled()) return cancelled();
  return std::move(*builder).build();
}

}  // namespace fettle::engine
