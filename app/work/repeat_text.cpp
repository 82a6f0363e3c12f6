#include "app/work/repeat_text.h"

#include <fmt/format.h>
#include <glm/geometric.hpp>

namespace fettle::app {

std::string repeatText(const glm::dvec2& repeat, const ReadAs& as) {
  const glm::dvec2 shift = repeat / as.size;
  return fmt::format(
      "the surface repeats itself every {0:.4g} {1}: a shift by {0:.4g} {1} ({2:.3g} along x, {3:.3g} along "
      "y) fits as well",
      glm::length(shift), as.name, shift.x, shift.y);
}

}  // namespace fettle::app
