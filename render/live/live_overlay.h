#pragma once

#include <vector>

#include "engine/field/reader.h"
#include "render/live/live_picture.h"

namespace fettle::render {

/// The pieces of a brush ring, on the surface: 96 of them; those with an end over a hole or outside the field
/// are left out.
void appendRing(const engine::FieldReader& reader, const Overlays::Ring& ring, std::vector<OverlayLine>& out);

}  // namespace fettle::render
