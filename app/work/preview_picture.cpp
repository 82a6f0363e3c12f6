#include "app/work/preview_picture.h"

#include <fmt/format.h>

#include "app/work/read_units.h"

namespace fettle::app {

std::string offText(double rms, bool estimated, const engine::Grid& grid) {
  const ReadAs as = readOnScreenAs(rms, grid.height_unit.mm, grid.height_unit.name);
  return fmt::format("approximate, off by {}{:.3g} {} rms", estimated ? "about " : "", rms / as.size,
                     as.name);
}

}  // namespace fettle::app
