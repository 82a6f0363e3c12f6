#include "render/window/window.h"

#include <algorithm>
#include <array>
#include <optional>
#include <utility>

#include <fmt/format.h>
#include <imgui.h>
#include <glm/vec2.hpp>

#include "engine/base/stopwatch.h"
#include "render/vulkan/live_target.h"
#include "render/vulkan/memory.h"
#include "render/window/frame_copy.h"
#include "render/window/full_screen.h"
#include "render/window/lost_display.h"
#include "render/window/shared_frames.h"
#include "render/window/tablet.h"
#include "render/window/ui_layer.h"
#include "render/window/ui_text.h"
#include "render/window/window_keys.h"
#include "render/window/window_shape.h"
#include "render/window/window_swapchain.h"

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

// GLFW's own functions, declared without types of Xlib (GLFW/glfw3native.h would include all of Xlib).
extern "C" {
void* glfwGetX11Display();
unsigned long glfwGetX11Window(GLFWwindow* window);
}

namespace fettle::render {
namespace {

// GLFW reports errors only through a callback.
std::string& lastGlfwError() {
  static std::string text;
  return text;
}
void noteGlfwError(int, const char* text) {
  lastGlfwError() = text != nullptr ? text : "";
}

// Null where the window system is another one.
std::unique_ptr<Tablet> tabletOver(GLFWwindow* window) {
  return glfwGetX11Display() != nullptr ? Tablet::open(static_cast<xcb_window_t>(glfwGetX11Window(window)))
                                        : nullptr;
}

constexpr const char* kDisplayRemedy =
    "run it in a graphical session, or with a virtual display: xvfb-run fettle view ...";

engine::Error lost(const std::string& device, const char* what) {
  if (displayIsLost())
    return engine::failure("the connection to the display was lost", "window", "open the window again")
        .value();
  return engine::failure(fmt::format("showing the picture failed ({})", what), device,
                         "open the window again")
      .value();
}

}  // namespace

struct Window::Impl {
  // In the order of creation; destroyed in reverse.
  struct Glfw {
    bool started = false;
    GLFWwindow* window = nullptr;
    ~Glfw() {
      if (window != nullptr) glfwDestroyWindow(window);
      if (started) glfwTerminate();
    }
  } glfw;
  std::unique_ptr<Tablet> tablet;
  double scale_asked = 0.0;  // 0: the display's
  [[nodiscard]] double scale() const {
    if (scale_asked > 0.0) return scale_asked;
    float x = 1.0F, y = 1.0F;
    glfwGetWindowContentScale(glfw.window, &x, &y);
    return std::clamp(static_cast<double>(x), 0.5, 4.0);
  }
  SurfaceRequest request;
  DeviceOptions device;
  std::string device_name;            // outlives the context
  std::vector<std::string> messages;  // of the previous contexts
  std::unique_ptr<UiLayer> ui;        // outlives contexts: it holds the panels
  std::unique_ptr<Context> context;
  std::unique_ptr<Presenter> presenter;
  GpuImage picture;
  LiveTarget target;
  bool drawn = false;   // something was drawn to `picture`
  bool usable = false;  // according to the last present()
  bool seen = false;    // the window is on the screen
  bool seen_elsewhere = false;
  Rectangle area{0, 0, 16, 16};
  Rectangle windowed;  // place and size of the window before it took the whole screen
  std::vector<InputEvent> input;
  WindowShape shape;
  std::vector<std::string> drops;
  std::function<void()> while_waiting;

  std::array<double, 2> cursorOfEvent() {
    if (!shape.cursor) {
      shape.cursor.emplace();
      glfwGetCursorPos(glfw.window, &(*shape.cursor)[0], &(*shape.cursor)[1]);
    }
    return *shape.cursor;
  }
  // Of the frame, for each of GLFW's units.
  [[nodiscard]] glm::dvec2 framePixels() const {
    return {static_cast<double>(std::max(shape.frame_width, 1)) / std::max(shape.width, 1),
            static_cast<double>(std::max(shape.frame_height, 1)) / std::max(shape.height, 1)};
  }
  void note(InputEvent event) {
    const auto [x, y] = cursorOfEvent();
    const glm::dvec2 scale = framePixels();
    event.x = x * scale.x;
    event.y = y * scale.y;
    if (tablet && event.kind == InputKind::kButtonDown) event.pen = tablet->penOfPress();
    if (tablet && event.kind == InputKind::kMove) event.pen = tablet->pen();
    noteAt(event, x, y);
  }
  // `x`, `y`: GLFW's.
  void noteAt(InputEvent event, double x, double y) {
    event.panels_key = ui->typing() || ui->entered() || render::UiLayer::listIsOpen();
    event.panels_mouse = ui->panelsHaveMouse(x, y);
    // They close an open list or choose from it, and nothing else: no dialog and no tool behind it.
    const bool of_list =
        event.key == Key::kEscape || event.key == Key::kEnter || event.key == Key::kKeypadEnter;
    if (event.kind == InputKind::kKeyDown && of_list && render::UiLayer::listIsOpen()) event.key = Key::kNone;
    input.push_back(event);
  }
  static Impl& of(GLFWwindow* window) { return *static_cast<Impl*>(glfwGetWindowUserPointer(window)); }
  void listen();
  [[nodiscard]] vk::Extent2D frameSize() const {
    return {static_cast<std::uint32_t>(std::max(shape.frame_width, 0)),
            static_cast<std::uint32_t>(std::max(shape.frame_height, 0))};
  }
  [[nodiscard]] Modifiers modifiersNow() const {
    const auto held = [&](int a, int b) {
      return glfwGetKey(glfw.window, a) == GLFW_PRESS || glfwGetKey(glfw.window, b) == GLFW_PRESS;
    };
    return {held(GLFW_KEY_LEFT_CONTROL, GLFW_KEY_RIGHT_CONTROL),
            held(GLFW_KEY_LEFT_SHIFT, GLFW_KEY_RIGHT_SHIFT), held(GLFW_KEY_LEFT_ALT, GLFW_KEY_RIGHT_ALT)};
  }
  void fitPanels() {
    ui->fit(presenter->extent(), [this](vk::Format format, vk::ImageUsageFlags usage) {
      return presenter->makeImage(format, usage);
    });
  }
  engine::Status enterDevice();
  void leaveDevice() noexcept;
};

engine::Status Window::Impl::enterDevice() {
  auto made = Context::create(device, &request);
  if (!made) return tl::unexpected(made.error());
  context = *std::move(made);
  device_name = context->name();
  try {
    if (glfwGetX11Display() != nullptr)
      presenter = SharedFrames::open(*context, static_cast<xcb_window_t>(glfwGetX11Window(glfw.window)));
    if (!presenter) presenter = std::make_unique<Swapchain>(*context, UiLayer::kFormat);
    ui->enter(*context);
  } catch (const std::exception& error) {
    const engine::Error why = lost(device_name, error.what());
    leaveDevice();
    return tl::unexpected(why);
  }
  usable = true;
  return {};
}

void Window::Impl::leaveDevice() noexcept {
  if (!context) return;
  try {
    context->device().waitIdle();
  } catch (const vk::SystemError&) {
    // A lost device has no work in progress.
  }
  usable = drawn = false;
  ui->leave();
  picture = {};
  target = {};
  presenter.reset();
  const std::vector<std::string> said = context->messages().all();
  messages.insert(messages.end(), said.begin(), said.end());
  context.reset();
}

// Installed before ImGui's own callbacks, which call these in turn.
void Window::Impl::listen() {
  glfwSetWindowUserPointer(glfw.window, this);
  glfwSetKeyCallback(glfw.window, [](GLFWwindow* w, int key, int scancode, int action, int mods) {
    if (action == GLFW_PRESS) of(w).ui->notePress(key, mods);
    InputEvent event;
    event.kind = action == GLFW_RELEASE ? InputKind::kKeyUp : InputKind::kKeyDown;
    event.key = keyOf(key, scancode);
    event.modifiers = modifiersOf(mods);
    event.repeat = action == GLFW_REPEAT;
    if (event.key == Key::kNone) return;
    of(w).note(event);
    // Before the frame in which ImGui gets it.
    if (event.kind != InputKind::kKeyDown) return;
    if (event.key == Key::kEscape) of(w).ui->leavePanels();
    if (event.key == Key::kEscape || event.key == Key::kEnter) of(w).ui->leaveField();
  });
  glfwSetMouseButtonCallback(glfw.window, [](GLFWwindow* w, int button, int action, int mods) {
    InputEvent event;
    event.kind = action == GLFW_PRESS ? InputKind::kButtonDown : InputKind::kButtonUp;
    event.button = button == GLFW_MOUSE_BUTTON_LEFT     ? MouseButton::kLeft
                   : button == GLFW_MOUSE_BUTTON_RIGHT  ? MouseButton::kRight
                   : button == GLFW_MOUSE_BUTTON_MIDDLE ? MouseButton::kMiddle
                                                        : MouseButton::kOther;
    event.modifiers = modifiersOf(mods);
    const auto [x, y] = of(w).cursorOfEvent();
    of(w).ui->noteButton(button, action == GLFW_PRESS, static_cast<float>(x), static_cast<float>(y));
    of(w).note(event);
  });
  glfwSetCursorPosCallback(glfw.window, [](GLFWwindow* w, double x, double y) {
    of(w).shape.cursor = {x, y};
    InputEvent event;
    event.kind = InputKind::kMove;
    event.modifiers = of(w).modifiersNow();
    // Of a run of cursor positions between two frames only the last one counts.
    of(w).note(event);
  });
  glfwSetScrollCallback(glfw.window, [](GLFWwindow* w, double, double steps) {
    InputEvent event;
    event.kind = InputKind::kWheel;
    event.wheel = steps;
    event.modifiers = of(w).modifiersNow();
    of(w).note(event);
  });
  glfwSetCursorEnterCallback(glfw.window, [](GLFWwindow* w, int entered) {
    of(w).shape.entered = entered != 0;
    InputEvent event;
    event.kind = entered != 0 ? InputKind::kMove : InputKind::kLeave;
    of(w).note(event);
  });
  glfwSetWindowSizeCallback(glfw.window, [](GLFWwindow* w, int width, int height) {
    of(w).shape.width = width;
    of(w).shape.height = height;
  });
  glfwSetFramebufferSizeCallback(glfw.window, [](GLFWwindow* w, int width, int height) {
    of(w).shape.frame_width = width;
    of(w).shape.frame_height = height;
  });
  glfwSetWindowIconifyCallback(glfw.window,
                               [](GLFWwindow* w, int iconified) { of(w).shape.iconified = iconified != 0; });
  glfwSetWindowRefreshCallback(glfw.window, [](GLFWwindow* w) {
    if (of(w).presenter) of(w).presenter->forget();
  });
  glfwSetDropCallback(glfw.window, [](GLFWwindow* w, int count, const char** paths) {
    for (int i = 0; i < count; ++i) of(w).drops.emplace_back(paths[i]);
  });
}

Window::Window(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}

Window::~Window() {
  if (impl_) impl_->leaveDevice();
}

engine::Result<std::unique_ptr<Window>> Window::create(const WindowOptions& options) {
  auto impl = std::make_unique<Impl>();
  glfwSetErrorCallback(&noteGlfwError);
  if (glfwInit() == GLFW_FALSE)
    return engine::failure(fmt::format("there is no display to open a window on ({})", lastGlfwError()),
                           "window", kDisplayRemedy);
  impl->glfw.started = true;
  watchDisplay();
  if (glfwVulkanSupported() == GLFW_FALSE)
    return engine::failure("no Vulkan driver can show pictures in a window", "window",
                           "on Debian: apt install libvulkan1 mesa-vulkan-drivers");
  glfwWindowHint(GLFW_CLIENT_API, GLFW_NO_API);
  glfwWindowHint(GLFW_SCALE_TO_MONITOR, GLFW_TRUE);
  // It appears with its first frame: before that it would show undefined content.
  glfwWindowHint(GLFW_VISIBLE, GLFW_FALSE);
  glfwWindowHintString(GLFW_X11_CLASS_NAME, "fettle");
  glfwWindowHintString(GLFW_X11_INSTANCE_NAME, "fettle");
  impl->glfw.window =
      glfwCreateWindow(options.width, options.height, options.title.c_str(), nullptr, nullptr);
  if (impl->glfw.window == nullptr)
    return engine::failure(fmt::format("the window does not open ({})", lastGlfwError()), "window",
                           kDisplayRemedy);
  glfwSetWindowSizeLimits(impl->glfw.window, 480, 320, GLFW_DONT_CARE, GLFW_DONT_CARE);
  impl->listen();
  impl->shape.ask(impl->glfw.window);
  impl->tablet = tabletOver(impl->glfw.window);

  std::uint32_t count = 0;
  const char** extensions = glfwGetRequiredInstanceExtensions(&count);
  impl->request.instance_extensions.assign(extensions, extensions + count);
  impl->request.make = [window = impl->glfw.window](VkInstance instance) {
    VkSurfaceKHR surface = VK_NULL_HANDLE;
    const VkResult result = glfwCreateWindowSurface(instance, window, nullptr, &surface);
    if (result != VK_SUCCESS)
      throw vk::SystemError(vk::make_error_code(static_cast<vk::Result>(result)), "window surface");
    return surface;
  };
  impl->device.validation = options.validation;
  impl->device.device = options.device;
  impl->scale_asked = options.scale;
  impl->ui = std::make_unique<UiLayer>(impl->glfw.window, impl->scale(), options.layout_file);
  if (const auto entered = impl->enterDevice(); !entered) return tl::unexpected(entered.error());
  return std::unique_ptr<Window>(new Window(std::move(impl)));
}

bool Window::displayLost() const {
  return displayIsLost();
}

bool Window::usable() {
  if (!impl_->context || !impl_->usable) return false;
  try {
    impl_->context->device().waitIdle();
  } catch (const vk::SystemError&) {
    impl_->usable = false;
  }
  return impl_->usable;
}

engine::Status Window::renew() {
  impl_->leaveDevice();
  if (displayIsLost()) return tl::unexpected(lost(impl_->device_name, ""));
  return impl_->enterDevice();
}

void Window::poll(double wait_s) {
  if (displayIsLost()) return;
  if (wait_s > 0.0)
    glfwWaitEventsTimeout(wait_s);
  else
    glfwPollEvents();
}

void Window::setSeenElsewhere(bool seen) noexcept {
  impl_->seen_elsewhere = seen;
}
bool Window::canBeSeen() const {
  const vk::Extent2D size = impl_->frameSize();
  return size.width > 0 && size.height > 0 && (impl_->seen_elsewhere || !minimised());
}
void Window::keepPace() {
  if (impl_->presenter && !minimised()) impl_->presenter->keepPace(impl_->while_waiting);
}
void Window::setWhileWaiting(std::function<void()> work) {
  impl_->while_waiting = std::move(work);
}
std::vector<InputEvent> Window::takeInput() {
  return std::exchange(impl_->input, {});
}
void Window::point(InputEvent event) {
  Impl& w = *impl_;
  // A window without a picture begins nothing, and ends what was begun.
  const bool ends = event.kind == InputKind::kButtonUp || event.kind == InputKind::kLeave;
  if (!ends && (!w.usable || !canBeSeen())) return;
  const glm::dvec2 at = glm::dvec2(event.x, event.y) / w.framePixels();
  if (event.kind == InputKind::kLeave) {
    w.ui->leavePointer();
  } else {
    UiLayer::Pointed pointed{at.x, at.y, std::nullopt, event.wheel};
    if (event.kind == InputKind::kButtonDown) pointed.down = true;
    if (event.kind == InputKind::kButtonUp) pointed.down = false;
    w.ui->point(pointed);
  }
  w.noteAt(event, at.x, at.y);
}

std::optional<Pen> Window::pen() {
  return impl_->tablet ? impl_->tablet->pen() : std::nullopt;
}

void Window::wake() {
  glfwPostEmptyEvent();
}

std::vector<std::string> Window::takeDrops() {
  return std::exchange(impl_->drops, {});
}
bool Window::closeAsked() const {
  return glfwWindowShouldClose(impl_->glfw.window) != 0;
}
void Window::refuseClose() {
  glfwSetWindowShouldClose(impl_->glfw.window, GLFW_FALSE);
}
bool Window::minimised() const {
  const vk::Extent2D size = impl_->frameSize();
  return impl_->shape.iconified || size.width == 0 || size.height == 0;
}
int Window::width() const {
  return static_cast<int>(impl_->frameSize().width);
}
int Window::height() const {
  return static_cast<int>(impl_->frameSize().height);
}
double Window::scale() const {
  return impl_->scale();
}
engine::Status Window::setScale(double scale) {
  Impl& w = *impl_;
  w.scale_asked = scale;
  try {
    w.ui->setScale(w.scale());
  } catch (const std::exception& error) {
    w.usable = false;
    return tl::unexpected(lost(w.device_name, error.what()));
  }
  return {};
}
void Window::setPanelTheme(Theme theme) {
  impl_->ui->setTheme(theme);
}

void Window::enterFullScreen() {
  render::enterFullScreen(impl_->glfw.window, impl_->windowed);
}
void Window::leaveFullScreen() {
  render::leaveFullScreen(impl_->glfw.window, impl_->windowed);
}
void Window::setTitle(const std::string& title) {
  glfwSetWindowTitle(impl_->glfw.window, title.c_str());
}

Context& Window::context() {
  return *impl_->context;
}
const std::string& Window::device() const {
  return impl_->device_name;
}
std::string Window::shownThrough() const {
  return impl_->presenter ? impl_->presenter->name() : "";
}
std::vector<std::string> Window::validationMessages() const {
  std::vector<std::string> all = impl_->messages;
  if (impl_->context) {
    const std::vector<std::string> said = impl_->context->messages().all();
    all.insert(all.end(), said.begin(), said.end());
  }
  return all;
}
bool Window::panelsAreBehind() const noexcept {
  return impl_->usable && impl_->ui->behind();
}

std::string Window::fieldText() const {
  return impl_->usable ? impl_->ui->fieldText() : "";
}

std::vector<PanelText> Window::texts() const {
  const ImDrawData* drawn = ImGui::GetDrawData();
  return drawn != nullptr ? textsOf(*drawn) : std::vector<PanelText>{};
}

void Window::enterPanels() {
  impl_->ui->enterPanels();
}
void Window::leavePanels() {
  impl_->ui->leavePanels();
}
void Window::beginFrame() {
  impl_->ui->beginFrame(impl_->shape);
}

void Window::setPictureArea(const Rectangle& area) {
  impl_->area = area;
  impl_->area.width = std::max(area.width, 16);
  impl_->area.height = std::max(area.height, 16);
}
const Rectangle& Window::pictureArea() const {
  return impl_->area;
}
std::uint32_t Window::pictureFormat() {
  return static_cast<std::uint32_t>(UiLayer::kPictureFormat);
}

engine::Result<LiveTarget*> Window::pictureTarget() try {
  Impl& w = *impl_;
  const vk::Extent2D extent{static_cast<std::uint32_t>(w.area.width),
                            static_cast<std::uint32_t>(w.area.height)};
  if (w.picture.extent() != extent) {
    w.context->device().waitIdle();
    w.picture = pictureImage(*w.context, extent, UiLayer::kPictureFormat);
    ++w.target.kept;
    w.target.changed.clear();
  }
  w.target.image = w.picture.image();
  w.target.view = w.picture.view();
  w.target.extent = extent;
  w.target.leaves_as = vk::ImageLayout::eTransferSrcOptimal;
  w.drawn = true;
  return &w.target;
} catch (const std::exception& error) {
  // The old image may be destroyed without a new one in its place.
  impl_->picture = {};
  impl_->drawn = false;
  return tl::unexpected(lost(impl_->device_name, error.what()));
}

void Window::clearPicture() noexcept {
  impl_->drawn = false;
}

engine::Result<PresentReport> Window::present() {
  Impl& w = *impl_;
  PresentReport report;
  w.ui->endFrame();
  try {
    if (displayIsLost()) return tl::unexpected(lost(w.device_name, ""));
    const auto combine = [&w](const vk::raii::CommandBuffer& commands) {
      const vk::Extent2D size = w.picture.extent();
      return w.ui->draw(commands, {w.drawn ? &w.picture : nullptr,
                                   {std::max(w.area.x, 0), std::max(w.area.y, 0),
                                    static_cast<int>(size.width), static_cast<int>(size.height)},
                                   std::exchange(w.target.changed, {})});
    };
    if (minimised()) {
      if (!canBeSeen()) return report;
      if (!w.presenter->fit(w.frameSize())) return report;
      w.fitPanels();
      w.context->run([&](const vk::raii::CommandBuffer& commands) { (void)combine(commands); });
      return report;
    }
    const auto while_waiting = [&w] {
      if (w.while_waiting) w.while_waiting();
      // A lost display returns no image, and not every driver reports that.
      if (displayIsLost()) throw vk::SurfaceLostKHRError("display");
    };
    const auto before_showing = [&w] {
      if (!std::exchange(w.seen, true)) glfwShowWindow(w.glfw.window);
    };
    // A window that changes its size while it is shown needs another try.
    for (int tries = 0; tries < 3; ++tries) {
      if (!w.presenter->fit(w.frameSize())) return report;
      w.fitPanels();
      const engine::Stopwatch watch;
      const bool shown = w.presenter->show({w.ui->image().image(), combine, while_waiting, before_showing});
      report.waited_ms += w.presenter->waitedMs();
      report.draw_ms = watch.ms() - w.presenter->waitedMs();
      report.shown_ns = engine::steadyNs();
      if (shown) break;
    }
    return report;
  } catch (const std::exception& error) {
    w.usable = false;
    return tl::unexpected(lost(w.device_name, error.what()));
  }
}

engine::Result<Image> Window::capture() {
  Impl& w = *impl_;
  try {
    return copyOf(w.ui->image(), *w.context);
  } catch (const std::exception& error) {
    return tl::unexpected(lost(w.device_name, error.what()));
  }
}

}  // namespace fettle::render
