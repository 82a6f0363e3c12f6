#include "render/window/full_screen.h"

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

namespace fettle::render {

void enterFullScreen(GLFWwindow* window, Rectangle& windowed) {
  if (glfwGetWindowMonitor(window) != nullptr) return;
  glfwGetWindowPos(window, &windowed.x, &windowed.y);
  glfwGetWindowSize(window, &windowed.width, &windowed.height);
  const int x = windowed.x + windowed.width / 2, y = windowed.y + windowed.height / 2;
  int count = 0;
  GLFWmonitor** const screens = glfwGetMonitors(&count);
  GLFWmonitor* chosen = glfwGetPrimaryMonitor();
  for (int i = 0; i < count; ++i) {
    int left = 0, top = 0;
    glfwGetMonitorPos(screens[i], &left, &top);
    const GLFWvidmode* const mode = glfwGetVideoMode(screens[i]);
    if (mode != nullptr && x >= left && y >= top && x < left + mode->width && y < top + mode->height)
      chosen = screens[i];
  }
  const GLFWvidmode* const mode = chosen != nullptr ? glfwGetVideoMode(chosen) : nullptr;
  if (mode == nullptr) return;
  // With the screen's own mode, so that no other window is moved.
  glfwSetWindowMonitor(window, chosen, 0, 0, mode->width, mode->height, mode->refreshRate);
}

void leaveFullScreen(GLFWwindow* window, const Rectangle& windowed) {
  if (glfwGetWindowMonitor(window) == nullptr) return;
  glfwSetWindowMonitor(window, nullptr, windowed.x, windowed.y, windowed.width, windowed.height,
                       GLFW_DONT_CARE);
}

}  // namespace fettle::render
