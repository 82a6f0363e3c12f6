#pragma once

#include <string>
#include <vector>

#include "render/vulkan/memory.h"

struct GLFWwindow;

namespace fettle::render {

/// Dear ImGui on this room's devices: fonts, the render pass that its back end asks for, and the image in
/// which pictures and panels come together. The image holds sRGB code values without saying so (UNORM), since
/// that is what ImGui's colours are and how it blends them.
///
/// Threading: main thread. Throws vk::SystemError.
class UiLayer {
 public:
  static constexpr vk::Format kFormat = vk::Format::eR8G8B8A8Unorm;

  /// `scale`: of the display. `layout_file`: where ImGui keeps the panels' places; empty: nowhere. What the
  /// panels hold (places, text being typed) lives as long as this, whatever becomes of devices.
  UiLayer(GLFWwindow* window, double scale, const std::string& layout_file);
  ~UiLayer();
  UiLayer(const UiLayer&) = delete;
  UiLayer& operator=(const UiLayer&) = delete;

  /// From now on the panels are drawn with this context; one at a time.
  void enter(Context& context);
  /// Lets go of all that belongs to it, lost or not. Between leave() and enter() nothing below may be called.
  void leave() noexcept;

  void fit(vk::Extent2D extent);
  /// A key went down (GLFW's numbers). ImGui looks at what is held when a frame begins: with this it sees
  /// keys that were let go by then, too, for one frame.
  void notePress(int key, int modifiers) { pressed_.push_back({key, modifiers}); }
  void beginFrame();
  /// Whether the panels have the keyboard beyond text fields, dialogs and menus; and from when to when.
  [[nodiscard]] bool entered() const noexcept { return entered_; }
  void enterPanels() noexcept { entered_ = true; }
  void leavePanels() noexcept;
  /// Whether a panel, or a menu that waits for a click outside it, has the mouse at this place of the window
  /// (GLFW's coordinates): where the cursor is now, not where it was when the last frame began.
  [[nodiscard]] bool panelsHaveMouse(double x, double y) const noexcept;
  /// Ends the frame's panels and keeps what they draw.
  void endFrame();

  /// The image is the target of transfers first (bring()), then of the panels (draw()), then ready to be
  /// copied from.
  void clear(const vk::raii::CommandBuffer& commands) const;
  void draw(const vk::raii::CommandBuffer& commands) const;
  [[nodiscard]] const GpuImage& image() const noexcept { return image_; }

 private:
  struct Press {
    int key, modifiers;
  };
  void makeStyle(double scale) const;
  [[nodiscard]] std::vector<int> holdShortPresses();

  Context* context_ = nullptr;
  bool entered_ = false;
  GLFWwindow* window_;
  std::vector<Press> pressed_;  // since the last frame began
  std::string layout_file_;     // ImGui keeps a pointer to its text
  vk::raii::DescriptorPool descriptors_ = nullptr;
  vk::raii::RenderPass pass_ = nullptr;
  GpuImage image_;
  vk::raii::Framebuffer framebuffer_ = nullptr;
};

}  // namespace fettle::render
