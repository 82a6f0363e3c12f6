#pragma once

namespace fettle::render {

/// From now on the loss of the display, or of the connection to it, does not end the program. Call when GLFW has started.
/// Threading: main.
void watchDisplay();
/// Whether it was lost since.
[[nodiscard]] bool displayIsLost() noexcept;

}  // namespace fettle::render
