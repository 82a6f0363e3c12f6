#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "engine/base/error.h"
#include "render/plan/camera.h"
#include "render/plan/picture.h"
#include "render/window/pen.h"

namespace fettle::render {

class Context;
struct LiveTarget;

/// Keys by their labels: letters as 'A' .. 'Z' and digits as '0' .. '9' in the user's own layout, so that
/// Ctrl+Z is where a German or French keyboard has its Z; signs as their ASCII code.
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

enum class InputKind : std::uint8_t { kKeyDown, kKeyUp, kButtonDown, kButtonUp, kMove, kWheel, kLeave };
enum class MouseButton : std::uint8_t { kLeft, kRight, kMiddle, kOther };

/// One input event, in order: a press and a release between two frames are both reported.
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
  /// Of mouse events: the tablet's pen that moved or pressed in the mouse's place.
  std::optional<Pen> pen;
};

struct WindowOptions {
  std::string title = "Fettle";
  int width = 1280;  ///< of the frame [pixels], if the screen is that large
  int height = 800;
  Validation validation = Validation::kOff;
  std::string device;  ///< as DeviceOptions::device
  double scale = 0.0;  ///< factor on sizes of text and panels, 0.5 .. 4; 0: the display's
  /// Where the layout of the panels is stored; empty: nowhere.
  std::string layout_file;
};

/// Times of showing a frame.
struct PresentReport {
  double draw_ms = 0.0;       ///< panels and copies, until the device has completed them
  double waited_ms = 0.0;     ///< for the display to give back an image, not in draw_ms
  std::int64_t shown_ns = 0;  ///< engine::steadyNs() when the drawn frame was submitted to the window system
};

/// A piece of text on the panels, as displayed.
struct PanelText {
  std::string text;          ///< UTF-8, its visible part
  float x = 0.0F, y = 0.0F;  ///< its left upper corner in the frame [pixels]
  float width = 0.0F, height = 0.0F;
  bool cut = false;  ///< its beginning or its end lies outside of its panel
};

/// A window with panels over pictures. Pictures are drawn by the same code as off-screen, into targets of the
/// same kind; the window copies them, draws the panels (Dear ImGui) over them and shows the result.
///
/// Threading: only the process's main thread, except for wake(); one window at a time per process.
class Window {
 public:
  /// Errors (kFailed): no display (the message says so), no Vulkan device that can present on it; otherwise
  /// as Context::create.
  [[nodiscard]] static engine::Result<std::unique_ptr<Window>> create(const WindowOptions& options);
  ~Window();
  Window& operator=(Window&&) = delete;

  /// Collects the events since the last call; waits up to `wait_s` for one when there is none.
  void poll(double wait_s);
  /// Waits until another frame is worth showing (Presenter::keepPace): before the frame takes what it is going to show.
  void keepPace();
  /// Called repeatedly, every millisecond or two, while present() waits for the device, and keepPace(): for polling and for
  /// work that cannot wait for a frame. Must not draw.
  void setWhileWaiting(std::function<void()> work);
  /// The input since the last call, oldest first.
  [[nodiscard]] std::vector<InputEvent> takeInput();
  /// A pointer in the mouse's place, as of a hand that points at the window's frame elsewhere: moves to x, y [pixels of the
  /// frame], presses and releases the left button there, turns the wheel, leaves. Panels and takeInput() get it as if the
  /// mouse had done it.
  void point(InputEvent event);
  /// The tablet's pen whose tip is down over this window, as far as the display has said so.
  [[nodiscard]] std::optional<Pen> pen();
  /// Any thread: ends the wait of poll().
  static void wake();
  /// Paths dropped on the window since the last call.
  [[nodiscard]] std::vector<std::string> takeDrops();

  [[nodiscard]] bool closeAsked() const;
  void refuseClose();
  [[nodiscard]] bool minimised() const;
  [[nodiscard]] int width() const;  ///< of the frame [pixels]
  [[nodiscard]] int height() const;
  /// Factor on sizes of text and panels: the display's, 1 on standard ones.
  [[nodiscard]] double scale() const;
  /// The same from the next frame on, 0.5 .. 4; 0: the display's. Between frames. After a failure, as after one of present(),
  /// the window shows nothing until renew().
  [[nodiscard]] engine::Status setScale(double scale);
  /// The colours of the panels from the next frame on (panel_colours.h).
  void setPanelTheme(Theme theme);
  void setTitle(const std::string& title);
  /// On the whole of the screen on which its middle is; no effect where there is none, as without a display's
  /// own list of screens.
  void enterFullScreen();
  /// Back to its place and size.
  void leaveFullScreen();

  /// Gives the keyboard to the panels until Esc or a click outside them: arrow keys then move between fields.
  /// Otherwise only dialogs, menus and text fields take keys.
  void enterPanels();
  /// Ends that before Esc or a click does; closes menus and dialogs that are open.
  void leavePanels();
  /// Starts the panels of a frame; ImGui may be called until present().
  void beginFrame();
  /// Position of the picture in the frame [pixels]; the panels have the rest, and may overlap it.
  void setPictureArea(const Rectangle& area);
  [[nodiscard]] const Rectangle& pictureArea() const;
  /// The target of the picture, of the size of its area (LivePicture::draw). Its content is kept between
  /// frames. Never null. Errors (kFailed): no memory for it, or the device was lost.
  [[nodiscard]] engine::Result<LiveTarget*> pictureTarget();
  /// Shows no picture until the next pictureTarget().
  void clearPicture() noexcept;
  /// The VkFormat of the picture's target.
  [[nodiscard]] static std::uint32_t pictureFormat();

  /// Whether frames are drawn also while the window is minimised: for who sees them elsewhere, by capture().
  void setSeenElsewhere(bool seen) noexcept;
  /// Whether there is anything to draw on: it has a size, and is on the screen or seen elsewhere.
  [[nodiscard]] bool canBeSeen() const;
  /// Draws the panels over the picture and shows the frame. Nothing is shown while the window has no size or is minimised.
  /// The window itself appears with its first frame. Errors (kFailed): the device, the surface or the display
  /// was lost, or memory ran out; see usable() and renew().
  [[nodiscard]] engine::Result<PresentReport> present();
  /// The text of the panels of the last frame, from back to front.
  [[nodiscard]] std::vector<PanelText> texts() const;
  /// Whether the panels have not got all keys and characters yet: another frame must follow.
  [[nodiscard]] bool panelsAreBehind() const noexcept;
  /// What stands in the field that has the keyboard; empty: none has.
  [[nodiscard]] std::string fieldText() const;

  /// Whether the device works and the window can be presented on. False after a present() that lost one of
  /// them, or when the device reports its loss: then call renew(), and draw nothing before.
  [[nodiscard]] bool usable();
  /// Creates everything of the device again on the same window: driver instance, device, surface, fonts of
  /// the panels. Uses the requested device, or another one when that does not start. Objects created with
  /// context() must be destroyed before, and context() is another one afterwards. Errors as create(): the
  /// window stays without a device, and renew() may be tried again; beginFrame() and all that draws may not
  /// be called.
  [[nodiscard]] engine::Status renew();
  /// The display or the connection to it was lost permanently. Input has stopped, present() fails. The
  /// process continues, so that work can be saved.
  [[nodiscard]] bool displayLost() const;

  /// The last frame as shown. Errors as present.
  [[nodiscard]] engine::Result<Image> capture();

  /// The context of everything drawn for this window.
  [[nodiscard]] Context& context();
  [[nodiscard]] const std::string& device() const;
  /// How frames reach the display ("shared memory", "Vulkan"); empty without a device.
  [[nodiscard]] std::string shownThrough() const;
  [[nodiscard]] std::vector<std::string> validationMessages() const;

 private:
  struct Impl;
  explicit Window(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace fettle::render
