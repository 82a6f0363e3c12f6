#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace fettle::app {

// Lengths and places as they are typed in options, recipes and Python: a number, with or without a unit of engine::lengthUnitNames()
// behind it. All of them are read here.

struct TypedLength {
  double value = 0.0;             ///< finite
  std::string unit = {};          ///< as typed; empty: none
  std::optional<double> unit_mm;  ///< of a unit that is known
};
/// "0.5", "20um", "-3 mm"; nothing where it begins with no finite number.
[[nodiscard]] std::optional<TypedLength> typedLengthOf(std::string_view text);

/// What is wrong with a length as typed, "7q is not a length", or an empty text.
[[nodiscard]] std::string lengthProblem(std::string_view text);

/// Exactly `count` lengths between commas, as "12.5mm,3mm": in units of `plain_mm` millimetres, the unit of numbers without one, which are
/// returned bit for bit. Empty where the text is not that.
[[nodiscard]] std::vector<double> lengthsOf(std::string_view text, std::size_t count, double plain_mm = 1.0);

}  // namespace fettle::app
