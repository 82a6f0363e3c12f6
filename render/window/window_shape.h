#pragma once

#include <array>
#include <optional>

struct GLFWwindow;

namespace fettle::render {

/// How large a window is and where the cursor is in it, as far as the window's events have said. GLFW asks the display's server for each
/// of these, and a frame that asks a dozen times waits a dozen times: beside processes that spin one answer in
/// fifty takes 4 ms.
///
/// Threading: main thread.
struct WindowShape {
  int width = 1, height = 1;              ///< GLFW's units
  int frame_width = 0, frame_height = 0;  ///< of the frame [pixels]
  bool iconified = false;
  bool entered = false;                         ///< the cursor is in it
  std::optional<std::array<double, 2>> cursor;  ///< GLFW's units; unset: nothing was said of it yet

  /// All but the cursor, from the server.
  void ask(GLFWwindow* window);
};

}  // namespace fettle::render
