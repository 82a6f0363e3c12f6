#include "engine/field/moved_form.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdlib>
#include <utility>
#include <vector>

#include <glm/geometric.hpp>

namespace fettle::engine {

namespace {

constexpr int kTerms = PolynomialForm::kMostDegree + 1;

// A sum of T_i(u) T_j(v), i + j up to PolynomialForm::kMostDegree; terms beyond are not kept.
class TermSum {
 public:
  [[nodiscard]] static TermSum one() {
    TermSum sum;
    sum.at_[0][0] = 1.0;
    return sum;
  }
  void add(double factor, const TermSum& other) {
    for (std::size_t i = 0; i < kTerms; ++i)
      for (std::size_t j = 0; j < kTerms; ++j) at_[i][j] += factor * other.at_[i][j];
  }
  // T_a T_b = (T_(a + b) + T_|a - b|) / 2.
  [[nodiscard]] TermSum times(const TermSum& other) const {
    TermSum product;
    for (int i = 0; i < kTerms; ++i)
      for (int j = 0; j < kTerms; ++j)
        for (int k = 0; k < kTerms; ++k)
          for (int l = 0; l < kTerms; ++l) {
            const double quarter = 0.25 * at(i, j) * other.at(k, l);
            if (quarter == 0.0) continue;
            for (const int across : {i + k, std::abs(i - k)})
              for (const int up : {j + l, std::abs(j - l)})
                if (across + up < kTerms)
                  product.at_[static_cast<std::size_t>(across)][static_cast<std::size_t>(up)] += quarter;
          }
    return product;
  }
  [[nodiscard]] double at(int i, int j) const {
    return at_[static_cast<std::size_t>(i)][static_cast<std::size_t>(j)];
  }
  // The linear one.
  static TermSum linear(double constant, double by_u, double by_v) {
    TermSum sum;
    sum.at_[0][0] = constant;
    sum.at_[1][0] = by_u;
    sum.at_[0][1] = by_v;
    return sum;
  }

 private:
  std::array<std::array<double, kTerms>, kTerms> at_{};
};

// T_0 .. T_last of a sum.
std::array<TermSum, kTerms> chebyshevOf(const TermSum& x) {
  std::array<TermSum, kTerms> t;
  t[0] = TermSum::one();
  t[1] = x;
  for (std::size_t k = 2; k < kTerms; ++k) {
    t[k].add(2.0, x.times(t[k - 1]));
    t[k].add(-1.0, t[k - 2]);
  }
  return t;
}

// PolynomialForm::scaled() of an old place along one axis by those of the new one; `count`: samples along the old axis.
TermSum scaledAt(double first, double per_column, double per_row, std::int32_t count, std::int32_t width,
                 std::int32_t height) {
  if (count == 1) return {};
  const double unit = count - 1, across = per_column * (width - 1), up = per_row * (height - 1);
  return TermSum::linear((2.0 * first + across + up) / unit - 1.0, across / unit, up / unit);
}

std::optional<ShapeForm> movedShape(const ShapeForm& form, const PlaceMap& places, std::int32_t width,
                                    std::int32_t height) {
  const glm::dvec2 spacing(form.spacing_x_mm, form.spacing_y_mm);
  const glm::dvec2 column = spacing * places.per_column, row = spacing * places.per_row;  // [mm]
  ShapeForm moved = form;
  moved.width = width;
  moved.height = height;
  moved.spacing_x_mm = glm::length(column);
  moved.spacing_y_mm = glm::length(row);
  if (!(moved.spacing_x_mm > 0.0 && moved.spacing_y_mm > 0.0)) return std::nullopt;
  const glm::dvec2 x = column / moved.spacing_x_mm, y = row / moved.spacing_y_mm;
  constexpr double kSquare = 1e-9;
  if (!(std::abs(glm::dot(x, y)) <= kSquare)) return std::nullopt;
  const glm::dvec2 foot = places.newPlace({form.column, form.row});
  moved.column = foot.x;
  moved.row = foot.y;
  const auto turned = [&](const glm::dvec3& d) {
    return glm::dvec3(glm::dot(x, glm::dvec2(d)), glm::dot(y, glm::dvec2(d)), d.z);
  };
  moved.normal = turned(form.normal);
  moved.axis = turned(form.axis);
  moved = withFootInside(moved);
  if (!moved.sound()) return std::nullopt;
  // Its bound may count for more on the smaller field.
  constexpr int kPlaces = 16;
  const double close =
      1e-9 * glm::length(glm::dvec2(width, height) * glm::dvec2(moved.spacing_x_mm, moved.spacing_y_mm)) /
      moved.height_mm;
  for (int r = 0; r <= kPlaces; ++r)
    for (int c = 0; c <= kPlaces; ++c) {
      const double at_column = c * (width - 1) / static_cast<double>(kPlaces),
                   at_row = r * (height - 1) / static_cast<double>(kPlaces);
      const glm::dvec2 old = places.at(at_column, at_row);
      const double was = form.heightAt(old.x, old.y);
      if (!(std::abs(moved.heightAt(at_column, at_row) - was) <= close + 1e-12 * std::abs(was)))
        return std::nullopt;
    }
  return moved;
}

}  // namespace

PolynomialForm movedPolynomial(const PolynomialForm& form, const PlaceMap& places, std::int32_t width,
                               std::int32_t height) {
  const auto t =
      chebyshevOf(scaledAt(places.first.x, places.per_column.x, places.per_row.x, form.width, width, height));
  const auto s = chebyshevOf(
      scaledAt(places.first.y, places.per_column.y, places.per_row.y, form.height, width, height));
  TermSum sum;
  std::size_t k = 0;
  for (std::size_t i = 0; i <= static_cast<std::size_t>(form.degree); ++i)
    for (std::size_t j = 0; i + j <= static_cast<std::size_t>(form.degree); ++j)
      sum.add(form.coefficients[k++], t[i].times(s[j]));
  PolynomialForm moved{form.degree, width, height, form.base, {}};
  moved.coefficients.reserve(form.coefficients.size());
  for (int i = 0; i <= form.degree; ++i)
    for (int j = 0; i + j <= form.degree; ++j) moved.coefficients.push_back(sum.at(i, j));
  return moved;
}

ShapeForm withFootInside(const ShapeForm& form) {
  const double right = form.width - 1, top = form.height - 1;
  if (form.column >= 0.0 && form.row >= 0.0 && form.column <= right && form.row <= top) return form;
  // The place of a grid that is next to the middle, where it can be one.
  constexpr int kPlaces = 16;
  std::vector<std::pair<int, glm::dvec2>> places;
  places.reserve((kPlaces + 1) * (kPlaces + 1));
  for (int r = 0; r <= kPlaces; ++r)
    for (int c = 0; c <= kPlaces; ++c) {
      const int across = 2 * c - kPlaces, up = 2 * r - kPlaces;
      places.emplace_back(across * across + up * up, glm::dvec2(c * right, r * top) / double{kPlaces});
    }
  std::ranges::stable_sort(places, {}, &std::pair<int, glm::dvec2>::first);
  for (const auto& [away, place] : places)
    if (const auto other = form.aboutFootAt(place.x, place.y)) return *other;
  return form;
}

std::optional<NominalForm> movedForm(const NominalForm& form, const PlaceMap& places, std::int32_t width,
                                     std::int32_t height) {
  if (const PolynomialForm* polynomial = form.polynomial())
    return movedPolynomial(*polynomial, places, width, height);
  const auto shape = movedShape(*form.shape(), places, width, height);
  if (!shape) return std::nullopt;
  return *shape;
}

}  // namespace fettle::engine
