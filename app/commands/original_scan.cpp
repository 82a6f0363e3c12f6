#include "app/commands/original_scan.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "app/commands/recipe_file.h"
#include "app/commands/scan_files.h"
#include "app/work/open_document.h"
#include "engine/field/seen_field.h"
#include "engine/session/stored_tiles.h"

namespace fettle::app {

void addOriginalOption(Command command, std::string& original) {
  command.add({{.name = "--original",
                .to = &original,
                .text = "The original scan, from which the limit of change counts",
                .kind = ValueKind::kInput,
                .otherwise = "what is read, or the original of a session"}});
}

namespace {

// Whether files of a format store the position of samples.
bool keepsPlace(const engine::Imported& scan) {
  return scan.format != "PNG" && scan.format != "STL";
}

// Difference of two numbers. A format that loses the unit keeps the number: then the numbers must agree.
double apart(double a, double b, const engine::Grid& of_a, const engine::Grid& of_b) {
  return std::min(std::abs(a - b),
                  std::abs(a * of_a.lateral_unit.mm - b * of_b.lateral_unit.mm) / of_b.lateral_unit.mm);
}

// Whether two grids of the same sides have every sample at the same position, except for the rounding of a
// format.
engine::Status checkSamePlace(const engine::Grid& original, const engine::Grid& scan,
                              const std::string& where) {
  constexpr double kPartOfSample = 0.05;
  constexpr const char* kRemedy = "give the scan that this one was made from";
  const auto refused = [&](const char* what, double ax, double ay, double bx, double by) {
    return engine::inputError(
        fmt::format(
            "the {} of the original is {:.10g} x {:.10g} {} and that of the scan {:.10g} x {:.10g} {}", what,
            ax, ay, original.lateral_unit.name, bx, by, scan.lateral_unit.name),
        where, kRemedy);
  };
  // At the far side, where an error of the spacing is largest.
  if (apart(original.spacing_x, scan.spacing_x, original, scan) * scan.width >
          kPartOfSample * scan.spacing_x ||
      apart(original.spacing_y, scan.spacing_y, original, scan) * scan.height >
          kPartOfSample * scan.spacing_y)
    return refused("spacing", original.spacing_x, original.spacing_y, scan.spacing_x, scan.spacing_y);
  if (apart(original.origin_x, scan.origin_x, original, scan) > kPartOfSample * scan.spacing_x ||
      apart(original.origin_y, scan.origin_y, original, scan) > kPartOfSample * scan.spacing_y)
    return refused("origin", original.origin_x, original.origin_y, scan.origin_x, scan.origin_y);
  return {};
}

}  // namespace

engine::Result<engine::Version> originalOf(const engine::Imported& imported, const std::string& given,
                                           const ScanOptions& reading, engine::JobControl& job) {
  if (given.empty()) return imported.original.value_or(imported.field);
  if (imported.original)
    return engine::inputError("a session has its own original", given, "omit --original");
  const auto other = loadScan(given, reading, job);
  if (!other) return tl::unexpected(other.error());
  const engine::Version& original = other->original.value_or(other->field);
  const engine::Grid &is = original.grid(), &wanted = imported.field.grid();
  if (is.width != wanted.width || is.height != wanted.height)
    return engine::inputError(fmt::format("the original has {} x {} samples and the scan {} x {}", is.width,
                                          is.height, wanted.width, wanted.height),
                              given, "give the scan that this one was made from");
  if (!(is.height_unit == wanted.height_unit))
    return engine::inputError(fmt::format("heights of the original are in {} and those of the scan in {}",
                                          is.height_unit.name, wanted.height_unit.name),
                              given, "convert one of them, or give --unit where a file states none");
  if (keepsPlace(*other) && keepsPlace(imported))
    if (auto same = checkSamePlace(is, wanted, given); !same) return tl::unexpected(same.error());
  return engine::seenLike(original.withGrid(wanted), imported.field, job);
}

bool isWorkedOn(const engine::Imported& imported) {
  // The form is a step that the recipe may name.
  if (imported.field.seenOf() != nullptr && !putsForm(imported.recipe)) return true;
  if (!imported.original) return false;
  // In Python a field may have come from one of another size.
  const engine::Grid &before = imported.original->grid(), &now = imported.field.grid();
  if (before.width != now.width || before.height != now.height) return true;
  return (imported.original->lines() != imported.field.lines() ||
          !engine::tilesThatDiffer(*imported.original, imported.field).empty());
}

engine::Status checkOriginal(const std::string& given, bool limited, const std::string& out) {
  if (given.empty() || limited || isSessionPath(out)) return {};
  return engine::inputError("the original is the reference of a limit of change, and there is no limit",
                            "--original", "give --max-change, or a scene with max_change, or omit it");
}

}  // namespace fettle::app
