#pragma once

#include <span>

#include "engine/field/difference.h"
#include "render/detail/patches.h"

namespace fettle::render {

/// Two frames of one panel, alike in everything but heights and marks: same camera, colours, light, size.
struct DamageQuestion {
  PatchQuestion now;                          ///< what `after` was chosen by
  engine::FieldReader before;                 ///< the field that the frame before showed
  std::span<const engine::TileChange> tiles;  ///< in which it differs from the one shown now
  const PatchChoice* chosen_before = nullptr;
  const PatchChoice* chosen_after = nullptr;
  Rectangle visible;  ///< what is drawn of the panel [px]
};

/// The part of `visible` outside which the two frames are equal bit for bit; of no size when all is. It takes
/// in, as the camera sees them,
///   - patches that one of the two frames has and the other has not, or looks for holes in: where refining
///     chose differently;
///   - of the others the cells whose vertices, or heights taken for a hole's, or colours may come from a
///     sample that changed;
/// with their heights in both states, and a margin of three pixels for the overlap of seams and for fragments
/// that compare themselves with a neighbour.
[[nodiscard]] Rectangle damageOf(const DamageQuestion& question);

/// Those patches, seams and walls of `choice` of which something may be drawn in `pixels`, in the same order.
[[nodiscard]] PatchChoice within(const PatchChoice& choice, const PatchQuestion& question,
                                 const Rectangle& pixels);

}  // namespace fettle::render
