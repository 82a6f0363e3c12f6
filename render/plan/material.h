#pragma once

#include <array>
#include <string_view>

#include <glm/vec3.hpp>

#include "render/plan/picture.h"
#include "shaders/layout.h"

namespace fettle::render {

/// A material by name, with what it is for.
struct MaterialRow {
  Material material;
  std::string_view word;   ///< on the command line, in settings and in lists
  std::string_view shows;  ///< what it shows well
  gpu::Material look;
};
/// In the order of Material.
inline constexpr std::size_t kMaterials = 5;
[[nodiscard]] const std::array<MaterialRow, kMaterials>& materials() noexcept;
[[nodiscard]] const MaterialRow& rowOf(Material material) noexcept;

/// The light on the body of a material whose normal, a unit vector, is `n` in the picture (right, up, to the viewer), as a factor of its colour: as in
/// shaders/material.glsl, in double precision.
[[nodiscard]] glm::dvec3 materialLight(const gpu::Material& look, const glm::dvec3& n) noexcept;
/// And what is added to that: highlights and rim.
[[nodiscard]] glm::dvec3 materialGloss(const gpu::Material& look, const glm::dvec3& n) noexcept;

}  // namespace fettle::render
