#include "app/work/preview_picture.h"

#include <algorithm>

#include <fmt/format.h>

#include "app/texts/texts.h"
#include "app/work/read_units.h"

namespace fettle::app {

std::string soFarText(const SoFar& so_far) {
  const auto percent = [](double share) { return static_cast<int>(100.0 * share); };
  if (!so_far.approximate)
    return so_far.exact == 1.0 ? tr("exact in view") : trFormat("{} % so far", percent(so_far.exact));
  std::string text = so_far.off.empty() ? tr("approximate") : so_far.off;
  if (const int done = percent(so_far.exact); done > 0) text += trFormat(", {} % exact", done);
  if (so_far.untouched > 0.0) text += trFormat(", {} % to come", std::max(1, percent(so_far.untouched)));
  return text;
}

std::string offText(double rms, bool estimated, const engine::Grid& grid) {
  const ReadAs as = readOnScreenAs(rms, grid.height_unit.mm, grid.height_unit.name);
  return estimated ? trFormat("approximate, off by about {:.3g} {} rms", rms / as.size, as.name)
                   : trFormat("approximate, off by {:.3g} {} rms", rms / as.size, as.name);
}

}  // namespace fettle::app
