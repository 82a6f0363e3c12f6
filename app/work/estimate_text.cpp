#include "app/work/estimate_text.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

namespace fettle::app {

std::string shownNumber(const Report& value) {
  return value.is_null() ? "-" : fmt::format("{:.6g}", value.get<double>() + 0.0);  // no -0
}

std::string shownTo(double value, double error) {
  if (!(error > 0.0) || !std::isfinite(error) || value == 0.0) return fmt::format("{:.6g}", value + 0.0);
  // Below the last digit of the error, which has two.
  if (std::abs(value) < 0.05 * std::pow(10.0, std::floor(std::log10(error)))) return "0";
  const double digits = std::floor(std::log10(std::abs(value))) - std::floor(std::log10(error)) + 2.0;
  return fmt::format("{:.{}g}", value, static_cast<int>(std::clamp(digits, 2.0, 12.0)));
}

std::string shownEstimate(const Report& report, const std::string& key, const std::string& unit,
                          const ReadAs& as) {
  const std::string ending = unit.empty() ? std::string() : fmt::format("_{}", unit);
  const Report& error = report[key + "_error" + ending];
  const Report& value = report[key + ending];
  if (value.is_null()) return unit == "deg" ? "- (known to 90 degrees or worse)" : "-";
  const double shown = value.get<double>() / as.size;
  if (error.is_null()) return fmt::format("{:.6g} {}", shown, as.name);
  const double shown_error = error.get<double>() / as.size;
  return fmt::format("{} +- {:.2g} {}", shownTo(shown, shown_error), shown_error, as.name);
}

}  // namespace fettle::app
