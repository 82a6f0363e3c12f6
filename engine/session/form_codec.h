#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "engine/field/grid.h"
#include "engine/field/version.h"

namespace fettle::engine {

/// A form as bytes, every bit of every number kept. A polynomial: its degree (a byte), the height beside its terms and the
/// terms' coefficients in the order of PolynomialForm, binary64. A shape: 16 more than its FormShape (a byte), then the
/// numbers of ShapeForm in their order from column on, binary64. Little-endian. No form: no bytes.
[[nodiscard]] std::string packForm(const FieldForm& form);

/// Whether the bytes are those of a shape, which programs that know only polynomials cannot read.
[[nodiscard]] bool isPackedShape(std::string_view bytes) noexcept;

/// The form over a field of this grid. Empty for bytes that packForm() does not make: too few or too many, a degree
/// beyond PolynomialForm::kMostDegree, an unknown shape, a number beyond the range of float, a shape that is not sound().
[[nodiscard]] std::optional<FieldForm> unpackForm(std::string_view bytes, const Grid& grid);

}  // namespace fettle::engine
