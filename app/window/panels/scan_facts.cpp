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

// To four digits and without an exponent: readAs() leaves lengths of up to 5e4 in their unit.
std::string plainNumber(double value) {
  return std::abs(value) < 9999.5 ? fmt::format("{:.4g}", value) : fmt::format("{:.0f}", value);
}

}  // namespace

std::string sizeText(const ScanThumbnail& picture) {
  if (!picture.grid) return {};
  return trFormat("{} x {} samples", picture.grid->width, picture.grid->height);
}

std::string extentText(const ScanThumbnail& picture) {
  if (!picture.grid) return {};
  const engine::Grid& grid = *picture.grid;
  const double across = grid.width * grid.spacing_x, up = grid.height * grid.spacing_y;
  const ReadAs whole = readAs(std::max(across, up), grid.lateral_unit);
  const ReadAs apart = readAs(std::max(grid.spacing_x, grid.spacing_y), grid.lateral_unit);
  return trFormat("{} x {} {}, {:.4g} x {:.4g} {} apart", plainNumber(across / whole.size),
                  plainNumber(up / whole.size), whole.name, grid.spacing_x / apart.size,
                  grid.spacing_y / apart.size, apart.name);
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
  const double longest = std::max(grid.width * grid.spacing_x, grid.height * grid.spacing_y);
  const ReadAs across = readAs(longest, grid.lateral_unit);
  const std::string place = fmt::format("x {:.4g}  y {:.4g} {}", cursor.column * grid.spacing_x / across.size,
                                        cursor.row * grid.spacing_y / across.size, across.name);
  if (!std::isfinite(cursor.height)) return fmt::format("{}  {}", place, tr("hole"));
  const auto height = static_cast<double>(cursor.height);
  const ReadAs up = readAs(std::abs(height), grid.height_unit);
  return fmt::format("{}  z {:.4g} {}", place, height / up.size, up.name);
}

}  // namespace fettle::app
