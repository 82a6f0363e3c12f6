#pragma once

#include <vector>

#include "engine/edges/polyline.h"

namespace fettle::engine {

/// Moves points of lines that run along each other and touch or cross in places, so that they keep the order in
/// which they run: to either side of the middle between them. Lines that cross and part are left as they are.
void separate(std::vector<Polyline>& lines);

}  // namespace fettle::engine
