#include "engine/io/units.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

#include "engine/base/lower_case.h"

namespace fettle::engine {

namespace {

struct KnownUnit {
  const char* name;
  double mm;
  std::array<std::string_view, 8> spellings;  // lower case
};

// The US survey foot is 1200 / 3937 m exactly; the division rounds once.
const std::array<KnownUnit, 9> kUnits{{
    {"nm", 1e-6, {"nm", "nanometre", "nanometer", "nanometres", "nanometers"}},
    {"um",
     1e-3,
     {"um", "\xc2\xb5m", "\xce\xbcm", "micrometre", "micrometer", "micrometres", "micrometers", "micron"}},
    {"mm", 1.0, {"mm", "millimetre", "millimeter", "millimetres", "millimeters"}},
    {"cm", 10.0, {"cm", "centimetre", "centimeter", "centimetres", "centimeters"}},
    {"m", 1000.0, {"m", "metre", "meter", "metres", "meters"}},
    {"km", 1e6, {"km", "kilometre", "kilometer", "kilometres", "kilometers"}},
    {"in", 25.4, {"in", "inch", "inches"}},
    {"ft", 304.8, {"ft", "foot", "feet", "international foot", "foot (international)"}},
    {"ftUS",
     1200000.0 / 3937.0,
     {"ftus", "us survey foot", "us-ft", "foot_us", "us survey feet", "us foot", "ft us"}},
}};

using namespace std::string_view_literals;

// Lower case.
constexpr std::array kNoLengths{
    "intensity"sv, "amplitude"sv, "brightness"sv, "luminance"sv,  "reflectance"sv, "reflectivity"sv,
    "albedo"sv,    "gray"sv,      "grey"sv,       "confidence"sv, "quality"sv,     "dn"sv,
    "adu"sv,       "count"sv,     "counts"sv,     "a.u."sv,       "au"sv,          "1"sv,
    "unitless"sv,  "%"sv,         "percent"sv,    "db"sv,         "v"sv,           "mv"sv,
    "volt"sv,      "volts"sv,     "deg"sv,        "degree"sv,     "degrees"sv,     "\xc2\xb0"sv,
    "rad"sv,       "radian"sv,    "radians"sv,    "k"sv,          "kelvin"sv,      "degc"sv,
    "celsius"sv,   "s"sv,         "hz"sv};

// Defaults for what neither the file nor the user states. Heights share the lateral unit unless the file
// states another; resolution tags state lengths without a unit.
void warnOfGuesses(const StatedUnits& file, const ImportOptions& options, bool spacing_known,
                   const std::string& taken, std::vector<std::string>& warnings) {
  const bool no_unit = !options.unit && !file.lateral;
  const char* missing = file.height ? "lateral unit" : file.spacing_mm ? "height unit" : "unit";
  if (no_unit && !spacing_known)
    warnings.push_back(fmt::format(
        "the file states no {} and no spacing, {} and 1 {} are assumed: give them with --unit and --spacing",
        missing, taken, taken));
  else if (no_unit && !(file.height && file.spacing_mm))
    warnings.push_back(
        fmt::format("the file states no {}, {} is assumed: give it with --unit", missing, taken));
  else if (!spacing_known)
    warnings.push_back(
        fmt::format("the file states no spacing, 1 {} is assumed: give it with --spacing", taken));
}

}  // namespace

std::optional<LengthUnit> lengthUnitFromName(std::string_view name) {
  if (name.empty()) return std::nullopt;
  const std::string lower = lowerCase(name);
  for (const KnownUnit& unit : kUnits)
    for (const std::string_view spelling : unit.spellings)
      if (spelling == lower) return LengthUnit{unit.name, unit.mm};
  return std::nullopt;
}

std::vector<std::string> lengthUnitNames() {
  std::vector<std::string> names;
  names.reserve(kUnits.size());
  for (const KnownUnit& unit : kUnits) names.emplace_back(unit.name);
  return names;
}

LengthUnit lengthUnitFromMetres(double metres, std::string_view name) {
  // Files write the survey foot with 10 to 16 digits; it and the foot differ by 2e-6.
  for (const KnownUnit& unit : kUnits)
    if (std::abs(metres * 1000.0 / unit.mm - 1.0) < 1e-8) return {unit.name, unit.mm};
  return {std::string(name.empty() ? "unit" : name), metres * 1000.0};
}

bool isNoLength(std::string_view name) {
  return std::ranges::find(kNoLengths, lowerCase(name)) != kNoLengths.end();
}

std::optional<LengthUnit> heightUnitNamed(std::string_view name, const ImportOptions& options,
                                          std::vector<std::string>& warnings) {
  if (name.empty()) return std::nullopt;
  if (auto unit = lengthUnitFromName(name)) return unit;
  if (isNoLength(name)) {
    if (!options.unit)
      warnings.push_back(
          fmt::format("the file's samples are in \"{}\", which is not a length: are these heights?", name));
    return LengthUnit{std::string(name), 1.0};
  }
  if (!options.unit)
    warnings.push_back(fmt::format("the height unit \"{}\" is not known, give --unit", name));
  return std::nullopt;
}

std::optional<LengthUnit> lengthUnitFromComment(std::string_view comment) {
  const std::string lower = lowerCase(comment);
  for (std::size_t at = lower.find("unit"); at != std::string::npos; at = lower.find("unit", at + 1)) {
    std::size_t begin = at + 4;
    if (std::string_view(lower).substr(begin).starts_with('s')) ++begin;
    const std::size_t word = lower.find_first_not_of(" \t:=", begin);
    if (word == std::string::npos || word == begin) continue;
    const std::size_t end = lower.find_first_of(" \t,;)]\r\n", word);
    if (auto unit = lengthUnitFromName(lower.substr(word, end == std::string::npos ? end : end - word)))
      return unit;
  }
  return std::nullopt;
}

void determineUnits(Grid& grid, const StatedUnits& file, const ImportOptions& options,
                    std::vector<std::string>& warnings) {
  grid.lateral_unit = options.unit ? *options.unit : file.lateral.value_or(LengthUnit{});
  if (options.unit)
    grid.height_unit = *options.unit;
  else if (file.height)
    grid.height_unit = *file.height;
  else
    grid.height_unit = grid.lateral_unit.name == "deg" ? LengthUnit{"m", 1000.0} : grid.lateral_unit;
  if (options.unit &&
      ((file.lateral && *file.lateral != *options.unit) || (file.height && *file.height != *options.unit)))
    warnings.push_back(fmt::format("the file states {}, read as {} as requested",
                                   (file.lateral ? file.lateral : file.height)->name, options.unit->name));

  bool known = file.spacing || file.spacing_mm;
  std::pair<double, double> spacing{1.0, 1.0};
  if (file.spacing)
    spacing = *file.spacing;
  else if (file.spacing_mm)
    spacing = {file.spacing_mm->first / grid.lateral_unit.mm, file.spacing_mm->second / grid.lateral_unit.mm};
  if (options.spacing) {
    if (known && spacing != *options.spacing)
      warnings.push_back(fmt::format("the file states spacing {} x {}, read as {} x {} as requested",
                                     spacing.first, spacing.second, options.spacing->first,
                                     options.spacing->second));
    spacing = *options.spacing;
    known = true;
  }
  warnOfGuesses(file, options, known, grid.lateral_unit.name, warnings);
  grid.spacing_x = spacing.first;
  grid.spacing_y = spacing.second;
}

}  // namespace fettle::engine
