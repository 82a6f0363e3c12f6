#pragma once

#include <array>

#include "engine/measure/align.h"

namespace fettle::app {

/// A way in which a scan may be moved onto another, by its word on the command line.
struct NamedMoves {
  const char* word;
  const char* text;       ///< what it allows, all of it
  const char* on_screen;  ///< the same where room is short
  engine::AlignMoves moves;
};
/// From the freest to the least free.
inline constexpr std::array<NamedMoves, 4> kNamedMoves{{
    {"all", "shift, height, rotation about z and tilt", "shift, rotation, tilt", {true, true, true}},
    {"in-plane", "shift, height and rotation about z", "shift, rotation", {true, true, false}},
    {"shift", "shift and height", "shift", {true, false, false}},
    {"level", "height and tilt", "height and tilt", {false, false, true}},
}};

}  // namespace fettle::app
