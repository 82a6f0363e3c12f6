#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace fettle::app {

/// A number as a person types it, and what stands behind it.
struct TypedNumber {
  double number = 0.0;
  std::string unit;  ///< without blanks around it; may be empty
};

/// Blanks and a plus sign before it, and a comma in place of the point where there is no point. Nothing where the text begins
/// with no finite number, or with one that reads in two ways: "1,234.5".
[[nodiscard]] std::optional<TypedNumber> readTypedNumber(std::string_view text);

/// The same of a length, in `unit` where no unit is typed. Nothing where the typed one is none, or not known.
[[nodiscard]] std::optional<double> readTypedLength(std::string_view text, const std::string& unit);

}  // namespace fettle::app
