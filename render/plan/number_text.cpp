#include "render/plan/number_text.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

namespace fettle::render {
namespace {

struct Metric {
  const char* shown;
  double mm;
};
constexpr std::array<Metric, 5> kMetric{
    {{"nm", 1e-6}, {"\u00b5m", 1e-3}, {"mm", 1.0}, {"m", 1e3}, {"km", 1e6}}};

std::string withMinus(std::string text) {
  if (!text.empty() && text.front() == '-') text.replace(0, 1, "\u2212");
  return text;
}

}  // namespace

double roundDown125(double value) {
  const double power = std::pow(10.0, std::floor(std::log10(value)));
  for (const double digit : {5.0, 2.0, 1.0})
    if (digit * power <= value * (1.0 + 1e-12)) return digit * power;
  return 0.5 * power;  // log10 was rounded up past an exact power
}

ShownUnit shownUnit(const engine::LengthUnit& unit, double size, double smallest, double largest) {
  const bool metric = unit.name == "mm" || unit.name == "m" || unit.name == "um" || unit.name == "nm" ||
                      unit.name == "km" || unit.name == "cm";
  const std::string own = unit.name == "um" ? "\u00b5m" : unit.name;
  if (!metric || !(size > 0.0) || !std::isfinite(size) || (size >= smallest && size < largest))
    return {own, 1.0};
  const Metric* best = &kMetric.front();
  for (const Metric& m : kMetric)
    if (size * unit.mm >= m.mm * 0.9999) best = &m;
  return {best->shown, unit.mm / best->mm};
}

FieldUnits fieldUnits(const engine::Grid& grid, double low, double high) {
  const double span = std::max(high - low, std::max(std::abs(low), std::abs(high)) * 1e-3);
  const double extent = std::max((grid.width - 1) * grid.spacing_x, (grid.height - 1) * grid.spacing_y);
  FieldUnits units{shownUnit(grid.height_unit, span, 0.05, 5e4),
                   shownUnit(grid.height_unit, span * 1e-3, 0.5, 5e4),
                   shownUnit(grid.lateral_unit, extent, 0.05, 5e4)};
  if (span > 0.0) units.height_step = 1e-4 * span * units.height.per_unit;
  return units;
}

ShownUnit deviationUnit(const engine::LengthUnit& unit, const ShownUnit& change, double size) {
  const double shown = size * change.per_unit;
  if (!(size > 0.0) || (shown >= 1e-3 && shown < 1e4)) return change;
  return shownUnit(unit, size, 0.05, 5e4);
}

ShownUnit ofMillimetres(const ShownUnit& shown, double mm) {
  return {shown.name, shown.per_unit / mm};
}

int decimalsFor(double step) {
  return std::clamp(static_cast<int>(std::ceil(-std::log10(step) - 1e-9)), 0, 12);
}

std::vector<Tick> ticks(double low, double high, int wanted) {
  std::vector<Tick> out;
  const double span = high - low;
  if (!(span > 0.0) || !std::isfinite(span)) return out;
  double step = roundDown125(span / std::max(1, wanted - 1));
  // Rounding down may give up to 2.5 times as many as requested.
  while (span / step > wanted + 1.0) step = roundDown125(step * 2.5);
  const int decimals = decimalsFor(step);
  const double first = std::ceil(low / step - 1e-6);
  for (double k = first; k * step <= high + 1e-6 * step && out.size() < 64; k += 1.0) {
    const double v = k * step == 0.0 ? 0.0 : k * step;
    const bool plain = std::abs(v) < 1e7 && step >= 1e-6;
    out.push_back({v, withMinus(plain ? fmt::format("{:.{}f}", v, decimals) : fmt::format("{:.4g}", v))});
  }
  return out;
}

std::string shortNumber(double value) {
  const double size = std::abs(value);
  if (size == 0.0) return "0";
  if (size < 1e-4 || size >= 1e6) return withMinus(fmt::format("{:.2e}", value));
  const int decimals = std::clamp(2 - static_cast<int>(std::floor(std::log10(size))), 0, 8);
  return withMinus(fmt::format("{:.{}f}", value, decimals));
}

}  // namespace fettle::render
