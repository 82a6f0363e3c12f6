#include "render/window/window_shape.h"

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

namespace fettle::render {

void WindowShape::ask(GLFWwindow* window) {
  glfwGetWindowSize(window, &width, &height);
  glfwGetFramebufferSize(window, &frame_width, &frame_height);
  iconified = glfwGetWindowAttrib(window, GLFW_ICONIFIED) != 0;
  entered = glfwGetWindowAttrib(window, GLFW_HOVERED) != 0;
}

}  // namespace fettle::render
