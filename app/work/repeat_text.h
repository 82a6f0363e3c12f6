#pragma once

#include <string>

#include <glm/vec2.hpp>

#include "app/work/read_units.h"

namespace fettle::app {

/// What engine::Alignment::repeat means [mm], in a unit in which its length reads at ease: "the surface repeats itself every 2.5 mm: a shift by
/// 2.5 mm (2.5 along x, 0.01 along y) fits as well".
[[nodiscard]] std::string repeatText(const glm::dvec2& repeat, const ReadAs& as);

}  // namespace fettle::app
