#pragma once

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "engine/field/reader.h"

namespace fettle::app {

/// A position [samples] on the highest of the samples around it, in field coordinates [mm]: what is drawn there is
/// not hidden by the surface's own noise. Positions outside take the height of the border, holes 0.
[[nodiscard]] glm::dvec3 aboveSurface(const engine::FieldReader& reader, glm::dvec2 at);

}  // namespace fettle::app
