#include "render/plan/material.h"

#include <algorithm>
#include <cmath>

#include <glm/geometric.hpp>

namespace fettle::render {
namespace {

constexpr std::array<MaterialRow, kMaterials> kRows{{
    {Material::kNone, "none", "the colours of the values", {}},
    {Material::kClay,
     "clay",
     "coarse form: no highlight hides it",
     {.body = {0.62F, 0.32F, 0.19F, 0.0F},
      .shadow = {0.05F, 0.04F, 0.045F, 0.0F},
      .gloss = {0.0F, 1.0F, 0.03F, 6.0F},
      .rim = {0.012F, 0.010F, 0.010F, 3.0F}}},
    {Material::kPorcelain,
     "porcelain",
     "smooth form: highlights show how it curves",
     {.body = {0.80F, 0.81F, 0.80F, 0.05F},
      .shadow = {0.10F, 0.13F, 0.19F, 0.0F},
      .gloss = {0.45F, 180.0F, 0.06F, 14.0F},
      .rim = {0.05F, 0.06F, 0.07F, 4.0F}}},
    {Material::kMetal,
     "metal",
     "fine form: scratches and waves, as on a machined part",
     {.body = {0.56F, 0.57F, 0.60F, 0.0F},
      .shadow = {0.10F, 0.10F, 0.11F, 0.85F},
      .gloss = {0.25F, 60.0F, 0.10F, 8.0F},
      .rim = {0.06F, 0.065F, 0.075F, 5.0F}}},
    {Material::kWax,
     "wax",
     "steep and deep form: its shadows stay light",
     {.body = {0.78F, 0.60F, 0.30F, 0.3F},
      .shadow = {0.26F, 0.12F, 0.06F, 0.0F},
      .gloss = {0.10F, 40.0F, 0.08F, 5.0F},
      .rim = {0.10F, 0.055F, 0.02F, 2.5F}}},
}};

constexpr bool inOrder() {
  for (std::size_t i = 0; i < kRows.size(); ++i)
    if (static_cast<std::size_t>(kRows[i].material) != i) return false;
  return true;
}
static_assert(inOrder());

// As in shaders/material.glsl.
constexpr glm::dvec3 kMainLight{-0.7, 0.4, 0.5916}, kFillLight{0.64, -0.3, 0.707};
constexpr double kFill = 0.18;

double mirrored(const glm::dvec3& n) {
  const glm::dvec3 r = 2.0 * n.z * n - glm::dvec3(0.0, 0.0, 1.0);
  const double above = (r.y - 0.55 + 0.35 * r.x) / 0.42, below = (r.y + 0.62) / 0.3;
  return 0.16 + 1.15 * std::exp(-above * above) + 0.4 * std::exp(-below * below) + 0.12 * std::max(r.z, 0.0);
}

}  // namespace

const std::array<MaterialRow, kMaterials>& materials() noexcept {
  return kRows;
}

const MaterialRow& rowOf(Material material) noexcept {
  return kRows[static_cast<std::size_t>(material)];
}

glm::dvec3 materialLight(const gpu::Material& look, const glm::dvec3& n) noexcept {
  const double reach = static_cast<double>(look.body.w);
  const double lit = std::clamp((glm::dot(n, kMainLight) + reach) / (1.0 + reach), 0.0, 1.0);
  const glm::dvec3 body = glm::mix(glm::dvec3(look.shadow), glm::dvec3(1.0), lit) +
                          kFill * std::max(glm::dot(n, kFillLight), 0.0);
  return glm::mix(body, glm::dvec3(mirrored(n)), static_cast<double>(look.shadow.w));
}

glm::dvec3 materialGloss(const gpu::Material& look, const glm::dvec3& n) noexcept {
  const double towards = std::max(glm::dot(n, glm::normalize(kMainLight + glm::dvec3(0.0, 0.0, 1.0))), 0.0);
  const glm::dvec4 gloss(look.gloss);
  return glm::dvec3(gloss.x * std::pow(towards, gloss.y) + gloss.z * std::pow(towards, gloss.w)) +
         glm::dvec3(look.rim) * std::pow(1.0 - n.z, static_cast<double>(look.rim.w));
}

}  // namespace fettle::render
