#include "app/work/typed_lengths.h"

#include <charconv>
#include <cmath>
#include <system_error>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "engine/io/import.h"

namespace fettle::app {

std::optional<TypedLength> typedLengthOf(std::string_view text) {
  TypedLength typed;
  const char* const last = text.data() + text.size();
  const auto [end, error] = std::from_chars(text.data(), last, typed.value);
  if (error != std::errc() || !std::isfinite(typed.value)) return std::nullopt;
  std::string_view unit(end, static_cast<std::size_t>(last - end));
  while (unit.starts_with(' ')) unit.remove_prefix(1);
  typed.unit = unit;
  if (unit.empty()) return typed;
  if (const auto known = engine::lengthUnitFromName(unit)) typed.unit_mm = known->mm;
  return typed;
}

std::string lengthProblem(std::string_view text) {
  const auto typed = typedLengthOf(text);
  if (!typed) return fmt::format("{} is not a length", text);
  if (typed->unit.empty() || typed->unit_mm) return "";
  return fmt::format("unknown unit {}: take one of {}", typed->unit,
                     fmt::join(engine::lengthUnitNames(), ", "));
}

std::vector<double> lengthsOf(std::string_view text, std::size_t count, double plain_mm) {
  std::vector<double> lengths;
  lengths.reserve(count);
  for (std::size_t k = 0; k < count; ++k) {
    const std::size_t end = k + 1 < count ? text.find(',') : text.size();
    if (end == std::string_view::npos) return {};
    const auto typed = typedLengthOf(text.substr(0, end));
    if (!typed || (!typed->unit.empty() && !typed->unit_mm)) return {};
    lengths.push_back(typed->unit_mm ? typed->value * (*typed->unit_mm / plain_mm) : typed->value);
    text.remove_prefix(k + 1 < count ? end + 1 : end);
  }
  return lengths;
}

}  // namespace fettle::app
