#pragma once

#include "render/plan/camera.h"

struct GLFWwindow;

namespace fettle::render {

/// Puts the window on the whole of the screen on which its middle is; `windowed` gets its place and size. No effect where it is
/// there already, or where there is no screen. Threading: main.
void enterFullScreen(GLFWwindow* window, Rectangle& windowed);
/// Back to that place and size; no effect where it is not on a whole screen.
void leaveFullScreen(GLFWwindow* window, const Rectangle& windowed);

}  // namespace fettle::render
