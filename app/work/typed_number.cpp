#include "app/work/typed_number.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <system_error>

#include "app/work/read_units.h"

namespace fettle::app {

std::optional<TypedNumber> readTypedNumber(std::string_view text) {
  text.remove_prefix(std::min(text.find_first_not_of(" +"), text.size()));
  std::string number(text);
  if (const std::size_t comma = number.find(','); comma != std::string::npos) {
    if (number.find_first_of(".,", comma + 1) != std::string::npos ||
        number.rfind('.', comma) != std::string::npos)
      return std::nullopt;
    number[comma] = '.';
  }
  TypedNumber typed;
  const char* const end = number.data() + number.size();
  const auto read = std::from_chars(number.data(), end, typed.number);
  if (read.ec != std::errc() || !std::isfinite(typed.number)) return std::nullopt;
  typed.unit = std::string(read.ptr, end);
  typed.unit.erase(0, typed.unit.find_first_not_of(' '));
  typed.unit.erase(typed.unit.find_last_not_of(' ') + 1);
  return typed;
}

std::optional<double> readTypedLength(std::string_view text, const std::string& unit) {
  const auto typed = readTypedNumber(text);
  if (!typed) return std::nullopt;
  const auto ratio = ratioOfUnits(typed->unit.empty() ? unit : typed->unit, unit);
  if (!ratio) return std::nullopt;
  return typed->number * *ratio;
}

}  // namespace fettle::app
