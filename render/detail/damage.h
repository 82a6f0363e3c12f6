#pragma once

#include <span>

#include "engine/field/difference.h"
#include "render/detail/patches.h"

namespace fettle::render {

/// Two frames of one panel, alike in everything but heights and marks: same camera, colours, light, size.
struct DamageQuery {
  PatchQuery now;                             ///< the query that `after` was chosen for
  engine::FieldReader before;                 ///< the field that the frame before showed
  std::span<const engine::TileChange> tiles;  ///< in which it differs from the one shown now
  const PatchChoice* chosen_before = nullptr;
  const PatchChoice* chosen_after = nullptr;
  Rectangle visible;  ///< what is drawn of the panel [px]
};

/// The part of `visible` outside which the two frames are bit-identical; of size zero when all of it is. It
/// contains, as the camera sees them,
///   - patches that only one of the two frames has or checks for holes: where refining chose differently;
///   - of the other patches, the cells whose vertices, replacement heights of holes, or colours may depend on
///     a sample that changed;
/// with their heights in both states, and a margin of three pixels for the overlap of seams and for fragments
/// that compare themselves with a neighbour.
[[nodiscard]] Rectangle damageOf(const DamageQuery& query);

/// The patches, seams and walls of `choice` of which something may be drawn in `pixels`, in the same order.
[[nodiscard]] PatchChoice within(const PatchChoice& choice, const PatchQuery& query, const Rectangle& pixels);

}  // namespace fettle::render
