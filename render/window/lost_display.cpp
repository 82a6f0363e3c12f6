#include "render/window/lost_display.h"

#include <atomic>
#include <cstdio>
#include <cstdlib>

#include <dlfcn.h>

// GLFW's own function, declared without a type of Xlib (GLFW/glfw3native.h would include all of Xlib).
extern "C" void* glfwGetX11Display();

namespace fettle::render {
namespace {

// Set by Xlib's handler, read by the window: both on the main thread; atomic as for a signal, at no cost.
std::atomic<bool> display_lost{false};

// By default Xlib ends the program when its server is lost; with this handler its calls do nothing
// afterwards. GLFW loads the library by itself, so it is loaded here in the same way.
// (XSetIOErrorExitHandler: libX11 1.7, 2020. With an older one the program ends here, by quick_exit: the
// threads of device and loop still use what exit() would destroy.)
int onDisplayLost(void* display) {
  display_lost.store(true);
  if (display != nullptr) return 0;
  std::fputs("fettle: error: the connection to the display was lost, window, open the window again\n",
             stderr);
  std::quick_exit(1);
}
int onDisplayLostForGood(void* /*display*/) {
  return onDisplayLost(nullptr);
}
void goOnAfterDisplay(void* /*display*/, void* /*data*/) {}

}  // namespace

void watchDisplay() {
  display_lost.store(false);
  void* const display = glfwGetX11Display();
  using Handler = int (*)(void*);
  using ExitHandler = void (*)(void*, void*);
  void* x11 = dlopen("libX11.so.6", RTLD_LAZY | RTLD_NOLOAD);
  if (x11 == nullptr || display == nullptr) return;  // another window system
  auto* set = reinterpret_cast<Handler (*)(Handler)>(dlsym(x11, "XSetIOErrorHandler"));
  auto* set_exit =
      reinterpret_cast<void (*)(void*, ExitHandler, void*)>(dlsym(x11, "XSetIOErrorExitHandler"));
  if (set != nullptr) set(set_exit != nullptr ? &onDisplayLost : &onDisplayLostForGood);
  if (set_exit != nullptr) set_exit(display, &goOnAfterDisplay, nullptr);
  dlclose(x11);
}

bool displayIsLost() noexcept {
  return display_lost.load();
}

}  // namespace fettle::render
