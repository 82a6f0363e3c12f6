#include "app/commands/nominal_option.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "app/terminal.h"
#include "app/work/outputs.h"
#include "app/work/streams.h"
#include "engine/io/files/input_file.h"
#include "engine/io/import.h"

namespace fettle::app {

namespace {

constexpr const char* kNominalExtension = ".stl";
constexpr const char* kEitherExtension = ".ply";  // a scan, or a nominal mesh

// A wrong unit is off by 10 and more; 25.4 is inches taken for millimetres.
void warnOfSize(const engine::NominalMesh& nominal, const engine::Grid& part, const std::string& name,
                const std::string& unit) {
  constexpr double kApart = 20.0;
  const glm::dvec3 size = nominal.box().high - nominal.box().low;
  const double mesh = std::max(size.x, size.y),
               scan = std::max((part.width - 1) * part.spacingXMm(), (part.height - 1) * part.spacingYMm());
  if (!(mesh > 0.0 && scan > 0.0) || std::max(mesh / scan, scan / mesh) < kApart) return;
  warn(
      fmt::format("{}: the nominal is {:.4g} mm wide, the part {:.4g} mm: are its numbers {}? --nominal-unit "
                  "says what they are",
                  name, mesh, scan, unit));
}

}  // namespace

void addNominalOptions(Command command, NominalArguments& arguments) {
  command.add({{.name = "--nominal-unit",
                .to = &arguments.unit,
                .text = fmt::format(
                    "Unit of the numbers of a nominal mesh B; with it a .ply is one, and not a scan: {}",
                    fmt::join(engine::lengthUnitNames(), ", ")),
                .proposed = engine::lengthUnitNames(),
                .otherwise = "as an .stl says, else mm"}},
              "A nominal mesh as B");
}

bool isNominal(const std::string& path, const ScanOptions& reading, const NominalArguments& arguments) {
  const std::string extension = isStream(path) ? withDot(reading.from) : engine::extensionOf(path);
  return extension == kNominalExtension || (extension == kEitherExtension && !arguments.unit.empty());
}

engine::Result<engine::NominalFile> loadNominal(const std::string& path, const NominalArguments& arguments,
                                                const std::string& from, const engine::Grid& part,
                                                Sides sides, engine::JobControl& job) {
  std::optional<engine::LengthUnit> unit;
  if (!arguments.unit.empty()) {
    const auto named = engine::lengthUnitFromName(arguments.unit);
    if (!named)
      return engine::inputError(fmt::format("unknown unit {}", arguments.unit), "--nominal-unit",
                                fmt::format("take one of {}", fmt::join(engine::lengthUnitNames(), ", ")));
    unit = named;
  }
  auto read = [&]() -> engine::Result<engine::NominalFile> {
    if (!isStream(path)) return engine::readNominal(path, unit, job);
    const auto input = StandardInput::read(withDot(from), job);
    if (!input) return tl::unexpected(input.error());
    auto piped = engine::readNominal(input->path(), unit, job);
    if (!piped) return tl::unexpected(input->renamed(piped.error()));
    return piped;
  }();
  if (!read) return read;
  const engine::NominalMesh* const nominal = &read->mesh;
  const std::string name = shownInput(path);
  if (nominal->withoutArea() > 0)
    warn(fmt::format("{}: {} triangles without an area were left out", name, nominal->withoutArea()));
  if (sides == Sides::kNeeded && nominal->oddSides() > 0)
    warn(
        fmt::format("{}: at {} sides its triangles are wound in opposite senses or are more than two: near "
                    "those the side on which a "
                    "sample lies may be wrong",
                    name, nominal->oddSides()));
  warnOfSize(*nominal, part, name, read->unit.name);
  return read;
}

Report nominalReport(const engine::NominalFile& nominal) {
  return {{"triangles", nominal.mesh.triangles().size()},
          {"unit", nominal.unit.name},
          {"open_sides", nominal.mesh.openSides()}};
}

}  // namespace fettle::app
