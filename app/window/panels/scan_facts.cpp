#include "app/window/panels/scan_facts.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "app/texts/texts.h"
#include "app/work/read_units.h"
#include "render/plan/number_text.h"

namespace fettle::app {
namespace {

// As the window of an open scan has it: the scan's own unit where numbers are readable in it.
ReadAs readAs(double length, const engine::LengthUnit& unit) {
  const render::ShownUnit shown = render::shownUnit(unit, length, 0.05, 5e4);
  return {shown.name, 1.0 / shown.per_unit};
}

// Lengths across a field, that between two samples too.
ReadAs readAcross(const engine::Grid& grid) {
  const render::ShownUnit shown = render::fieldUnits(grid, 0.0, 1.0).length;
  return {shown.name, 1.0 / shown.per_unit};
}

// To four digits and without an exponent: readAs() leaves lengths of up to 5e4 in their unit.
std::string plainNumber(double value) {
  return std::abs(value) < 9999.5 ? fmt::format("{:.4g}", value) : fmt::format("{:.0f}", value);
}

}  // namespace

std::string sizeText(const ScanThumbnail& picture) {
  if (!picture.grid) return {};
  return trFormat("{} x {} samples", picture.grid->width, picture.grid->height);
}

std::string spacingText(const engine::Grid& grid) {
  const ReadAs as = readAcross(grid);
  return fmt::format("{:.4g} x {:.4g} {}", grid.spacing_x / as.size, grid.spacing_y / as.size, as.name);
}

std::string extentText(const ScanThumbnail& picture) {
  if (!picture.grid) return {};
  const engine::Grid& grid = *picture.grid;
  const ReadAs as = readAcross(grid);
  return trFormat("{} x {} {}, {} apart", plainNumber(grid.width * grid.spacing_x / as.size),
                  plainNumber(grid.height * grid.spacing_y / as.size), as.name, spacingText(grid));
}

std::string heightsText(const ScanThumbnail& picture) {
  if (picture.empty() || !picture.grid) return {};
  const engine::LengthUnit& unit = picture.grid->height_unit;
  const double low = static_cast<double>(picture.lowest), high = static_cast<double>(picture.highest);
  const ReadAs as = readAs(std::max(std::abs(low), std::abs(high)), unit);
  return picture.whole ? trFormat("heights {} to {} {}", plainNumber(low / as.size),
                                  plainNumber(high / as.size), as.name)
                       : trFormat("heights about {} to {} {}", plainNumber(low / as.size),
                                  plainNumber(high / as.size), as.name);
}

std::string cursorText(const ScanThumbnail& picture, const PictureCursor& cursor) {
  const engine::Grid& grid = *picture.grid;
  const ReadAs across = readAcross(grid);
  const std::string place = fmt::format("x {:.4g}  y {:.4g} {}", cursor.column * grid.spacing_x / across.size,
                                        cursor.row * grid.spacing_y / across.size, across.name);
  if (!std::isfinite(cursor.height)) return fmt::format("{}  {}", place, tr("hole"));
  const auto height = static_cast<double>(cursor.height);
  const ReadAs up = readAs(std::abs(height), grid.height_unit);
  return fmt::format("{}  z {:.4g} {}", place, height / up.size, up.name);
}

}  // namespace fettle::app
