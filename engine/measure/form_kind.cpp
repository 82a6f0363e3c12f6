#include "engine/measure/form_kind.h"

#include <algorithm>
#include <cstddef>
#include <iterator>

#include "engine/base/rows.h"

namespace fettle::engine {

namespace {

constexpr FormInfo kFormInfos[] = {
    {FormKind::kMean, "mean", "mean height", "the mean height", 0},
    {FormKind::kPlane, "plane", "plane", "a plane", 1},
    {FormKind::kPolynomial2, "poly2", "polynomial of degree 2", "a polynomial of total degree 2", 2},
    {FormKind::kPolynomial3, "poly3", "polynomial of degree 3", "of total degree 3", 3},
    {FormKind::kPolynomial4, "poly4", "polynomial of degree 4", "of total degree 4", 4},
    {FormKind::kPolynomial5, "poly5", "polynomial of degree 5", "of total degree 5", 5},
    {FormKind::kSphere, "sphere", "sphere", "a sphere", -1, ShapeKind::kSphere},
    {FormKind::kCylinder, "cylinder", "cylinder", "a circular cylinder, of any direction", -1,
     ShapeKind::kCylinder},
    {FormKind::kCone, "cone", "cone", "a circular cone", -1, ShapeKind::kCone},
};
static_assert(inOrder(kFormInfos, &FormInfo::kind, static_cast<FormKind>(std::size(kFormInfos))));

}  // namespace

std::span<const FormInfo> formInfos() noexcept {
  return kFormInfos;
}

const FormInfo& infoOf(FormKind kind) noexcept {
  return kFormInfos[static_cast<std::size_t>(kind)];
}

const FormInfo& infoOf(const NominalForm& form) noexcept {
  if (const PolynomialForm* polynomial = form.polynomial())
    return *std::ranges::find(kFormInfos, polynomial->degree, &FormInfo::degree);
  switch (form.shape()->shape) {
    case FormShape::kSphere:
      return infoOf(FormKind::kSphere);
    case FormShape::kCylinder:
      return infoOf(FormKind::kCylinder);
    case FormShape::kCone:
      break;
  }
  return infoOf(FormKind::kCone);
}

const FormInfo* formNamed(std::string_view word) noexcept {
  const auto* found = std::ranges::find(kFormInfos, word, &FormInfo::word);
  return found == std::end(kFormInfos) ? nullptr : found;
}

}  // namespace fettle::engine
