#include "render/live/kept_target.h"

#include <utility>

#include "render/live/overlay_places.h"

namespace fettle::render {

BaseCopy KeptTarget::copyTo(const LiveTarget& target, const GpuImage& base, std::span<const LivePanel> panels,
                            std::optional<Places> changed) {
  const Rectangle all{0, 0, static_cast<int>(target.extent.width), static_cast<int>(target.extent.height)};
  const std::optional<Held> before = std::exchange(held_, std::nullopt);
  if (target.kept == 0 || base.range().layerCount > 1 || target.over) return {base, {all}};
  // All overlays are drawn again, each over what was copied below it.
  Places overlays;
  addOverlays(panels, overlays);
  held_ = Held{target.kept, target.image, target.extent, &base, overlays.take()};
  if (!changed || !before || before->kept != target.kept || before->image != target.image ||
      before->extent != target.extent || before->base != &base)
    return {base, {all}};
  for (const Rectangle& place : before->overlays) changed->add(place);
  for (const Rectangle& place : held_->overlays) changed->add(place);
  BaseCopy copy{base, changed->take(), true};
  for (Rectangle& place : copy.places) place = cut(place, all);
  std::erase_if(copy.places, [](const Rectangle& place) { return empty(place); });
  return copy;
}

}  // namespace fettle::render
