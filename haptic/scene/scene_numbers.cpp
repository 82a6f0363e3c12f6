#include "haptic/scene/scene_numbers.h"

#include <algorithm>

#include <fmt/format.h>

namespace fettle::haptic {

std::string rangeText(const SceneNumber& number) {
  const std::string unit = number.unit.empty() ? "" : fmt::format(" {}", number.unit);
  if (number.kind == NumberKind::kWhole)
    return fmt::format("a whole number from {} to {}{}", number.low, number.high, unit);
  return number.low_end == LowEnd::kExcluded
             ? fmt::format("above {}, at most {}{}", number.low, number.high, unit)
             : fmt::format("{} to {}{}", number.low, number.high, unit);
}

std::string rangeProblem(const SceneNumber& number) {
  const std::string where = number.table.empty() ? "" : fmt::format(" in [{}]", number.table);
  return fmt::format("{}{} must be {}", number.key, where, rangeText(number));
}

std::optional<double> nearestInRange(const SceneNumber& number, double value) noexcept {
  if (std::isnan(value)) return std::nullopt;
  const double whole = number.kind == NumberKind::kWhole ? std::round(value) : value;
  const double nearest = std::clamp(whole, number.low, number.high);
  return number.holds(nearest) ? std::optional(nearest) : std::nullopt;
}

}  // namespace fettle::haptic
