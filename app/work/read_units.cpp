#include "app/work/read_units.h"

#include <cmath>

#include "engine/io/import.h"

namespace fettle::app {

namespace {

// Powers of ten of a millimetre.
bool isMetric(double unit_mm) {
  const double power = std::log10(unit_mm);
  return std::abs(power - std::round(power)) < 1e-12;
}

}  // namespace

ReadAs readLengthAs(double length, double unit_mm, const std::string& unit) {
  if (!isMetric(unit_mm) || !(length > 0.0)) return {unit, 1.0};
  constexpr struct {
    const char* name;
    double mm;
  } kUnits[] = {{"m", 1e3}, {"mm", 1.0}, {"um", 1e-3}};
  for (const auto& each : kUnits)
    if (length * unit_mm >= each.mm) return {each.name, each.mm / unit_mm};
  return {"nm", 1e-6 / unit_mm};
}

ReadAs readAcrossAs(double spacing, double unit_mm, const std::string& unit) {
  const double spacing_mm = spacing * unit_mm;
  const double least_mm = spacing_mm < 1e-4 ? 1e-3 : spacing_mm < 10.0 ? 1.0 : 1e3;
  return readLengthAs(least_mm / unit_mm, unit_mm, unit);
}

ReadAs unitRead(const render::ShownUnit& shown) {
  return {shown.name == "\u00b5m" ? "um" : shown.name, 1.0 / shown.per_unit};
}

ReadAs readOnScreenAs(double length, double unit_mm, const std::string& unit) {
  return onScreen(readLengthAs(length, unit_mm, unit));
}

ReadAs onScreen(ReadAs as) {
  if (as.name == "um") as.name = "\u00b5m";
  return as;
}

std::optional<double> ratioOfUnits(const std::string& typed, const std::string& unit) {
  if (typed == unit) return 1.0;
  const auto from = engine::lengthUnitFromName(typed), to = engine::lengthUnitFromName(unit);
  if (!from || !to) return std::nullopt;
  return from->mm / to->mm;
}

}  // namespace fettle::app
