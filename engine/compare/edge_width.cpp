#include "engine/compare/edge_width.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>

#include <glm/vec2.hpp>

namespace fettle::engine {

namespace {

constexpr int kCell = 16;            // one profile per cell of this many samples
constexpr int kMaxHalf = 96;         // bound of a patch's half side, for very different spacings
constexpr double kOffLine = 1.0;     // [samples] a corner's boundary is farther off the parabola than this
constexpr double kOffPlane = 0.1;    // of the step
constexpr double kEdgeMargin = 1.0;  // [samples] nearer ones may be on either side by the sampling alone
constexpr double kBin = 0.5;         // [samples]
constexpr double kLeastValid = 0.8;

// Places in a patch are relative to its centre sample, in millimetres.
struct Patch {
  std::int32_t column = 0;
  std::int32_t row = 0;
  int half_columns = 0;
  int half_rows = 0;
  double sx = 1.0;
  double sy = 1.0;
  double sample = 1.0;  // [mm], geometric mean of the spacings: length of "a sample" in any direction
  std::vector<float> truth;

  [[nodiscard]] int width() const noexcept { return 2 * half_columns + 1; }
  [[nodiscard]] double truthAt(int c, int r) const noexcept {
    return static_cast<double>(truth[static_cast<std::size_t>((r + half_rows) * width() + c + half_columns)]);
  }
};

// The edge in a patch: v = a + b u + c u^2, u along it and v towards the higher side.
struct LocalEdge {
  glm::dvec2 origin{0.0, 0.0};
  glm::dvec2 along{1.0, 0.0};
  double a = 0.0;
  double b = 0.0;
  double c = 0.0;

  [[nodiscard]] double u(glm::dvec2 p) const noexcept {
    const glm::dvec2 q = p - origin;
    return along.x * q.x + along.y * q.y;
  }
  [[nodiscard]] double v(glm::dvec2 p) const noexcept {
    const glm::dvec2 q = p - origin;
    return along.x * q.y - along.y * q.x;
  }
  // Signed distance to first order in the curvature.
  [[nodiscard]] double distance(glm::dvec2 p) const noexcept {
    const double at = u(p);
    const double slope = b + 2.0 * c * at;
    return (v(p) - (a + at * (b + at * c))) / std::sqrt(1.0 + slope * slope);
  }
};

// Solves the symmetric 3 x 3 system by Cramer's rule; nothing when it is singular.
std::optional<std::array<double, 3>> solve3(const std::array<double, 6>& m, const std::array<double, 3>& y) {
  const auto& [m00, m01, m02, m11, m12, m22] = m;
  const double c00 = m11 * m22 - m12 * m12;
  const double c01 = m02 * m12 - m01 * m22;
  const double c02 = m01 * m12 - m02 * m11;
  const double determinant = m00 * c00 + m01 * c01 + m02 * c02;
  if (!(std::abs(determinant) > 1e-12 * m00 * m11 * m22)) return {};
  const double c11 = m00 * m22 - m02 * m02;
  const double c12 = m01 * m02 - m00 * m12;
  const double c22 = m00 * m11 - m01 * m01;
  return std::array<double, 3>{(c00 * y[0] + c01 * y[1] + c02 * y[2]) / determinant,
                               (c01 * y[0] + c11 * y[1] + c12 * y[2]) / determinant,
                               (c02 * y[0] + c12 * y[1] + c22 * y[2]) / determinant};
}

// Least squares of y = k0 + k1 p + k2 q over points (p, q); exact sums are not needed over a patch.
struct ThreeTerms {
  std::array<double, 6> m{};
  std::array<double, 3> rhs{};

  void add(double p, double q, double y) noexcept {
    m = {m[0] + 1.0, m[1] + p, m[2] + q, m[3] + p * p, m[4] + p * q, m[5] + q * q};
    rhs = {rhs[0] + y, rhs[1] + p * y, rhs[2] + q * y};
  }
  [[nodiscard]] auto solve() const { return solve3(m, rhs); }
};

// Lowest and highest truth in the 3 x 3 samples about (c, r); holes and the outside left out.
std::pair<double, double> range3(const FieldReader& truth, std::int32_t c, std::int32_t r) {
  float z[9];
  truth.readHeights(c - 1, r - 1, 3, 3, z, 3);
  double low = std::numeric_limits<double>::infinity();
  double high = -low;
  for (const float h : z) {
    if (static_cast<double>(h) < low) low = static_cast<double>(h);
    if (static_cast<double>(h) > high) high = static_cast<double>(h);
  }
  return {low, high};
}

// The points half way between different 4-neighbours, within `radius` of the centre.
std::vector<glm::dvec2> boundary(const Patch& patch, double mid, double radius) {
  std::vector<glm::dvec2> points;
  const auto look = [&](int c, int r, int dc, int dr) {
    const double here = patch.truthAt(c, r);
    const double there = patch.truthAt(c + dc, r + dr);
    if (std::isnan(here + there) || (here > mid) == (there > mid)) return;
    const glm::dvec2 p{(c + 0.5 * dc) * patch.sx, (r + 0.5 * dr) * patch.sy};
    if (p.x * p.x + p.y * p.y <= radius * radius) points.push_back(p);
  };
  for (int r = -patch.half_rows; r <= patch.half_rows; ++r)
    for (int c = -patch.half_columns; c <= patch.half_columns; ++c) {
      if (c < patch.half_columns) look(c, r, 1, 0);
      if (r < patch.half_rows) look(c, r, 0, 1);
    }
  return points;
}

std::optional<LocalEdge> fitLine(const Patch& patch, double mid, double radius) {
  const std::vector<glm::dvec2> points = boundary(patch, mid, radius);
  if (points.size() < 6) return {};
  LocalEdge line;
  for (const glm::dvec2& p : points) line.origin += p / static_cast<double>(points.size());
  double xx = 0.0;
  double xy = 0.0;
  double yy = 0.0;
  for (const glm::dvec2& p : points) {
    const glm::dvec2 q = p - line.origin;
    xx += q.x * q.x;
    xy += q.x * q.y;
    yy += q.y * q.y;
  }
  const double turn = 0.5 * std::atan2(2.0 * xy, xx - yy);  // of the main axis
  line.along = {std::cos(turn), std::sin(turn)};
  ThreeTerms terms;
  double reach = 0.0;
  for (const glm::dvec2& p : points) {
    const double u = line.u(p);
    terms.add(u, u * u, line.v(p));
    reach = std::max(reach, std::abs(u));
  }
  const auto k = terms.solve();
  // An edge that does not run through the whole patch ends in it.
  if (!k || reach < 0.7 * radius) return {};
  line.a = (*k)[0];
  line.b = (*k)[1];
  line.c = (*k)[2];
  for (const glm::dvec2& p : points)
    if (std::abs(line.distance(p)) > kOffLine * patch.sample) return {};
  return line;
}

// The surface on one side: z = k0 + k1 x + k2 y.
struct Land {
  std::array<double, 3> k{};
  [[nodiscard]] double at(glm::dvec2 p) const noexcept { return k[0] + k[1] * p.x + k[2] * p.y; }
};

struct Lands {
  Land low;
  Land high;
};

// Calls f(place, distance to the edge, c, r) for the samples of the profile.
void forEachInReach(const Patch& patch, const LocalEdge& line, const TruthOptions& options, auto&& f) {
  const double along = options.profile_half_length * patch.sample;
  const double across = options.profile_reach * patch.sample;
  for (int r = -patch.half_rows; r <= patch.half_rows; ++r)
    for (int c = -patch.half_columns; c <= patch.half_columns; ++c) {
      const glm::dvec2 p{c * patch.sx, r * patch.sy};
      if (std::abs(line.u(p)) > along) continue;
      const double d = line.distance(p);
      if (std::abs(d) <= across) f(p, d, c, r);
    }
}

// Planes through the truth on both sides; turns the line so that its positive side is the higher one.
std::optional<Lands> fitLands(const Patch& patch, LocalEdge& line, const TruthOptions& options) {
  ThreeTerms below;
  ThreeTerms above;
  bool whole = true;
  forEachInReach(patch, line, options, [&](glm::dvec2 p, double d, int c, int r) {
    const double z = patch.truthAt(c, r);
    whole = whole && !std::isnan(z);
    if (std::abs(d) >= kEdgeMargin * patch.sample) (d < 0.0 ? below : above).add(p.x, p.y, z);
  });
  if (!whole) return {};
  const auto k_below = below.solve();
  const auto k_above = above.solve();
  if (!k_below || !k_above) return {};
  Lands lands{{*k_below}, {*k_above}};
  if (lands.high.at(line.origin) < lands.low.at(line.origin)) {
    std::swap(lands.low, lands.high);
    line.along =
        -line.along;  // u and v both change sign: v = a + b u + c u^2 becomes v' = -a + b u' - c u'^2
    line.a = -line.a;
    line.c = -line.c;
  }
  const double step = lands.high.at(line.origin) - lands.low.at(line.origin);
  bool plane = step > 0.0;
  forEachInReach(patch, line, options, [&](glm::dvec2 p, double d, int c, int r) {
    if (std::abs(d) < kEdgeMargin * patch.sample) return;
    const Land& land = d < 0.0 ? lands.low : lands.high;
    plane = plane && std::abs(patch.truthAt(c, r) - land.at(p)) <= kOffPlane * step &&
            lands.high.at(p) - lands.low.at(p) >= 0.5 * step;
  });
  if (!plane) return {};
  return lands;
}

// A run of bins with one value after pooling.
struct Block {
  double first = 0.0;  // distance of its first and last bin
  double last = 0.0;
  double sum = 0.0;
  double weight = 0.0;
  [[nodiscard]] double value() const noexcept { return sum / weight; }
};

// Distance between the 10 % and the 90 % point of the monotone profile; NaN when it lacks one of them.
double rise(const std::vector<Block>& bins) {
  std::vector<Block> pooled;
  for (const Block& bin : bins) {
    pooled.push_back(bin);
    while (pooled.size() > 1 && pooled[pooled.size() - 2].value() > pooled.back().value()) {
      Block& into = pooled[pooled.size() - 2];
      const Block& from = pooled.back();
      into = {into.first, from.last, into.sum + from.sum, into.weight + from.weight};
      pooled.pop_back();
    }
  }
  const auto crossing = [&](double level) {
    for (std::size_t i = 1; i < pooled.size(); ++i) {
      const double below = pooled[i - 1].value();
      const double above = pooled[i].value();
      if (below <= level && level < above)
        return pooled[i - 1].last +
               (pooled[i].first - pooled[i - 1].last) * ((level - below) / (above - below));
    }
    return kNoFigure;
  };
  return crossing(0.9) - crossing(0.1);
}

// NaN when too many samples are missing or the profile does not reach; `lost` distinguishes the two.
double widthOf(const Patch& patch, const std::vector<float>& heights, double scale, const LocalEdge& line,
               const Lands& lands, const TruthOptions& options, bool& lost) {
  const double bin = kBin * patch.sample;
  const int bins_a_side = static_cast<int>(std::ceil(options.profile_reach / kBin));
  std::vector<Block> bins(static_cast<std::size_t>(2 * bins_a_side + 1));
  std::int64_t all = 0;
  std::int64_t valid = 0;
  forEachInReach(patch, line, options, [&](glm::dvec2 p, double d, int c, int r) {
    ++all;
    const auto i = static_cast<std::size_t>((r + patch.half_rows) * patch.width() + c + patch.half_columns);
    const double z = static_cast<double>(heights[i]) * scale;
    if (std::isnan(z)) return;
    ++valid;
    const double low = lands.low.at(p);
    Block& into = bins[static_cast<std::size_t>(static_cast<int>(std::floor(d / bin)) + bins_a_side)];
    into.first += d;  // a sum here, the mean below
    into.sum += (z - low) / (lands.high.at(p) - low);
    into.weight += 1.0;
  });
  lost = static_cast<double>(valid) < kLeastValid * static_cast<double>(all);
  if (lost) return kNoFigure;
  std::erase_if(bins, [](const Block& b) { return b.weight == 0.0; });
  for (Block& b : bins) b.first = b.last = b.first / b.weight;
  return rise(bins);
}

}  // namespace

std::vector<EdgeWidth> edgeWidths(const FieldReader& field, double field_in_truth, const FieldReader& truth,
                                  const FieldReader& edges, const TruthOptions& options,
                                  const SampleRect& rect) {
  std::vector<EdgeWidth> widths;
  Patch patch;
  patch.sx = truth.grid().spacingXMm();
  patch.sy = truth.grid().spacingYMm();
  patch.sample = std::sqrt(patch.sx * patch.sy);
  const double radius = std::hypot(options.profile_reach, options.profile_half_length) * patch.sample;
  patch.half_columns = static_cast<int>(std::min<double>(std::ceil(radius / patch.sx), kMaxHalf));
  patch.half_rows = static_cast<int>(std::min<double>(std::ceil(radius / patch.sy), kMaxHalf));
  const auto samples = static_cast<std::size_t>(patch.width()) * (2 * patch.half_rows + 1);
  patch.truth.resize(samples);
  std::vector<float> heights(samples);
  std::uint8_t marks[kTileSamples];
  edges.readMarks(rect.column, rect.row, rect.columns, rect.rows, marks, kTileSide);

  for (int r0 = 0; r0 < rect.rows; r0 += kCell)
    for (int c0 = 0; c0 < rect.columns; c0 += kCell) {
      double largest = 0.0;
      double mid = 0.0;
      for (int r = r0; r < std::min(r0 + kCell, rect.rows); ++r)
        for (int c = c0; c < std::min(c0 + kCell, rect.columns); ++c) {
          if (marks[r * kTileSide + c] == 0) continue;
          const auto [low, high] = range3(truth, rect.column + c, rect.row + r);
          if (!(high - low > largest)) continue;
          largest = high - low;
          mid = 0.5 * (low + high);
          patch.column = rect.column + c;
          patch.row = rect.row + r;
        }
      if (largest == 0.0) continue;
      const auto read = [&](const FieldReader& from, std::vector<float>& to) {
        from.readHeights(patch.column - patch.half_columns, patch.row - patch.half_rows, patch.width(),
                         2 * patch.half_rows + 1, to.data(), patch.width());
      };
      read(truth, patch.truth);
      std::optional<LocalEdge> line = fitLine(patch, mid, options.profile_half_length * patch.sample);
      if (!line) continue;
      const std::optional<Lands> lands = fitLands(patch, *line, options);
      if (!lands) continue;
      bool lost = false;
      EdgeWidth width;
      width.truth = widthOf(patch, patch.truth, 1.0, *line, *lands, options, lost);
      if (std::isnan(width.truth)) continue;
      read(field, heights);
      width.field = widthOf(patch, heights, field_in_truth, *line, *lands, options, lost);
      if (!lost) widths.push_back(width);
    }
  return widths;
}

}  // namespace fettle::engine
