#pragma once

#include <array>

#include <imgui.h>

#include "render/window/window_shape.h"

struct GLFWcursor;

namespace fettle::render {

/// Begins ImGui's frames by what the window's events have said. ImGui's back end for GLFW still takes the events; its own
/// beginning of a frame asks the display's server for size, focus and cursor, which WindowShape knows.
///
/// Threading: main thread, between glfwInit() and glfwTerminate().
class UiFrame {
 public:
  explicit UiFrame(GLFWwindow* window);
  ~UiFrame();
  UiFrame& operator=(UiFrame&&) = delete;

  /// Sizes, time step, place of the mouse, and the cursor that the last frame asked for. Not its buttons.
  void begin(const WindowShape& shape);

 private:
  void showCursor(ImGuiMouseCursor wanted);

  GLFWwindow* const window_;
  double time_s_ = 0.0;
  ImGuiMouseCursor shown_ = ImGuiMouseCursor_Arrow;
  std::array<GLFWcursor*, ImGuiMouseCursor_COUNT> cursors_{};  // null: the arrow
};

}  // namespace fettle::render
