#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "engine/base/error.h"
#include "render/plan/camera.h"
#include "render/plan/picture.h"

namespace fettle::render {

class Context;
struct LiveTarget;

/// Keys by what is written on them: letters as 'A' .. 'Z' and digits as '0' .. '9' in the user's own layout,
/// so that Ctrl+Z is where a German or French keyboard has its Z; signs as their ASCII code.
enum class Key : std::uint16_t {
  kNone = 0,
  kSpace = ' ',
  kComma = ',',
  kMinus = '-',
  kPeriod = '.',
  kPlus = '+',
  kLeftBracket = '[',
  kRightBracket = ']',
  kEscape = 256,
  kEnter,
  kTab,
  kBackspace,
  kDelete,
  kInsert,
  kLeft,
  kRight,
  kUp,
  kDown,
  kHome,
  kEnd,
  kPageUp,
  kPageDown,
  kF1,             // F2 .. F12 follow
  kKeypad0 = 300,  // 1 .. 9 follow
  kKeypadPeriod = 310,
  kKeypadPlus,
  kKeypadMinus,
  kKeypadEnter,
  kPause,
};
[[nodiscard]] constexpr Key letter(char c) noexcept {
  return static_cast<Key>(c);
}

struct Modifiers {
  bool control = false;
  bool shift = false;
  bool alt = false;
  friend bool operator==(const Modifiers&, const Modifiers&) = default;
};

enum class InputKind : std::uint8_t { kKeyDown, kButtonDown, kButtonUp, kMove, kWheel, kLeave };
enum class MouseButton : std::uint8_t { kLeft, kRight, kMiddle, kOther };

/// One thing a hand did, in order: a press and a release between two frames are both there.
struct InputEvent {
  InputKind kind = InputKind::kMove;
  Key key = Key::kNone;
  MouseButton button = MouseButton::kOther;
  Modifiers modifiers;
  bool repeat = false;  ///< kKeyDown: the key was held
  double x = 0.0;       ///< cursor [pixels of the window's frame], (0, 0) = top left corner
  double y = 0.0;
  double wheel = 0.0;  ///< steps, up = positive
  /// Whether the panels had the keyboard (a text field) or the mouse when this happened.
  bool panels_key = false;
  bool panels_mouse = false;
};

struct WindowOptions {
  std::string title = "Fettle";
  int width = 1280;  ///< of the frame [pixels], if the screen is that large
  int height = 800;
  Validation validation = Validation::kOff;
  std::string device;  ///< as DeviceOptions::device
  double scale = 0.0;  ///< factor on sizes of text and panels, 0.5 .. 4; 0: the display's
  /// Where the layout of the panels is remembered; empty: nowhere.
  std::string layout_file;
};

/// What showing a frame took.
struct PresentReport {
  double draw_ms = 0.0;       ///< panels and copies, until the device has done them
  std::int64_t shown_ns = 0;  ///< steady_clock when the frame was handed to the window system, drawn
};

/// A piece of text on the panels, as a person reads it.
struct PanelText {
  std::string text;          ///< UTF-8, what is visible of it
  float x = 0.0F, y = 0.0F;  ///< its left upper corner in the frame [pixels]
  float width = 0.0F, height = 0.0F;
  bool cut = false;  ///< its beginning or its end lies outside of its panel
};

/// A window with panels over pictures. The pictures are drawn by the code that draws off-screen, into targets
/// of the same kind; the window copies them in, puts the panels (Dear ImGui) over them and shows it all.
///
/// Threading: the process's main thread alone; one at a time in a process.
class Window {
 public:
  /// Errors (kFailed): no display (the line says so), no Vulkan device that can show pictures on it, as
  /// Context::create otherwise.
  [[nodiscard]] static engine::Result<std::unique_ptr<Window>> create(const WindowOptions& options);
  ~Window();
  Window(const Window&) = delete;
  Window& operator=(const Window&) = delete;

  /// Takes what happened since; waits up to `wait_s` for something to happen when nothing has.
  void poll(double wait_s);
  /// Called again and again, every millisecond or two, while present() waits for the device: the place to
  /// poll and to hand on what cannot wait for a frame. May not draw.
  void setWhileWaiting(std::function<void()> work);
  /// What hands did, oldest first; gone afterwards.
  [[nodiscard]] std::vector<InputEvent> takeInput();
  /// Paths dropped on the window since.
  [[nodiscard]] std::vector<std::string> takeDrops();

  [[nodiscard]] bool closeAsked() const;
  void refuseClose();
  [[nodiscard]] bool minimised() const;
  [[nodiscard]] int width() const;  ///< of the frame [pixels]
  [[nodiscard]] int height() const;
  /// Factor on sizes of text and panels: the display's, 1 on ordinary ones.
  [[nodiscard]] double scale() const;
  void setTitle(const std::string& title);

  /// Gives the keyboard to the panels until Esc or a click beside them: arrows then go from field to field.
  /// Otherwise only dialogs, menus and text fields take keys.
  void enterPanels();
  /// Takes it from them, before Esc or a click does; closes menus and dialogs that are open.
  void leavePanels();
  /// Starts the panels of a frame; ImGui may be called until present().
  void beginFrame();
  /// Where in the frame the picture is [pixels]; the panels have the rest, and may lie over it.
  void setPictureArea(const Rectangle& area);
  [[nodiscard]] const Rectangle& pictureArea() const;
  /// What to draw the picture to, of the size of its area (LivePicture::draw). Keeps its content from frame
  /// to frame. Never null. Errors (kFailed): no memory for it, or the device was lost.
  [[nodiscard]] engine::Result<LiveTarget*> pictureTarget();
  /// Shows nothing there until the next pictureTarget().
  void forgetPicture() noexcept;
  /// The VkFormat of the picture's target.
  [[nodiscard]] static std::uint32_t pictureFormat();

  /// Draws the panels over the picture and shows the frame. Nothing is shown while the window has no size.
  /// The window itself appears with its first frame. Errors (kFailed): the device, the surface or the display
  /// was lost, or memory ran out; see usable() and renew().
  [[nodiscard]] engine::Result<PresentReport> present();
  /// What is written on the panels of the last frame, from back to front.
  [[nodiscard]] std::vector<PanelText> texts() const;

  /// Whether the device still works and the window can be shown on. False from a present() that lost one of
  /// them on, or when asking the device says so: then renew(), and draw nothing before.
  [[nodiscard]] bool usable();
  /// Makes everything of the device anew on the same window: driver instance, device, surface, panels' fonts.
  /// Takes the device asked for, or another one when that does not start. What others made with context()
  /// must be gone before, and context() is another one afterwards. Errors as create(): the window stays
  /// without a device, and renew() may be tried again; beginFrame() and all that draws may not be called.
  [[nodiscard]] engine::Status renew();
  /// The display ended, or the connection to it: for good. Input has stopped, present() fails. The process
  /// goes on, so that work can be kept.
  [[nodiscard]] bool displayLost() const;

  /// The last frame as shown. Errors as present.
  [[nodiscard]] engine::Result<Image> capture();

  /// What everything drawn for this window is drawn with.
  [[nodiscard]] Context& context();
  [[nodiscard]] const std::string& device() const;
  [[nodiscard]] std::vector<std::string> validationMessages() const;

 private:
  struct Impl;
  explicit Window(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace fettle::render
