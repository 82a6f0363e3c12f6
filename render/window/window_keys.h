#pragma once

#include "render/window/window.h"

namespace fettle::render {

/// The label in the user's layout of a key of GLFW (its number and the system's); kNone for keys that have no use here.
/// Threading: main.
[[nodiscard]] Key keyOf(int key, int scancode);
/// Of GLFW's bits.
[[nodiscard]] Modifiers modifiersOf(int bits);

}  // namespace fettle::render
