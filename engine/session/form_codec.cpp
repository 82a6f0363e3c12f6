#include "engine/session/form_codec.h"

#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <utility>

#include "engine/field/nominal_form.h"
#include "engine/io/files/little_endian.h"

namespace fettle::engine {

namespace {

double formNumber(std::string_view bytes, std::size_t index) noexcept {
  std::uint64_t value = 0;
  for (std::size_t i = 0; i < 8; ++i)
    value |= std::uint64_t{static_cast<std::uint8_t>(bytes[1 + 8 * index + i])} << (8 * i);
  return std::bit_cast<double>(value);
}

constexpr int kFirstShape = 16;

// The numbers of a shape in their order.
std::array<double*, 13> numbersOf(ShapeForm& form) noexcept {
  return {&form.column,       &form.row,          &form.base,     &form.normal.x, &form.normal.y,
          &form.normal.z,     &form.axis.x,       &form.axis.y,   &form.axis.z,   &form.curvature,
          &form.spacing_x_mm, &form.spacing_y_mm, &form.height_mm};
}

std::optional<FieldForm> unpackShape(std::string_view bytes, const Grid& grid) {
  const int shape = static_cast<std::uint8_t>(bytes[0]) - kFirstShape;
  ShapeForm form;
  const auto numbers = numbersOf(form);
  if (shape > static_cast<int>(FormShape::kCone) || bytes.size() != 1 + 8 * numbers.size())
    return std::nullopt;
  form.shape = static_cast<FormShape>(shape);
  form.width = grid.width;
  form.height = grid.height;
  for (std::size_t k = 0; k < numbers.size(); ++k) *numbers[k] = formNumber(bytes, k);
  if (!form.sound()) return std::nullopt;
  return std::make_shared<const NominalForm>(form);
}

}  // namespace

std::string packForm(const FieldForm& form) {
  std::string out;
  if (form == nullptr) return out;
  if (const ShapeForm* shape = form->shape()) {
    ShapeForm packed = *shape;
    appendLittle(out, static_cast<std::uint8_t>(kFirstShape + static_cast<int>(packed.shape)));
    for (const double* number : numbersOf(packed)) appendLittle(out, *number);
    return out;
  }
  const PolynomialForm& polynomial = *form->polynomial();
  appendLittle(out, static_cast<std::uint8_t>(polynomial.degree));
  appendLittle(out, polynomial.base);
  for (const double coefficient : polynomial.coefficients) appendLittle(out, coefficient);
  return out;
}

bool isPackedShape(std::string_view bytes) noexcept {
  return !bytes.empty() && static_cast<std::uint8_t>(bytes[0]) >= kFirstShape;
}

std::optional<FieldForm> unpackForm(std::string_view bytes, const Grid& grid) {
  if (bytes.empty()) return FieldForm();
  if (isPackedShape(bytes)) return unpackShape(bytes, grid);
  const int degree = static_cast<std::uint8_t>(bytes[0]);
  if (degree > PolynomialForm::kMostDegree) return std::nullopt;
  const auto terms = static_cast<std::size_t>(PolynomialForm::terms(degree));
  if (bytes.size() != 1 + 8 * (1 + terms)) return std::nullopt;
  PolynomialForm form{degree, grid.width, grid.height, formNumber(bytes, 0), {}};
  form.coefficients.reserve(terms);
  for (std::size_t k = 1; k <= terms; ++k) form.coefficients.push_back(formNumber(bytes, k));
  // Their sum stays far within the range of double.
  constexpr double kMostNumber = std::numeric_limits<float>::max();
  bool good = std::abs(form.base) <= kMostNumber;
  for (const double coefficient : form.coefficients) good = good && std::abs(coefficient) <= kMostNumber;
  if (!good) return std::nullopt;
  return std::make_shared<const NominalForm>(std::move(form));
}

}  // namespace fettle::engine
