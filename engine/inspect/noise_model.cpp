#include "engine/inspect/noise_model.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>

#include <tbb/parallel_for.h>

#include "engine/inspect/noise.h"
#include "engine/inspect/noise_lines.h"

namespace fettle::engine {

namespace {

constexpr double kMostWindows = 8192.0;
constexpr std::int32_t kLeastStep = 4;  // between windows
constexpr double kSmallest = 0.2;
// chi^2 with 3, 3, 21 and 100 degrees of freedom: its mean and three standard deviations over its rank of a third.
constexpr std::array<double, 4> kMostOfSmallest{(3 + 3 * 2.449) / 1.569, (3 + 3 * 2.449) / 1.569,
                                                (21 + 3 * 6.481) / 17.6, (100 + 3 * 14.1) / 93.0};
constexpr double kQuiet = 0.25, kMostOfQuiet = 4.0;  // share, and variance against the loudest of them
constexpr double kPriorWindows = 4.0;                // that the map's parts are drawn to the field's noise by
constexpr std::size_t kFewWindows = 12;              // a part of the map with fewer does not count in sigma
constexpr double kLoudestPart = 0.9;  // rank: louder parts count as much as the one that has it
// Of variances. What is left of a window varies by 0.15 of itself in white noise, and within a part of the map by up to
// half where the scanner is louder on slopes; a quarter are below 0.9 of the mean.
constexpr double kMostOfPart = 1.6;   // detail of a window against the quieter ones of its part
constexpr double kMostOfField = 1.5;  // finest detail of a part's quieter windows against the field's
constexpr double kSmoother = 0.5;     // share that counts where all windows show some texture
constexpr std::size_t kBothDirections =
    2;  // the group of polynomials that are curved along rows and along columns
constexpr std::size_t kCells = NoiseModel::kMapSide * NoiseModel::kMapSide;

// Detail below so much of what float rounds a window's heights to is none: a mask, a fill value, a clipped range.
constexpr double kNoDetail = 0.01;
// Noise that neighbours share has more than its finest detail, but edges in every window have as well: beyond this the
// finest detail counts. Of variances.
constexpr double kMostOverFinest = 9.0;

// Of the ratio of the finest detail to the variance that is found. In white noise its median over all windows is it to 0.37 over
// the root of the windows that count; its mean over these is 4 % above, as they are chosen by other detail. What lacks beyond one and a half
// of that scatter was 0.78 to 1.05 of what was found too much on thirteen simulated surfaces (docs/decisions/parameter-errors.md).
constexpr double kRatioScatter = 0.55, kRatioOfCounted = 1.04, kLackFactor = 1.25;
// A variance of n independent samples by squared fourth differences has 5.3 / n; the noise that is in the scan is known better than that of others
// like it, by half.
constexpr double kSquareScatter = 1.3;
// What lines share is distinguished from a surface by the difference of its detail along and across them, which a surface with edges along them has as well.
// What is left of long waves in a window is a share of a few per cent: less of that is in doubt.
constexpr double kSharedDoubt = 0.5, kShareOfWaves = 0.1;
constexpr double kUnmeasured = 0.4;  // doubt of the finest detail alone

struct Placed {
  std::int32_t column, row;
  double magnitude;  // largest |height|
  NoiseWindow window;

  [[nodiscard]] bool shows() const noexcept {
    const double rounded = kNoDetail * std::ldexp(magnitude, -23);
    return window.usable() && window.moments.detail() > rounded * rounded;
  }
};

double medianFinest(const std::vector<const Placed*>& windows) {
  std::vector<double> finest;
  finest.reserve(windows.size());
  for (const Placed* p : windows) finest.push_back(p->window.finest);
  const auto middle = finest.begin() + static_cast<std::ptrdiff_t>(finest.size() / 2);
  std::nth_element(finest.begin(), middle, finest.end());
  return *middle;
}

// Evenly spread, with the same margin at both sides.
std::vector<Placed> placesIn(const Grid& grid) {
  std::vector<Placed> places;
  const std::int32_t right = grid.width - kNoiseSide, top = grid.height - kNoiseSide;
  if (right < 0 || top < 0) return places;
  const double samples = static_cast<double>(grid.width) * static_cast<double>(grid.height);
  const auto step =
      std::max(kLeastStep, static_cast<std::int32_t>(std::ceil(std::sqrt(samples / kMostWindows))));
  for (std::int32_t r = top % step / 2; r <= top; r += step)
    for (std::int32_t c = right % step / 2; c <= right; c += step) places.push_back({c, r, 0.0, {}});
  return places;
}

// The value of rank share * (count - 1); `values` is reordered and not empty.
double ranked(std::vector<double>& values, double share) {
  const auto at =
      values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

// Drops windows whose detail is much larger than that of the quieter ones: rough places and strong edges.
void keepQuiet(std::vector<const Placed*>& windows) {
  if (windows.empty()) return;
  std::vector<double> details;
  details.reserve(windows.size());
  for (const Placed* p : windows) details.push_back(p->window.moments.detail());
  const double most = kMostOfQuiet * ranked(details, kQuiet);
  std::erase_if(windows, [most](const Placed* p) { return p->window.moments.detail() > most; });
}

// Mean of values, those above rank `share` as large as that (Winsor's mean: Tukey 1962). Not empty.
double meanUpTo(std::vector<double> values, double share) {
  const double most = ranked(values, share);
  double sum = 0.0;
  for (const double value : values) sum += std::min(value, most);
  return sum / static_cast<double>(values.size());
}

std::size_t mapIndex(const Grid& grid, std::int32_t column, std::int32_t row) noexcept {
  constexpr std::int64_t kSide = NoiseModel::kMapSide;
  const std::int64_t x = column * kSide / grid.width, y = row * kSide / grid.height;
  return static_cast<std::size_t>(y * kSide + x);
}

std::size_t partOf(const Grid& grid, const Placed& place) noexcept {
  return mapIndex(grid, place.column + kNoiseSide / 2, place.row + kNoiseSide / 2);
}

// What few windows of a part say, drawn to what all say.
double drawn(double here, std::size_t windows, double all) noexcept {
  const auto count = static_cast<double>(windows);
  return (count * here + kPriorWindows * all) / (count + kPriorWindows);
}

// The finest detail of the quieter windows in each part of the map: the noise follows the place, within bounds. > 0, but
// where there is none at all. Not empty.
std::array<double, kCells> finestOfParts(const Grid& grid, const std::vector<const Placed*>& windows) {
  std::array<std::vector<double>, kCells> finest;
  std::vector<double> all;
  for (const Placed* p : windows) {
    finest[partOf(grid, *p)].push_back(p->window.finest);
    all.push_back(p->window.finest);
  }
  const double field = ranked(all, kQuiet);
  std::array<double, kCells> parts;
  for (std::size_t k = 0; k < kCells; ++k) {
    const double here = finest[k].empty() ? field : ranked(finest[k], kQuiet);
    parts[k] = std::min(drawn(here, finest[k].size(), field), kMostOfField * field);
  }
  return parts;
}

// Drops windows in which a group of polynomials is larger than noise makes it. How large that is, is seen in the
// smallest fifth: a third of the windows without an edge, if three in five are. Compared with the noise of the part of the
// map, not with the window's own finest detail: a texture that has much of both would pass, and be dropped as soon as
// noise is added.
void keepSmooth(const Grid& grid, std::vector<const Placed*>& windows) {
  if (windows.empty()) return;
  const std::array<double, kCells> finest = finestOfParts(grid, windows);
  const auto sizeOf = [&](const Placed& p, std::size_t group) {
    const double part = finest[partOf(grid, p)];
    return p.window.finest > 0.0 && part > 0.0 ? p.window.surface[group] * (p.window.finest / part)
                                               : std::numeric_limits<double>::infinity();
  };
  std::array<double, 4> most{};
  for (std::size_t g = 0; g < most.size(); ++g) {
    std::vector<double> sizes;
    sizes.reserve(windows.size());
    for (const Placed* p : windows) sizes.push_back(sizeOf(*p, g));
    most[g] = ranked(sizes, kSmallest) * kMostOfSmallest[g];
    // Ranks stay when noise is added. What these polynomials hold of noise says nothing about the rest of the noise.
    if (g == kBothDirections) most[g] = std::min(most[g], ranked(sizes, kSmoother));
  }
  std::erase_if(windows, [&](const Placed* p) {
    for (std::size_t g = 0; g < most.size(); ++g)
      if (!(sizeOf(*p, g) <= most[g])) return true;
    return false;
  });
}

// NoiseModel::doubt of noise whose `parts` were found in `counted` of `places` windows: `finest` is the variance that the finest detail says, over that which is
// found.
double doubtOf(const NoiseParts& parts, double finest, std::int64_t counted, std::size_t places,
               double samples) {
  const double variance = parts.variance(), windows = static_cast<double>(counted);
  if (!(variance > 0.0)) return 0.0;
  // Second differences along both directions, squared, over 36: offsets are in none, covariances of samples 1 and 2 apart by these weights.
  const double expected = parts.uncorrelated - 4.0 / 3.0 * (parts.along_row[0] + parts.along_column[0]) +
                          1.0 / 3.0 * (parts.along_row[1] + parts.along_column[1]);
  const double lack = expected / variance - finest;
  const double beyond = lack > 0.0 ? lack * lack - kRatioScatter * kRatioScatter / windows : 0.0;
  const double missing = std::min(1.0, kLackFactor * std::sqrt(std::max(0.0, beyond)));
  const double seen = std::min(windows * kNoiseSide * kNoiseSide,
                               samples * windows / static_cast<double>(std::max<std::size_t>(places, 1)));
  const double shared = std::clamp(1.0 - expected / variance, 0.0, 1.0),
               of_shared = kSharedDoubt * shared * std::min(1.0, shared / kShareOfWaves);
  return std::min(1.0, std::hypot(missing, of_shared, std::sqrt(kSquareScatter / seen)));
}

// Drops windows that are louder than noise that is the same all over their part of the map makes them.
void keepEqual(const Grid& grid, std::vector<const Placed*>& windows) {
  std::array<std::vector<double>, kCells> details;
  for (const Placed* p : windows) details[partOf(grid, *p)].push_back(p->window.moments.detail());
  std::array<double, kCells> most;
  most.fill(std::numeric_limits<double>::infinity());
  for (std::size_t k = 0; k < kCells; ++k)
    if (details[k].size() >= kFewWindows) most[k] = kMostOfPart * ranked(details[k], kQuiet);
  std::erase_if(windows,
                [&](const Placed* p) { return p->window.moments.detail() > most[partOf(grid, *p)]; });
}

// What the lines are off that the windows of a field lie in.
struct WindowLines {
  std::vector<std::int32_t> lines;  // rising
  LineNoise noise;

  // Of the lines of a window from its first on.
  [[nodiscard]] const double* from(std::int32_t line) const noexcept {
    return noise.offsets.data() + (std::lower_bound(lines.begin(), lines.end(), line) - lines.begin());
  }
};

// Takes what lines are off from a window's heights.
void withoutOffsets(std::array<float, kNoiseSide * kNoiseSide>& heights, const Placed& place,
                    const WindowLines& rows, const WindowLines& columns) {
  constexpr std::array<double, kNoiseSide> kNone{};
  const double* of_row = rows.noise.variance > 0.0 ? rows.from(place.row) : kNone.data();
  const double* of_column = columns.noise.variance > 0.0 ? columns.from(place.column) : kNone.data();
  for (std::size_t r = 0; r < kNoiseSide; ++r)
    for (std::size_t c = 0; c < kNoiseSide; ++c) {
      float& z = heights[r * kNoiseSide + c];
      // Less those of the first, so that heights are as near to 0 as they were.
      z = static_cast<float>(double{z} - (of_row[r] - of_row[0]) - (of_column[c] - of_column[0]));
    }
}

WindowLines linesOf(const FieldReader& reader, LineDirection direction, const std::vector<Placed>& places) {
  WindowLines of;
  std::vector<std::int32_t> firsts;
  firsts.reserve(places.size());
  for (const Placed& p : places) firsts.push_back(direction == LineDirection::kRows ? p.row : p.column);
  std::sort(firsts.begin(), firsts.end());
  firsts.erase(std::unique(firsts.begin(), firsts.end()), firsts.end());
  for (const std::int32_t first : firsts)
    for (std::int32_t i = of.lines.empty() ? first : std::max(first, of.lines.back() + 1);
         i < first + kNoiseSide; ++i)
      of.lines.push_back(i);
  of.noise = noiseOfLines(reader, direction, of.lines);
  return of;
}

// The noise that windows show.
Result<NoiseModel> noiseOfWindows(const Version& field, const std::vector<Placed>& places, JobControl& job) {
  std::vector<const Placed*> smooth;
  for (const Placed& place : places)
    if (place.shows()) smooth.push_back(&place);
  const double finest_of_all = smooth.empty() ? 0.0 : medianFinest(smooth);
  keepQuiet(smooth);
  keepSmooth(field.grid(), smooth);
  keepEqual(field.grid(), smooth);
  NoiseModel model;
  model.windows = static_cast<std::int64_t>(smooth.size());
  const auto uncorrelated = [&](double variance) {
    model.windows = 0;
    model.sigma = std::sqrt(variance);
    model.parts = {};
    model.parts.uncorrelated = variance;
    model.doubt = kUnmeasured;
    model.map.assign(kCells, model.sigma);
    return model;
  };
  if (smooth.empty()) {
    const auto finest = estimateNoise(field, job);
    if (!finest) return tl::unexpected(finest.error());
    return uncorrelated(finest->sigma * finest->sigma);
  }
  NoiseMoments mean;
  for (const Placed* p : smooth) mean.add(p->window.moments, 1.0 / static_cast<double>(smooth.size()));
  // Windows overlap in small fields, and all have no more samples than there are.
  const Grid& grid = field.grid();
  const std::int64_t apart = std::int64_t{grid.width} * grid.height / (kNoiseSide * kNoiseSide);
  model.parts = noiseOf(mean, std::min(model.windows, apart));
  // In the direction of the whole field's.
  const bool by_rows = mean.column_detail >= mean.row_detail;
  std::array<std::vector<double>, kCells> cells, finest_of_cells;
  std::vector<double> all;
  all.reserve(smooth.size());
  for (const Placed* p : smooth) {
    all.push_back(by_rows ? p->window.moments.column_detail : p->window.moments.row_detail);
    cells[partOf(field.grid(), *p)].push_back(all.back());
    finest_of_cells[partOf(field.grid(), *p)].push_back(p->window.finest);
  }
  // Windows without edges are not equally frequent everywhere: parts of the field count equally. The loudest few are
  // bounded by rank: noise that is added to all raises all by as much, so that it raises sigma^2 by as much.
  const double middle = ranked(all, 0.5);
  std::vector<double> all_finest;
  all_finest.reserve(smooth.size());
  for (const Placed* p : smooth) all_finest.push_back(p->window.finest);
  const double middle_of_finest = ranked(all_finest, 0.5);
  const auto drawnOf = [](const std::vector<double>& cell, double middle_of_all) {
    double sum = 0.0;
    for (const double detail : cell) sum += detail;
    const double here = cell.empty() ? middle_of_all : sum / static_cast<double>(cell.size());
    return drawn(here, cell.size(), middle_of_all);
  };
  std::vector<double> counted;
  counted.reserve(kCells);
  double found = 0.0, finest = 0.0;  // sums over the map
  for (std::size_t k = 0; k < kCells; ++k) {
    found += drawnOf(cells[k], middle);
    finest += drawnOf(finest_of_cells[k], middle_of_finest);
    model.map.push_back(mean.detail() > 0.0 ? drawnOf(cells[k], middle) / mean.detail() : 1.0);
    if (cells[k].size() >= kFewWindows) counted.push_back(model.map.back());
  }
  if (found > 0.0)
    model.doubt = doubtOf(model.parts, std::max(finest_of_all * kCells, finest / kRatioOfCounted) / found,
                          model.windows, places.size(), static_cast<double>(field.grid().samples()));
  const double squares = meanUpTo(counted.empty() ? model.map : counted, kLoudestPart);
  model.parts.scale(squares);
  if (model.parts.uncorrelated > kMostOverFinest * finest_of_all) return uncorrelated(finest_of_all);
  model.sigma = std::sqrt(model.parts.variance());
  for (double& part : model.map) part = model.sigma * std::sqrt(part / squares);
  return model;
}

// Adds what whole lines are off to the noise of windows without it.
void addLines(NoiseModel& model, double rows, double columns) {
  model.whole_rows = rows;
  model.whole_columns = columns;
  model.parts.row_offset += rows;
  model.parts.column_offset += columns;
  model.sigma = std::sqrt(model.parts.variance());
  for (double& part : model.map) part = std::sqrt(part * part + rows + columns);
}

}  // namespace

double NoiseModel::uncorrelatedShare() const noexcept {
  double correlated = parts.row_offset + parts.column_offset;
  // At lag 0 short correlation has at least what it has at lag 1.
  correlated += std::max(0.0, parts.along_row[0]) + std::max(0.0, parts.along_column[0]);
  return parts.variance() > 0.0 ? std::clamp(1.0 - correlated / parts.variance(), 0.0, 1.0) : 1.0;
}

double NoiseModel::sigmaAt(const Grid& grid, std::int32_t column, std::int32_t row) const noexcept {
  const auto along = [](std::int32_t at, std::int32_t side) {
    return std::clamp((at + 0.5) * kMapSide / side - 0.5, 0.0, kMapSide - 1.0);
  };
  const double x = along(column, grid.width), y = along(row, grid.height);
  const int left = std::min(static_cast<int>(x), kMapSide - 2),
            low = std::min(static_cast<int>(y), kMapSide - 2);
  const auto part = [&](int across, int up) {
    return map[static_cast<std::size_t>((low + up) * kMapSide + left + across)];
  };
  return std::lerp(std::lerp(part(0, 0), part(1, 0), x - left), std::lerp(part(0, 1), part(1, 1), x - left),
                   y - low);
}

Result<NoiseModel> measureNoise(const Version& field, JobControl& job) {
  const FieldReader reader = field.reader();
  std::vector<Placed> places = placesIn(field.grid());
  job.begin("measuring noise", places.size());
  const WindowLines rows = linesOf(reader, LineDirection::kRows, places);
  const WindowLines columns = linesOf(reader, LineDirection::kColumns, places);
  const bool off = rows.noise.variance > 0.0 || columns.noise.variance > 0.0;
  tbb::parallel_for(std::size_t{0}, places.size(), [&](std::size_t i) {
    if (job.cancelled()) return;
    Placed& place = places[i];
    std::array<float, kNoiseSide * kNoiseSide> heights;
    reader.readHeights(place.column, place.row, kNoiseSide, kNoiseSide, heights.data(), kNoiseSide);
    for (const float z : heights) place.magnitude = std::max(place.magnitude, std::abs(double{z}));
    if (off) withoutOffsets(heights, place, rows, columns);
    place.window = noiseWindow(heights);
    job.advance();
  });
  if (job.cancelled()) return cancelled();
  auto model = noiseOfWindows(field, places, job);
  if (model && off) addLines(*model, rows.noise.variance, columns.noise.variance);
  return model;
}

}  // namespace fettle::engine
