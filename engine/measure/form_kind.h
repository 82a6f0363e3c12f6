#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

#include "engine/field/nominal_form.h"
#include "engine/measure/fit_shape.h"

namespace fettle::engine {

/// The forms that are taken out of a surface.
enum class FormKind : std::uint8_t {
  kMean,
  kPlane,
  kPolynomial2,
  kPolynomial3,
  kPolynomial4,
  kPolynomial5,
  kSphere,
  kCylinder,
  kCone,
};

struct FormInfo {
  FormKind kind;
  std::string_view word;   ///< of commands, recipes and journals
  std::string_view title;  ///< of steps and panels
  std::string_view text;   ///< in a list that begins with the mean height
  int degree = -1;         ///< of a polynomial
  std::optional<ShapeKind> shape = {};
};
/// A row for each, in the order of FormKind.
[[nodiscard]] std::span<const FormInfo> formInfos() noexcept;
[[nodiscard]] const FormInfo& infoOf(FormKind kind) noexcept;
[[nodiscard]] const FormInfo& infoOf(const NominalForm& form) noexcept;
/// Null for another word.
[[nodiscard]] const FormInfo* formNamed(std::string_view word) noexcept;

}  // namespace fettle::engine
