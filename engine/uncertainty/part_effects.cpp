#include "engine/uncertainty/part_effects.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <new>
#include <random>
#include <utility>

#include "engine/field/builder.h"
#include "engine/field/piece.h"
#include "engine/measure/form.h"
#include "engine/uncertainty/areal_figures.h"
#include "engine/uncertainty/direction_noise.h"
#include "engine/uncertainty/extreme_trials.h"

namespace fettle::engine {

namespace {

constexpr double kNoEffect = std::numeric_limits<double>::quiet_NaN();
constexpr std::int64_t kFewestSamples = 1000;  // a part of fewer says nothing

// Samples of a square, and how many squares there are, along x or along y.
struct SquareSides {
  std::int32_t columns, rows;
  int across, up;
};
SquareSides sidesOf(const Grid& grid, const PartOptions& options) {
  const std::int64_t area = std::int64_t{options.side} * options.side;
  SquareSides sides{};
  sides.rows = std::min(options.side, grid.height);
  sides.columns = static_cast<std::int32_t>(std::min<std::int64_t>(grid.width, area / sides.rows));
  sides.rows = static_cast<std::int32_t>(std::min<std::int64_t>(grid.height, area / sides.columns));
  const int all = options.squares * options.squares;
  sides.across = std::clamp(grid.width / sides.columns, 1, options.squares);
  sides.up = std::clamp(grid.height / sides.rows, 1, all / sides.across);
  sides.across = std::clamp(grid.width / sides.columns, 1, all / sides.up);
  return sides;
}

// How large the noise is in the middle of a square, by its map.
double shareIn(const NoiseModel& noise, const Grid& grid, const SampleRect& square) {
  if (noise.map.empty() || !(noise.sigma > 0.0)) return 1.0;
  return noise.sigmaAt(grid, square.column + square.columns / 2, square.row + square.rows / 2) / noise.sigma;
}

// `surface` with what noise changes of `before` to `after`.
Result<Version> changedBy(const Version& surface, const Version& before, const Version& after) {
  const Grid& grid = surface.grid();
  const auto columns = static_cast<std::size_t>(grid.width);
  std::vector<float> z(columns * static_cast<std::size_t>(grid.height)), was(columns), is(columns);
  for (std::int32_t r = 0; r < grid.height; ++r) {
    float* const row = z.data() + static_cast<std::size_t>(r) * columns;
    surface.reader().readHeights(0, r, grid.width, 1, row, grid.width);
    before.reader().readHeights(0, r, grid.width, 1, was.data(), grid.width);
    after.reader().readHeights(0, r, grid.width, 1, is.data(), grid.width);
    for (std::size_t c = 0; c < columns; ++c) {
      const double change = static_cast<double>(is[c]) - was[c];
      if (!std::isnan(change)) row[c] = static_cast<float>(row[c] + change);
    }
  }
  return makeField(grid, z);
}

struct MeanSquare {
  double sum = 0.0;
  std::int64_t count = 0;

  void add(const Version& before, const Version& after) {
    const Grid& grid = before.grid();
    for (std::int32_t r = 0; r < grid.height; ++r)
      for (std::int32_t c = 0; c < grid.width; ++c) {
        const double change =
            static_cast<double>(after.reader().heightAt(c, r)) - before.reader().heightAt(c, r);
        if (std::isnan(change)) continue;
        sum += change * change;
        ++count;
      }
  }
  [[nodiscard]] double root() const { return count > 0 ? std::sqrt(sum / static_cast<double>(count)) : 0.0; }
};

// Parameters of squares beside each other, about the form that is out of them already.
Result<ArealParameters> measuredOf(const std::vector<Version>& squares, int across,
                                   const ArealOptions& options, JobControl& job) {
  const Version part = besideEachOther(squares, across);
  const NominalForm level = PolynomialForm{0, part.grid().width, part.grid().height, 0.0, {0.0}};
  return measureAreal(part, level, options, job);
}

std::int64_t heightsIn(const std::vector<Version>& squares) {
  std::int64_t count = 0;
  for (const Version& square : squares)
    for (std::int32_t r = 0; r < square.grid().height; ++r)
      for (std::int32_t c = 0; c < square.grid().width; ++c)
        count += std::isnan(square.reader().heightAt(c, r)) ? 0 : 1;
  return count;
}

// A square of the scan and of its surface, and the surface that is made of the square alone.
struct StandingSquare {
  SampleRect rect;
  Version scan, surface, alone;
  bool empty = false;  // no sample counts in it
};

}  // namespace

std::vector<SampleRect> standingSquares(const Grid& grid, const PartOptions& options) {
  const SquareSides sides = sidesOf(grid, options);
  std::mt19937_64 random(options.seed);
  const auto within = [&](std::int32_t count, std::int32_t length, int k, int of) {
    const auto first = static_cast<std::int32_t>(std::int64_t{count} * k / of),
               last = static_cast<std::int32_t>(std::int64_t{count} * (k + 1) / of) - length;
    const auto room = static_cast<std::uint64_t>(std::max(last - first, 0)) + 1;
    // The same on every machine, as uniform_int_distribution is not.
    return std::min(first + static_cast<std::int32_t>(random() % room), count - length);
  };
  std::vector<SampleRect> squares;
  for (int j = 0; j < sides.up; ++j)
    for (int i = 0; i < sides.across; ++i) {
      const std::int32_t column = within(grid.width, sides.columns, i, sides.across);
      squares.push_back({column, within(grid.height, sides.rows, j, sides.up), sides.columns, sides.rows});
    }
  return squares;
}

Version besideEachOther(const std::vector<Version>& squares, int across) {
  Grid grid = squares.front().grid();
  const std::int32_t columns = grid.width, rows = grid.height;
  const auto up = static_cast<int>((squares.size() + static_cast<std::size_t>(across) - 1) / across);
  const std::int32_t step_x = columns + columns / 2 + 1, step_y = rows + rows / 2 + 1;
  grid.width = (across - 1) * step_x + columns;
  grid.height = (up - 1) * step_y + rows;
  std::vector<float> z(static_cast<std::size_t>(grid.samples()), std::numeric_limits<float>::quiet_NaN());
  for (std::size_t k = 0; k < squares.size(); ++k) {
    const auto i = static_cast<std::int32_t>(k) % across, j = static_cast<std::int32_t>(k) / across;
    float* const first = z.data() + static_cast<std::size_t>(j) * step_y * grid.width + i * step_x;
    squares[k].reader().readHeights(0, 0, columns, rows, first, grid.width);
  }
  return makeField(grid, z);
}

Result<PartEffects> arealEffectsOfPart(const Version& field, const NoiseModel& noise, const Version& surface,
                                       const ArealParameters& measured, const ArealOptions& options,
                                       const std::function<Result<Version>(const Version& piece)>& surface_of,
                                       const PartOptions& how, JobControl& job) try {
  ArealOptions of_part = options;
  of_part.region = Region::kAll;  // others are holes in the surface
  of_part.analysis = false;
  const int across = sidesOf(field.grid(), how).across;
  std::vector<StandingSquare> squares;
  std::vector<Version> clean;
  for (const SampleRect& r : standingSquares(field.grid(), how)) {
    StandingSquare square{r, pieceOf(field, r.column, r.row, r.columns, r.rows),
                          pieceOf(surface, r.column, r.row, r.columns, r.rows), Version()};
    auto alone = surface_of(square.scan);
    if (!alone && alone.error().kind != ErrorKind::kInput) return tl::unexpected(alone.error());
    square.empty = !alone;
    if (alone) square.alone = *std::move(alone);
    clean.push_back(square.surface);
    squares.push_back(std::move(square));
  }
  const std::vector<double> found = valuesOf(measured);
  const std::vector<NoiseGrowth> growths = growthsOf(measured);
  PartEffects result{std::vector<NoiseEffect>(
                         found.size(), {kNoEffect, kNoEffect, "the part for trials has too few samples"}),
                     heightsIn(clean)};
  if (result.samples < kFewestSamples) return result;
  const auto own = measuredOf(clean, across, of_part, job);
  if (!own) return tl::unexpected(own.error());
  const std::vector<double> own_figures = valuesOf(*own);
  std::vector<std::vector<TrialPair>> pairs(found.size());
  std::vector<DirectionPair> directions;
  MeanSquare noise_left;
  NoiseModel here = noise;
  here.map.clear();  // that of the field
  const auto trial = [&](int k, TrialNoise of) -> Result<std::vector<TrialPair>> {
    std::vector<Version> sides[2];
    for (std::size_t s = 0; s < squares.size(); ++s) {
      const StandingSquare& square = squares[s];
      const auto draw = NoiseDraw::create(
          square.scan.grid(), here,
          how.seed + (static_cast<std::uint64_t>(k) + 1) * 1000003U + static_cast<std::uint64_t>(s));
      if (!draw) return tl::unexpected(draw.error());
      for (int side = 0; side < 2; ++side) {
        if (square.empty) {
          sides[side].push_back(square.surface);
          continue;
        }
        const double size = (side == 0 ? 1.0 : -1.0) * shareIn(noise, field.grid(), square.rect) * sizeOf(of);
        const auto noisy = draw->addedTo(square.scan, here, size, job);
        if (!noisy) return tl::unexpected(noisy.error());
        const auto after = surface_of(*noisy);
        if (!after) return tl::unexpected(after.error());
        if (of == TrialNoise::kOwn) noise_left.add(square.alone, *after);
        auto changed = changedBy(square.surface, square.alone, *after);
        if (!changed) return tl::unexpected(changed.error());
        sides[side].push_back(*std::move(changed));
      }
    }
    const auto more = measuredOf(sides[0], across, optionsOf(of_part, of), job),
               less = measuredOf(sides[1], across, optionsOf(of_part, of), job);
    if (!more) return tl::unexpected(more.error());
    if (!less) return tl::unexpected(less.error());
    if (of == TrialNoise::kOwn) directions.push_back({seenDirection(*more), seenDirection(*less)});
    const std::vector<double> of_more = valuesOf(*more), of_less = valuesOf(*less);
    std::vector<TrialPair> both;
    for (std::size_t i = 0; i < found.size(); ++i) both.push_back({of_more[i], of_less[i]});
    return both;
  };
  for (int k = 0; k < how.pairs; ++k) {
    const auto both = trial(k, TrialNoise::kOwn);
    if (!both) return tl::unexpected(both.error());
    for (std::size_t i = 0; i < found.size(); ++i) pairs[i].push_back((*both)[i]);
  }
  const auto louder = trial(0, TrialNoise::kLouder);
  if (!louder) return tl::unexpected(louder.error());
  const double share = std::min(1.0, static_cast<double>(result.samples) /
                                         static_cast<double>(std::max<std::int64_t>(measured.samples, 1)));
  for (std::size_t i = 0; i < found.size(); ++i)
    // Of few places among all noise scatters no less where there are more of these.
    result.effects[i] =
        partEffectOf(found[i], own_figures[i], pairs[i], growths[i],
                     growths[i] == NoiseGrowth::kExtreme ? 1.0 : share, {noise.doubt, (*louder)[i]});

  // Of the whole surface, and of the reach that the part has.
  const double sigma = noise_left.root();
  std::vector<TrialPair> highest, lowest, between;
  if (sigma > 0.0) {
    const ExtremeTail up(surface, ExtremeTail::End::kHighest, sigma),
        down(surface, ExtremeTail::End::kLowest, sigma);
    std::mt19937_64 random(how.seed);
    for (int k = 0; k < std::max(how.pairs, 8); ++k) {
      const TrialPair top = up.drawn(random), bottom = down.drawn(random);
      highest.push_back({measured.sp + top.more, measured.sp + top.less});
      lowest.push_back({measured.sv + bottom.less, measured.sv + bottom.more});
      between.push_back({highest.back().more + lowest.back().more, highest.back().less + lowest.back().less});
    }
  }
  const Grid& grid = field.grid();
  const double reach = 0.5 * std::min(squares.front().rect.columns * grid.spacingXMm(),
                                      grid.height > 1 ? squares.front().rect.rows * grid.spacingYMm()
                                                      : std::numeric_limits<double>::infinity());
  const double slowest = measured.spatial.sal / measured.spatial.str;
  for (std::size_t i = 0; i < arealFigures().size(); ++i) {
    const std::string_view key = arealFigures()[i].key;
    const auto extreme = [&](const std::vector<TrialPair>& trials) {
      result.effects[i] = noiseEffectOf(found[i], trials, NoiseGrowth::kExtreme);
    };
    if (key == "std")
      result.effects[i] =
          directionEffect(seenDirection(measured), seenDirection(*own), directions, noise, share);
    if (key == "sp") extreme(highest);
    if (key == "sv") extreme(lowest);
    if (key == "sz") extreme(between);
    if ((key == "sal" && !(measured.spatial.sal < reach)) ||
        ((key == "str" || key == "std") && !(slowest < reach)))
      result.effects[i] = {kNoEffect, kNoEffect, "it reaches over half of the squares of trials"};
    // Whether lines that are off decide it only the whole would show (areal_figures.cpp).
    if (key == "std" && liesAlongLines(noise, measured.spatial.lay))
      result.effects[i] = {kNoEffect, kNoEffect, "its direction may be that of the lines that are off"};
    if (key == "ssw")
      result.effects[i] = {kNoEffect, kNoEffect, "no wave goes on from one square of trials to the next"};
  }
  addDominanceDoubt(result.effects, noise, measured);
  keepWithinRanges(result.effects, measured);
  return result;
} catch (const std::bad_alloc&) {
  return failure("memory is exhausted", "measuring errors", "leave the errors out with --noise-trials 0");
}

}  // namespace fettle::engine
