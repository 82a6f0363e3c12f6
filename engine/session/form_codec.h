#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "engine/field/grid.h"
#include "engine/field/version.h"

namespace fettle::engine {

/// A form as bytes, every bit of every number kept: its degree (a byte), the height beside its terms and the terms'
/// coefficients in the order of PolynomialForm, binary64. Little-endian. No form: no bytes.
[[nodiscard]] std::string packForm(const FieldForm& form);

/// The form over a field of this grid. Empty for bytes that packForm() does not make: too few or too many, a degree
/// beyond PolynomialForm::kMostDegree, a number beyond the range of float.
[[nodiscard]] std::optional<FieldForm> unpackForm(std::string_view bytes, const Grid& grid);

}  // namespace fettle::engine
