#include "haptic/patch.h"

#include "haptic/patch_inl.h"

namespace fettle::haptic {

PatchPoint closestOnPatch(const Patch& patch, const glm::dvec3& endpoint, double u0, double v0) noexcept {
  return detail::descendPatch(patch, endpoint, u0, v0);
}

}  // namespace fettle::haptic
