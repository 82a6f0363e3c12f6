#include "engine/measure/form_onto.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numbers>
#include <optional>
#include <utility>

#include <glm/matrix.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "engine/field/moved_form.h"

namespace fettle::engine {

namespace {

glm::dvec2 spacingOf(const Grid& grid) {
  return {grid.spacingXMm(), grid.spacingYMm()};
}

bool tilts(const RigidMotion& motion) {
  constexpr double kRounding = 1e-13;
  return std::hypot(motion.rotation[2].x, motion.rotation[2].y) > kRounding;
}

// Where the samples of `onto` lie among those of `own` for a motion that does not tilt.
PlaceMap levelPlaces(const Grid& own, const RigidMotion& motion, const Grid& onto) {
  const glm::dmat3 back = glm::transpose(motion.rotation);
  const glm::dvec2 from = spacingOf(own), to = spacingOf(onto);
  return {.first = glm::dvec2(motion.movedBack({0.0, 0.0, 0.0})) / from,
          .per_column = glm::dvec2(back * glm::dvec3(to.x, 0.0, 0.0)) / from,
          .per_row = glm::dvec2(back * glm::dvec3(0.0, to.y, 0.0)) / from};
}

// The moved surface of a form, as heights over places in mm.
class MovedSurface {
 public:
  MovedSurface(const NominalForm& form, const Grid& own, const RigidMotion& motion)
      : form_(form),
        motion_(motion),
        along_(glm::transpose(motion.rotation)[2]),
        spacing_(spacingOf(own)),
        unit_(own.height_unit.mm) {}

  // [mm]; NaN where it overhangs.
  [[nodiscard]] double at(double x, double y) const {
    double z = motion_.moved(onForm(glm::dvec2(motion_.movedBack({x, y, motion_.shift.z})))).z;
    constexpr int kRounds = 50;
    for (int round = 0; round < kRounds; ++round) {
      const glm::dvec3 p = motion_.movedBack({x, y, z});
      const double step = onForm(p).z - p.z;
      const glm::dvec2 slope = slopeAt(p);
      const double rise = along_.z - slope.x * along_.x - slope.y * along_.y;
      if (!(rise > kLeastRise)) break;
      z += step / rise;
      if (std::abs(step) <= 1e-14 * (std::abs(z) + std::abs(p.z))) return z;
      if (round + 1 == kRounds && std::abs(step) <= 1e-9 * (1.0 + std::abs(z))) return z;
    }
    return std::numeric_limits<double>::quiet_NaN();
  }

  // Whether a place lies over the field that the form was of.
  [[nodiscard]] bool over(double x, double y, double z) const {
    const glm::dvec2 p = glm::dvec2(motion_.movedBack({x, y, z})) / spacing_;
    constexpr double kRounding = 1e-6;
    return p.x >= -kRounding && p.y >= -kRounding && p.x <= form_.width() - 1 + kRounding &&
           p.y <= form_.height() - 1 + kRounding;
  }

 private:
  static constexpr double kLeastRise = 0.05;

  [[nodiscard]] double heightAt(double x, double y) const {
    return unit_ * form_.heightAt(x / spacing_.x, y / spacing_.y);
  }
  [[nodiscard]] glm::dvec3 onForm(const glm::dvec2& p) const { return {p, heightAt(p.x, p.y)}; }
  [[nodiscard]] glm::dvec2 slopeAt(const glm::dvec3& p) const {
    const glm::dvec2 h = 0.5 * spacing_;
    return {(heightAt(p.x + h.x, p.y) - heightAt(p.x - h.x, p.y)) / (2.0 * h.x),
            (heightAt(p.x, p.y + h.y) - heightAt(p.x, p.y - h.y)) / (2.0 * h.y)};
  }

  const NominalForm& form_;
  const RigidMotion& motion_;
  glm::dvec3 along_;
  glm::dvec2 spacing_;
  double unit_;
};

// Where a moved form lies, over the samples of `onto`: its rectangle [mm].
struct Box {
  glm::dvec2 low, high;
};

std::optional<Box> boxOf(const NominalForm& form, const Grid& own, const RigidMotion& motion,
                         const Grid& onto) {
  Box box{glm::dvec2(std::numeric_limits<double>::infinity()),
          glm::dvec2(-std::numeric_limits<double>::infinity())};
  const double right = form.width() - 1, top = form.height() - 1;
  for (const glm::dvec2& corner : {glm::dvec2(0.0, 0.0), {right, 0.0}, {0.0, top}, {right, top}}) {
    const glm::dvec2 at = corner * spacingOf(own);
    const glm::dvec3 p = motion.moved({at, own.height_unit.mm * form.heightAt(corner.x, corner.y)});
    box.low = glm::min(box.low, glm::dvec2(p));
    box.high = glm::max(box.high, glm::dvec2(p));
  }
  box.low = glm::max(box.low, glm::dvec2(0.0));
  box.high = glm::min(box.high, glm::dvec2(onto.width - 1, onto.height - 1) * spacingOf(onto));
  if (!(box.low.x <= box.high.x && box.low.y <= box.high.y)) return std::nullopt;
  // A field of one row has nothing across it.
  box.high = glm::max(box.high, box.low + 1e-9 * spacingOf(onto));
  return box;
}

std::optional<FormOnto> tilted(const PolynomialForm& form, const Grid& own, const RigidMotion& motion,
                               const Grid& onto) {
  const NominalForm whole(form);
  const auto box = boxOf(whole, own, motion, onto);
  if (!box) return std::nullopt;
  const MovedSurface surface(whole, own, motion);
  const glm::dvec2 middle = 0.5 * (box->low + box->high), half = 0.5 * (box->high - box->low);
  constexpr int kNodes = 12;
  const int degree = std::max(form.degree, 1);
  std::array<std::array<double, PolynomialForm::kMostDegree + 1>, kNodes> t{};
  std::array<double, kNodes> node{};
  for (std::size_t k = 0; k < kNodes; ++k) {
    node[k] = std::cos(std::numbers::pi * (static_cast<double>(k) + 0.5) / kNodes);
    PolynomialForm::chebyshev(node[k], degree, t[k].data());
  }
  const double unit = onto.height_unit.mm;
  // About the height in the middle, which keeps the digits of heights far from 0.
  PolynomialForm fit{degree, 2, 2, surface.at(middle.x, middle.y) / unit, {}};
  std::array<std::array<double, kNodes>, kNodes> z{};
  for (std::size_t r = 0; r < kNodes; ++r)
    for (std::size_t c = 0; c < kNodes; ++c)
      z[r][c] = surface.at(middle.x + half.x * node[c], middle.y + half.y * node[r]) / unit - fit.base;
  fit.coefficients.reserve(static_cast<std::size_t>(PolynomialForm::terms(degree)));
  for (std::size_t i = 0; i <= static_cast<std::size_t>(degree); ++i)
    for (std::size_t j = 0; i + j <= static_cast<std::size_t>(degree); ++j) {
      double sum = 0.0;
      for (std::size_t r = 0; r < kNodes; ++r)
        for (std::size_t c = 0; c < kNodes; ++c) sum += z[r][c] * t[c][i] * t[r][j];
      fit.coefficients.push_back((i == 0 ? 1.0 : 2.0) * (j == 0 ? 1.0 : 2.0) / (kNodes * kNodes) * sum);
    }
  // From two samples at the ends of the box to those of the field.
  const glm::dvec2 spacing = spacingOf(onto), wide = box->high - box->low;
  const PlaceMap places{.first = -box->low / wide,
                        .per_column = glm::dvec2(spacing.x / wide.x, 0.0),
                        .per_row = glm::dvec2(0.0, spacing.y / wide.y)};
  FormOnto moved{movedPolynomial(fit, places, onto.width, onto.height)};
  constexpr int kPlaces = 24;
  for (int r = 0; r <= kPlaces; ++r)
    for (int c = 0; c <= kPlaces; ++c) {
      const double x = box->low.x + wide.x * c / kPlaces, y = box->low.y + wide.y * r / kPlaces;
      const double there = surface.at(x, y);
      if (!std::isfinite(there)) return std::nullopt;
      if (!surface.over(x, y, there)) continue;
      moved.off_mm =
          std::max(moved.off_mm, std::abs(unit * moved.form.heightAt(x / spacing.x, y / spacing.y) - there));
    }
  if (form.degree <= 1) moved.off_mm = 0.0;  // rounding
  return moved;
}

std::optional<FormOnto> movedShape(const ShapeForm& form, const Grid& own, const RigidMotion& motion,
                                   const Grid& onto) {
  if (form.spacing_x_mm != own.spacingXMm() || form.spacing_y_mm != own.spacingYMm() ||
      form.height_mm != own.height_unit.mm)
    return std::nullopt;
  const auto placed = [&](const ShapeForm& about) {
    const glm::dvec3 foot = motion.moved(
        {about.column * about.spacing_x_mm, about.row * about.spacing_y_mm, about.base * about.height_mm});
    ShapeForm moved = about;
    moved.width = onto.width;
    moved.height = onto.height;
    moved.spacing_x_mm = onto.spacingXMm();
    moved.spacing_y_mm = onto.spacingYMm();
    moved.height_mm = onto.height_unit.mm;
    moved.column = foot.x / moved.spacing_x_mm;
    moved.row = foot.y / moved.spacing_y_mm;
    moved.base = foot.z / moved.height_mm;
    moved.normal = motion.rotation * about.normal;
    moved.axis = motion.rotation * about.axis;
    return withFootInside(moved);
  };
  if (const ShapeForm moved = placed(form); moved.sound()) return FormOnto{moved};
  // Tilted until its foot is too steep: another point of it is not.
  constexpr int kPlaces = 8;
  for (int r = 0; r <= kPlaces; ++r)
    for (int c = 0; c <= kPlaces; ++c) {
      const auto about =
          form.aboutFootAt(c * (form.width - 1) / double{kPlaces}, r * (form.height - 1) / double{kPlaces});
      if (!about) continue;
      if (const ShapeForm moved = placed(*about); moved.sound()) return FormOnto{moved};
    }
  return std::nullopt;
}

}  // namespace

std::optional<FormOnto> formOnto(const NominalForm& form, const Grid& own, const RigidMotion& motion,
                                 const Grid& onto) {
  if (const ShapeForm* shape = form.shape()) return movedShape(*shape, own, motion, onto);
  const PolynomialForm& polynomial = *form.polynomial();
  if (tilts(motion)) return tilted(polynomial, own, motion, onto);
  PolynomialForm moved = movedPolynomial(polynomial, levelPlaces(own, motion, onto), onto.width, onto.height);
  const double unit = own.height_unit.mm / onto.height_unit.mm;
  for (double& coefficient : moved.coefficients) coefficient *= unit;
  moved.base = moved.base * unit + motion.shift.z / onto.height_unit.mm;
  return FormOnto{std::move(moved)};
}

}  // namespace fettle::engine
