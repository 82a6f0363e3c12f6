#include "app/commands/rounding_warning.h"

#include <fmt/format.h>

#include "app/terminal.h"
#include "engine/measure/height_rounding.h"

namespace fettle::app {

void warnOfRounding(const std::string& doubt, const std::string& scan) {
  if (!doubt.empty()) warn(fmt::format("{}: {}; a zero near the surface keeps more digits", scan, doubt));
}

void warnOfRounding(std::initializer_list<const engine::Version*> fields, double rms, std::string_view of,
                    const std::string& scan) {
  warnOfRounding(engine::roundingDoubt(fields, rms, of), scan);
}

}  // namespace fettle::app
