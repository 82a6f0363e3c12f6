// Drawing on the model: the keep mask under the tip (Potter, Johnson, Cohen, DETC2004-57539, "Edge
// Selection"). The centre is the brush's: the lower-left sample of the proxy's cell. Holes are not marked,
// they have no height to keep; unmarking removes every mark.

#include <cmath>
#include <memory>

#include "haptic/contact/disc.h"
#include "haptic/effects/effect.h"

namespace fettle::haptic {

namespace {

template <bool kMarked>
void runMarking(void* data, TickState& state) noexcept {
  const Disc& disc = *static_cast<const Disc*>(data);
  const CellIndex centre = state.contact.proxy.cell;
  bool changed = false;
  for (std::int32_t dr = -disc.reach; dr <= disc.reach; ++dr) {
    const std::int32_t half = disc.half_width[static_cast<std::size_t>(dr + disc.reach)];
    for (std::int32_t dc = -half; dc <= half; ++dc) {
      const std::int32_t column = centre.column + dc;
      const std::int32_t row = centre.row + dr;
      const engine::FieldReader reader = state.field.reader();
      if (!reader.grid().contains(column, row) || reader.markedAt(column, row) == kMarked) continue;
      if (kMarked && std::isnan(reader.heightAt(column, row))) continue;
      if (!state.field.setMark(column, row, kMarked)) ++state.counters.refused_edits;
      changed = true;
    }
  }
  if (!changed) return;
  state.marked = {centre.column - disc.reach, centre.row - disc.reach, 2 * disc.reach + 1,
                  2 * disc.reach + 1};
  state.surface.refresh(state.field.reader());
}

}  // namespace

void addMarking(EffectList& list, const EffectSource& from) {
  auto disc = std::make_shared<Disc>(from.scene.mark_radius_samples);
  list.tools[static_cast<std::size_t>(Tool::kMark)] = {&runMarking<true>, disc.get()};
  list.tools[static_cast<std::size_t>(Tool::kUnmark)] = {&runMarking<false>, disc.get()};
  list.tool_data.push_back(std::move(disc));
}

}  // namespace fettle::haptic
