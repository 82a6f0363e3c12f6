#pragma once

#include <vector>

#include <glm/vec2.hpp>

namespace fettle::engine {

/// Joins paths at ends that continue each other. On a weak edge the search leaves gaps, and a hand draws over them:
/// places that end at each gap cost the way to the next one. Ends up to 16 samples apart may turn by a right angle, as
/// corners do; up to 120 apart both must point at each other. The nearest and straightest first; gaps are filled with
/// points one sample apart. Empty paths are left out. Depends on nothing but the paths and their order.
/// O(n log n) for n paths in no particular arrangement.
[[nodiscard]] std::vector<std::vector<glm::dvec2>> continuedPaths(std::vector<std::vector<glm::dvec2>> paths);

}  // namespace fettle::engine
