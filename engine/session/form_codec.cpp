#include "engine/session/form_codec.h"

#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <utility>

#include "engine/io/files/little_endian.h"

namespace fettle::engine {

namespace {

double formNumber(std::string_view bytes, std::size_t index) noexcept {
  std::uint64_t value = 0;
  for (std::size_t i = 0; i < 8; ++i)
    value |= std::uint64_t{static_cast<std::uint8_t>(bytes[1 + 8 * index + i])} << (8 * i);
  return std::bit_cast<double>(value);
}

}  // namespace

std::string packForm(const FieldForm& form) {
  std::string out;
  if (form == nullptr) return out;
  appendLittle(out, static_cast<std::uint8_t>(form->degree));
  appendLittle(out, form->base);
  for (const double coefficient : form->coefficients) appendLittle(out, coefficient);
  return out;
}

std::optional<FieldForm> unpackForm(std::string_view bytes, const Grid& grid) {
  if (bytes.empty()) return FieldForm();
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
  return std::make_shared<const PolynomialForm>(std::move(form));
}

}  // namespace fettle::engine
