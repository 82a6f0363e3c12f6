#pragma once

#include <array>
#include <cstddef>
#include <deque>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <imgui.h>

#include "render/plan/picture.h"
#include "render/vulkan/memory.h"
#include "render/window/panel_damage.h"
#include "render/window/ui_frame.h"

struct GLFWwindow;

namespace fettle::render {

/// Dear ImGui on Vulkan: fonts, the render pass that its back end needs, and the image in which pictures and
/// panels are combined. The image holds sRGB code values in a UNORM format, since ImGui's colours are such
/// values and are blended as such.
///
/// Threading: main thread. Throws vk::SystemError.
class UiLayer {
 public:
  /// In the order of most displays, for which the image is then copied as it is; and that of pictures for it.
  static constexpr vk::Format kFormat = vk::Format::eB8G8R8A8Unorm,
                              kPictureFormat = vk::Format::eB8G8R8A8Srgb;

  /// `scale`: of the display. `layout_file`: where ImGui stores the positions of the panels; empty: nowhere.
  /// The state of the panels (positions, text being typed) lives as long as this, independent of devices.
  UiLayer(GLFWwindow* window, double scale, const std::string& layout_file);
  ~UiLayer();
  UiLayer& operator=(UiLayer&&) = delete;

  /// Panels are drawn with this context from now on; one at a time.
  void enter(Context& context);
  /// Releases all that belongs to the context, lost or not. Between leave() and enter() nothing below may be
  /// called.
  void leave() noexcept;

  /// The size of texts and panels from the next frame on.
  void setScale(double scale);
  /// The colours of what is drawn from the next frame on.
  void setTheme(Theme theme);
  /// Fits to frames of this size, in an image that `make` makes.
  using ImageMaker = std::function<GpuImage(vk::Format format, vk::ImageUsageFlags usage)>;
  void fit(vk::Extent2D extent, const ImageMaker& make);
  /// A key went down (GLFW's numbers). ImGui reads the held keys when a frame begins: with this call it also
  /// gets keys that were released by then, for one frame.
  void notePress(int key, int modifiers);
  /// A mouse button (GLFW's number) went down or up at this place of the window. ImGui reads buttons and place when a frame
  /// begins: with this call it gets each press and each release where it was, one a frame.
  void noteButton(int button, bool down, float x, float y);
  /// A pointer in the mouse's place until it leaves (Window::point): where it is (GLFW's coordinates), whether its button went
  /// down or up there, and steps of its wheel. A frame takes one press or release, the next the next one. Neither it nor the
  /// mouse moves what the other holds, and where both wait the mouse is first. A press that waits while a dialog opens is dropped.
  struct Pointed {
    double x = 0.0, y = 0.0;
    std::optional<bool> down{};
    double wheel = 0.0;
  };
  void point(const Pointed& at);
  void leavePointer() { pointed_.push_back(std::nullopt); }
  /// Whether presses or characters wait for a later frame, or a list, a menu or a dialog does, which is drawn one frame after it
  /// is opened, when its size is known, or what a panel scrolls to.
  [[nodiscard]] bool behind() const noexcept {
    return opens_ || !pressed_.empty() || !waiting_.empty() || !clicks_.empty() || !pointed_.empty();
  }
  void beginFrame(const WindowShape& shape);
  /// Whether the panels have the keyboard focus beyond text fields, dialogs and menus; and how it begins and
  /// ends.
  [[nodiscard]] bool entered() const noexcept { return entered_; }
  void enterPanels() noexcept { entered_ = true; }
  void leavePanels() noexcept;
  /// Whether a list or a menu is open, which keys walk through; dialogs have keys of their own.
  [[nodiscard]] static bool listIsOpen();
  /// Whether a text field takes the keys that are pressed now. One that Escape or Return leaves has the keyboard until the frame
  /// after: leaveField() says of such a press that those after it are not the field's.
  [[nodiscard]] bool typing() const noexcept;
  void leaveField() noexcept;
  /// Whether a panel, or a menu that waits for a click outside it, has the mouse at this position of the
  /// window (GLFW's coordinates): at the current cursor, not at that of the last frame's beginning.
  [[nodiscard]] bool panelsHaveMouse(double x, double y) const noexcept;
  /// The text of the field that has the keyboard; empty: none has.
  [[nodiscard]] std::string fieldText() const;
  /// Ends the frame's panels and stores their draw lists.
  void endFrame();

  /// A picture below the panels: in eTransferSrcOptimal, written by earlier commands.
  struct Below {
    const GpuImage* picture = nullptr;  ///< of kPictureFormat; null: there is none
    Rectangle place;                    ///< where it lies [px]
    std::vector<Rectangle> changed{};   ///< places of it, since the last frame
  };
  /// Draws what changed since the last frame - of the picture, and where panels look different - and leaves image() in
  /// eTransferSrcOptimal. Returns the places that it drew, disjoint.
  [[nodiscard]] std::vector<Rectangle> draw(const vk::raii::CommandBuffer& commands, const Below& below);
  /// In the next frame all is drawn again.
  void forget() noexcept { damage_.forget(); }
  [[nodiscard]] const GpuImage& image() const noexcept { return image_; }

 private:
  struct Press {
    int key, modifiers;
    std::size_t typed_before;  // characters that came before it and wait for a frame
  };
  struct Click {
    int button;
    bool down;
    float x, y;
  };
  void makeStyle(double scale);
  [[nodiscard]] std::vector<Rectangle> changedPlaces(const ImDrawData& panels, const Below& below);
  void drawPanels(const vk::raii::CommandBuffer& commands, ImDrawData& panels,
                  const std::vector<Rectangle>& places, const Rectangle& picture) const;
  /// Whether this frame is the mouse's: a press or release of it comes, or a button of it is down.
  [[nodiscard]] bool holdClick();
  [[nodiscard]] bool wantsKeys() const noexcept;
  [[nodiscard]] std::vector<int> holdShortPresses();
  void followPointer(bool mouse_acts);
  [[nodiscard]] bool pointerIsDown() const noexcept { return pointer_ && pointer_->down.value_or(false); }

  Context* context_ = nullptr;
  Theme theme_ = Theme::kDark;
  bool entered_ = false;
  bool opens_ = false;
  int leaving_ = 0;  // frames until a field that a key leaves has the keyboard no more
  GLFWwindow* window_;
  std::unique_ptr<UiFrame> frame_;
  std::vector<Press> pressed_;                  // since the last frame began, or waiting for the next one
  std::vector<Click> clicks_;                   // the same
  bool dialog_ = false;                         // one was open when the last frame began
  std::array<bool, 5> down_{};                  // of the buttons, after the clicks that had their frame
  std::vector<ImWchar> waiting_;                // characters that wait for the next frame
  std::deque<std::optional<Pointed>> pointed_;  // not taken by a frame yet; nothing: it left
  std::optional<Pointed> pointer_;              // in the last frame
  std::string layout_file_;                     // ImGui keeps a pointer to its text
  vk::raii::DescriptorPool descriptors_ = nullptr;
  vk::raii::RenderPass pass_ = nullptr;
  GpuImage image_;
  PanelDamage damage_;  // of image_
  Rectangle below_;     // the place of the picture in it; of size zero: none
  vk::raii::Framebuffer framebuffer_ = nullptr;
};

}  // namespace fettle::render
