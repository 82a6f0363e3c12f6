#pragma once

#include <span>

#include "render/live/live_panel.h"
#include "render/plan/places.h"

namespace fettle::render {

/// Adds the pixels of the picture that the lines and the stylus of these panels may cover: all of them, and around each some more.
/// What lies outside is as without them. As single eyes see them.
void addOverlays(std::span<const LivePanel> panels, Places& places);

}  // namespace fettle::render
