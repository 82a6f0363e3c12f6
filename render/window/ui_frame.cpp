#include "render/window/ui_frame.h"

#include <algorithm>
#include <cfloat>
#include <utility>

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

namespace fettle::render {
namespace {

constexpr std::pair<ImGuiMouseCursor, int> kCursors[] = {
    {ImGuiMouseCursor_Arrow, GLFW_ARROW_CURSOR},      {ImGuiMouseCursor_TextInput, GLFW_IBEAM_CURSOR},
    {ImGuiMouseCursor_ResizeNS, GLFW_VRESIZE_CURSOR}, {ImGuiMouseCursor_ResizeEW, GLFW_HRESIZE_CURSOR},
    {ImGuiMouseCursor_Hand, GLFW_HAND_CURSOR},
};
constexpr float kFirstStep_s = 1.0F / 60.0F;

bool anyButtonDown(GLFWwindow* window) {
  for (int button = GLFW_MOUSE_BUTTON_1; button <= GLFW_MOUSE_BUTTON_LAST; ++button)
    if (glfwGetMouseButton(window, button) == GLFW_PRESS) return true;
  return false;
}

}  // namespace

UiFrame::UiFrame(GLFWwindow* window) : window_(window) {
  for (const auto& [of, shape] : kCursors)
    cursors_[static_cast<std::size_t>(of)] = glfwCreateStandardCursor(shape);
}

UiFrame::~UiFrame() {
  for (GLFWcursor* const cursor : cursors_)
    if (cursor != nullptr) glfwDestroyCursor(cursor);
}

void UiFrame::begin(const WindowShape& shape) {
  ImGuiIO& io = ImGui::GetIO();
  io.DisplaySize = ImVec2(static_cast<float>(shape.width), static_cast<float>(shape.height));
  if (shape.width > 0 && shape.height > 0)
    io.DisplayFramebufferScale = ImVec2(static_cast<float>(shape.frame_width) / io.DisplaySize.x,
                                        static_cast<float>(shape.frame_height) / io.DisplaySize.y);
  const double now_s = glfwGetTime();
  // Two frames within one tick of the clock would have no step, which ImGui refuses.
  io.DeltaTime = time_s_ > 0.0 ? std::max(static_cast<float>(now_s - time_s_), 1e-6F) : kFirstStep_s;
  time_s_ = now_s;
  // What is dragged out of the window goes on.
  const bool here = shape.cursor && (shape.entered || anyButtonDown(window_));
  io.MousePos = here ? ImVec2(static_cast<float>((*shape.cursor)[0]), static_cast<float>((*shape.cursor)[1]))
                     : ImVec2(-FLT_MAX, -FLT_MAX);
  showCursor(ImGui::GetMouseCursor());
}

void UiFrame::showCursor(ImGuiMouseCursor wanted) {
  if (std::exchange(shown_, wanted) == wanted) return;
  if (wanted == ImGuiMouseCursor_None) {
    glfwSetInputMode(window_, GLFW_CURSOR, GLFW_CURSOR_HIDDEN);
    return;
  }
  glfwSetInputMode(window_, GLFW_CURSOR, GLFW_CURSOR_NORMAL);
  glfwSetCursor(window_, cursors_[static_cast<std::size_t>(wanted)]);
}

}  // namespace fettle::render
