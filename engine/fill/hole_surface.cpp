#include "engine/fill/hole_surface.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <numeric>
#include <optional>

#include <Eigen/Cholesky>
#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>

#include "engine/field/sample_rect.h"
#include "engine/field/tile.h"

namespace fettle::engine {

namespace {

constexpr int kReach = 2;  // samples from a hole that terms hold

// What terms ask of the samples around a row of the hole: five rows, of which the middle one is worked on.
class RowWindow {
 public:
  RowWindow(const FieldReader& field, std::span<const HoleRun> runs, const LineCuts* walls)
      : field_(field), runs_(runs), walls_(walls) {
    left_ = runs.front().first;
    std::int32_t right = runs.front().last;
    for (const HoleRun& run : runs) {
      left_ = std::min(left_, run.first);
      right = std::max(right, run.last);
    }
    left_ -= kReach;
    width_ = right + kReach + 1 - left_;
    for (Row& row : rows_) row.resize(static_cast<std::size_t>(width_));
    row_ = runs.front().row;
    for (int d = -kReach; d <= kReach; ++d) load(row_ + d);
  }

  // The next row in the middle.
  void advance() {
    ++row_;
    load(row_ + kReach);
  }

  [[nodiscard]] std::int32_t row() const noexcept { return row_; }
  // Of the sample dr rows above the middle: its number among the unknown ones, or -1.
  [[nodiscard]] std::int32_t unknown(std::int32_t column, int dr) const noexcept {
    return at(dr).unknown[place(column)];
  }
  [[nodiscard]] float height(std::int32_t column, int dr) const noexcept {
    return at(dr).heights[place(column)];
  }
  [[nodiscard]] bool there(std::int32_t column, int dr) const noexcept {
    return unknown(column, dr) >= 0 || !std::isnan(height(column, dr));
  }
  [[nodiscard]] bool bends(std::int32_t column, int dr) const noexcept {
    return at(dr).bends[place(column)] != 0;
  }
  // Whether the link to the next column, or to the next row, is whole.
  [[nodiscard]] bool right(std::int32_t column, int dr) const noexcept {
    return (at(dr).cuts[place(column)] & LineCut::kRight) == 0;
  }
  [[nodiscard]] bool up(std::int32_t column, int dr) const noexcept {
    return (at(dr).cuts[place(column)] & LineCut::kUp) == 0;
  }

 private:
  struct Row {
    std::vector<float> heights;
    std::vector<std::uint8_t> bends, cuts;
    std::vector<std::int32_t> unknown;
    void resize(std::size_t n) {
      heights.resize(n);
      bends.resize(n);
      cuts.resize(n);
      unknown.resize(n);
    }
  };

  [[nodiscard]] std::size_t place(std::int32_t column) const noexcept {
    return static_cast<std::size_t>(column - left_);
  }
  // Rows below the field have numbers down to -kReach.
  [[nodiscard]] const Row& at(int dr) const noexcept {
    return rows_[static_cast<std::size_t>(row_ + dr + kReach) % rows_.size()];
  }

  // Only what terms of the hole's samples in this and the next rows hold: a ring may be as wide as the field.
  void load(std::int32_t row) {
    Row& to = rows_[static_cast<std::size_t>(row + kReach) % rows_.size()];
    while (first_near_ < runs_.size() && runs_[first_near_].row < row - kReach) ++first_near_;
    for (std::size_t i = first_near_; i < runs_.size() && runs_[i].row <= row + kReach; ++i) {
      const std::int32_t from = runs_[i].first - kReach, count = runs_[i].samples() + 2 * kReach;
      const std::size_t at = place(from);
      field_.readHeights(from, row, count, 1, to.heights.data() + at, count);
      field_.readMarks(from, row, count, 1, to.bends.data() + at, count);
      std::fill_n(to.cuts.begin() + static_cast<std::ptrdiff_t>(at), count, std::uint8_t{0});
      std::fill_n(to.unknown.begin() + static_cast<std::ptrdiff_t>(at), count, -1);
    }
    for (; next_run_ < runs_.size() && runs_[next_run_].row == row; ++next_run_)
      for (std::int32_t c = runs_[next_run_].first; c <= runs_[next_run_].last; ++c)
        to.unknown[place(c)] = next_unknown_++;
    if (walls_ == nullptr || row < 0 || row >= field_.height()) return;
    for (const LineCut& cut : walls_->row(row))
      if (cut.column >= left_ && cut.column < left_ + width_) to.cuts[place(cut.column)] = cut.links;
    for (std::size_t i = first_near_; i < runs_.size() && runs_[i].row <= row + kReach; ++i)
      loadLineSamples(row, runs_[i].first - kReach, runs_[i].last + kReach, to);
  }

  void loadLineSamples(std::int32_t row, std::int32_t from, std::int32_t to_column, Row& to) const {
    const std::int32_t first = std::max(from, 0) >> kTileShift;
    const std::int32_t last = std::min(to_column, field_.width() - 1) >> kTileShift;
    for (std::int32_t tc = first; tc <= last; ++tc)
      for (const LineSample& sample : walls_->samplesOf(tc, row >> kTileShift).samples)
        if (sample.row == row && sample.column >= from && sample.column <= to_column)
          to.bends[place(sample.column)] = 1;
  }

  const FieldReader& field_;
  std::span<const HoleRun> runs_;
  const LineCuts* walls_;
  std::int32_t left_ = 0, width_ = 0, row_ = 0;
  std::array<Row, 2 * kReach + 1> rows_;
  std::size_t next_run_ = 0;    // to be numbered
  std::size_t first_near_ = 0;  // of the rows that terms reach
  std::int32_t next_unknown_ = 0;
};

// One square of the sum: weight * (sum of factors * heights)^2.
struct Term {
  struct Part {
    std::int32_t column;
    int dr;
    double factor;
  };
  std::array<Part, 4> parts;
  int size;
  double weight;
};

// The equations of the least sum, and which unknown samples hang together up to the rim.
class Equations {
 public:
  explicit Equations(std::int32_t unknowns)
      : right(Eigen::VectorXd::Zero(unknowns)),
        parents_(static_cast<std::size_t>(unknowns)),
        rimmed_(parents_.size()) {
    std::iota(parents_.begin(), parents_.end(), 0);
  }

  void add(const RowWindow& window, const Term& term) {
    double known = 0.0;
    for (int i = 0; i < term.size; ++i) {
      const Term::Part& p = term.parts[static_cast<std::size_t>(i)];
      const std::int32_t a = window.unknown(p.column, p.dr);
      if (a < 0) {
        const auto z = static_cast<double>(window.height(p.column, p.dr));
        if (!base) base = z;
        known += p.factor * (z - *base);
      }
    }
    for (int i = 0; i < term.size; ++i) {
      const Term::Part& p = term.parts[static_cast<std::size_t>(i)];
      const std::int32_t a = window.unknown(p.column, p.dr);
      if (a < 0) continue;
      right[a] -= term.weight * p.factor * known;
      for (int k = 0; k < term.size; ++k) {
        const Term::Part& q = term.parts[static_cast<std::size_t>(k)];
        const std::int32_t b = window.unknown(q.column, q.dr);
        // The lower triangle.
        if (b >= 0 && b <= a) entries.emplace_back(a, b, term.weight * p.factor * q.factor);
      }
    }
  }

  // The two samples of a link hang together.
  void link(std::int32_t a, std::int32_t b) {
    if (a >= 0 && b >= 0) {
      a = find(a);
      b = find(b);
      rimmed_[static_cast<std::size_t>(std::min(a, b))] |= rimmed_[static_cast<std::size_t>(std::max(a, b))];
      parents_[static_cast<std::size_t>(std::max(a, b))] = std::min(a, b);
    } else {
      rimmed_[static_cast<std::size_t>(find(std::max(a, b)))] = 1;
    }
  }
  [[nodiscard]] bool rimmed(std::int32_t a) { return rimmed_[static_cast<std::size_t>(find(a))] != 0; }

  std::vector<Eigen::Triplet<double>> entries;
  Eigen::VectorXd right;
  std::optional<double> base;  // a height of the rim, which all are counted from

 private:
  std::int32_t find(std::int32_t a) noexcept {
    auto i = static_cast<std::size_t>(a);
    while (parents_[i] != static_cast<std::int32_t>(i)) {
      parents_[i] = parents_[static_cast<std::size_t>(parents_[i])];
      i = static_cast<std::size_t>(parents_[i]);
    }
    return static_cast<std::int32_t>(i);
  }

  std::vector<std::int32_t> parents_;
  std::vector<std::uint8_t> rimmed_;
};

// Weights of the kinds of terms.
struct Weights {
  double x, y;        // of links
  double xx, yy, xy;  // of second differences
};

// Calls f(term) for each term that holds unknown samples, once: from the first of them.
template <typename F>
void forTermsOf(const RowWindow& w, std::int32_t c, std::int32_t self, FillMethod method,
                const Weights& weights, F&& f) {
  const auto offer = [&](const Term& term) {
    for (int i = 0; i < term.size; ++i) {
      const Term::Part& p = term.parts[static_cast<std::size_t>(i)];
      if (!w.there(p.column, p.dr)) return;
      const std::int32_t a = w.unknown(p.column, p.dr);
      if (a >= 0 && a < self) return;
    }
    f(term);
  };
  if (method == FillMethod::kMembrane) {
    for (const int d : {-1, 0})
      if (w.right(c + d, 0)) offer({{{{c + d, 0, 1.0}, {c + d + 1, 0, -1.0}}}, 2, weights.x});
    for (const int d : {-1, 0})
      if (w.up(c, d)) offer({{{{c, d, 1.0}, {c, d + 1, -1.0}}}, 2, weights.y});
    return;
  }
  for (const int d : {-1, 0, 1}) {
    const std::int32_t m = c + d;  // the middle one
    if (w.right(m - 1, 0) && w.right(m, 0) && !w.bends(m, 0))
      offer({{{{m - 1, 0, 1.0}, {m, 0, -2.0}, {m + 1, 0, 1.0}}}, 3, weights.xx});
    if (w.up(c, d - 1) && w.up(c, d) && !w.bends(c, d))
      offer({{{{c, d - 1, 1.0}, {c, d, -2.0}, {c, d + 1, 1.0}}}, 3, weights.yy});
  }
  for (const int dr : {-1, 0})
    for (const int d : {-1, 0}) {
      const std::int32_t l = c + d;
      if (!w.right(l, dr) || !w.right(l, dr + 1) || !w.up(l, dr) || !w.up(l + 1, dr)) continue;
      const int bends = static_cast<int>(w.bends(l, dr)) + static_cast<int>(w.bends(l + 1, dr)) +
                        static_cast<int>(w.bends(l, dr + 1)) + static_cast<int>(w.bends(l + 1, dr + 1));
      if (bends >= 2) continue;  // an edge passes through the cell or along its side
      offer({{{{l, dr, 1.0}, {l + 1, dr, -1.0}, {l, dr + 1, -1.0}, {l + 1, dr + 1, 1.0}}}, 4, weights.xy});
    }
}

// One surface may be added to another without changing any term where a pivot of the decomposition is this small beside
// the largest one. A pivot is at least one over the largest deflection under a unit load: of a plate of 1000 samples
// some 1e-6, of one held at one side only 1e-9; rounding leaves 1e-14 of a pivot of 0.
constexpr double kLeastPivot = 1e-11;

// x of A x = right, refined once; nothing where A is singular.
template <typename Solver, typename Matrix, typename Product>
std::optional<Eigen::VectorXd> solved(const Matrix& a, const Eigen::VectorXd& right, const Product& times) {
  const Solver solver(a);
  if (solver.info() != Eigen::Success) return std::nullopt;
  const Eigen::VectorXd pivots = solver.vectorD();
  if (!(pivots.minCoeff() > kLeastPivot * pivots.maxCoeff())) return std::nullopt;
  Eigen::VectorXd x = solver.solve(right);
  x += solver.solve(right - times(x));
  return x;
}

std::optional<Eigen::VectorXd> solve(const Equations& equations) {
  // Below this the bookkeeping of a sparse decomposition takes longer than a dense one.
  constexpr Eigen::Index kDense = 24;
  const Eigen::Index n = equations.right.size();
  if (n <= kDense) {
    Eigen::MatrixXd a = Eigen::MatrixXd::Zero(n, n);
    for (const auto& e : equations.entries) a(e.row(), e.col()) += e.value();
    return solved<Eigen::LDLT<Eigen::MatrixXd>>(a, equations.right, [&](const Eigen::VectorXd& x) {
      return Eigen::VectorXd(a.selfadjointView<Eigen::Lower>() * x);
    });
  }
  using Sparse = Eigen::SparseMatrix<double>;
  Sparse a(n, n);
  a.setFromTriplets(equations.entries.begin(), equations.entries.end());
  return solved<Eigen::SimplicialLDLT<Sparse>>(a, equations.right, [&](const Eigen::VectorXd& x) {
    return Eigen::VectorXd(a.selfadjointView<Eigen::Lower>() * x);
  });
}

}  // namespace

HoleSurface surfaceOfHole(const FieldReader& field, std::span<const HoleRun> runs, const LineCuts* walls,
                          FillMethod method, double spacing_x, double spacing_y) {
  std::int64_t samples = 0;
  for (const HoleRun& run : runs) samples += run.samples();
  // About the mean of the two spacings, so that weights are near 1 in every unit.
  const double mean = std::sqrt(spacing_x * spacing_y);
  const double x = mean / spacing_x, y = mean / spacing_y;
  const Weights plain{x * x, y * y, x * x * x * x, y * y * y * y, 2.0};  // of xy: (x y)^2, and x y is 1
  // Beside curvature where that alone does not determine the surface.
  constexpr double kSlopeShare = 1e-6;
  const Weights light{kSlopeShare * plain.x, kSlopeShare * plain.y, 0.0, 0.0, 0.0};

  std::optional<Eigen::VectorXd> found;
  Equations equations(0);
  HoleSurface surface;
  for (int attempt = 0; attempt < 2 && !found; ++attempt) {
    surface.undetermined = attempt > 0;
    equations = Equations(static_cast<std::int32_t>(samples));
    equations.entries.reserve(static_cast<std::size_t>(samples) * (method == FillMethod::kMembrane ? 6 : 26));
    RowWindow window(field, runs, walls);
    for (const HoleRun& run : runs) {
      while (window.row() < run.row) window.advance();
      for (std::int32_t c = run.first; c <= run.last; ++c) {
        const std::int32_t self = window.unknown(c, 0);
        const auto add = [&](const Term& term) { equations.add(window, term); };
        forTermsOf(window, c, self, method, plain, add);
        if (surface.undetermined) forTermsOf(window, c, self, FillMethod::kMembrane, light, add);
        forTermsOf(window, c, self, FillMethod::kMembrane, plain, [&](const Term& link) {
          equations.link(window.unknown(link.parts[0].column, link.parts[0].dr),
                         window.unknown(link.parts[1].column, link.parts[1].dr));
        });
      }
    }
    // Samples that no rim reaches stay out of it.
    for (std::int32_t i = 0; i < samples; ++i)
      if (!equations.rimmed(i)) equations.entries.emplace_back(i, i, 1.0);
    found = solve(equations);
  }
  surface.heights.assign(static_cast<std::size_t>(samples), std::numeric_limits<float>::quiet_NaN());
  if (!found) return surface;
  for (std::int32_t i = 0; i < samples; ++i) {
    const double z = equations.base.value_or(0.0) + (*found)[i];
    if (equations.rimmed(i) && std::abs(z) <= static_cast<double>(std::numeric_limits<float>::max()))
      surface.heights[static_cast<std::size_t>(i)] = static_cast<float>(z);
  }
  return surface;
}

}  // namespace fettle::engine
