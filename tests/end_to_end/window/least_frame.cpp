#include "tests/end_to_end/window/least_frame.h"

#include <cstdlib>
#include <cstring>

#include <array>
#include <chrono>
#include <cstdint>
#include <memory>
#include <thread>

#include <sys/mman.h>
#include <sys/resource.h>
#include <unistd.h>
#include <xcb/shm.h>
#include <xcb/xcb.h>

#include "tests/end_to_end/window/x_hand.h"

namespace fettle::tests {
namespace {

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;

struct Free {
  void operator()(void* p) const noexcept { std::free(p); }
};
template <class T>
using Reply = std::unique_ptr<T, Free>;

class Client {
 public:
  Client(const std::string& display, int width, int height)
      : x_(xcb_connect(display.c_str(), nullptr)), width_(width), height_(height) {
    if (xcb_connection_has_error(x_) != 0) return;
    const xcb_screen_t& screen = *xcb_setup_roots_iterator(xcb_get_setup(x_)).data;
    window_ = xcb_generate_id(x_);
    const std::array<std::uint32_t, 1> events{XCB_EVENT_MASK_POINTER_MOTION};
    xcb_create_window(x_, screen.root_depth, window_, screen.root, 0, 0, static_cast<std::uint16_t>(width),
                      static_cast<std::uint16_t>(height), 0, XCB_WINDOW_CLASS_INPUT_OUTPUT,
                      screen.root_visual, XCB_CW_EVENT_MASK, events.data());
    xcb_map_window(x_, window_);
    pen_ = xcb_generate_id(x_);
    xcb_create_gc(x_, pen_, window_, 0, nullptr);
    share();
    answered();
  }
  ~Client() {
    if (frame_ != nullptr) munmap(frame_, bytes());
    xcb_disconnect(x_);
  }
  Client& operator=(Client&&) = delete;
  [[nodiscard]] bool works() const { return frame_ != nullptr && xcb_connection_has_error(x_) == 0; }

  void drop() {
    while (Reply<xcb_generic_event_t>(xcb_poll_for_event(x_))) {
    }
  }
  // Waits for a movement and shows a frame of one colour.
  void follow(int colour) {
    while (const Reply<xcb_generic_event_t> event{xcb_wait_for_event(x_)})
      if ((event->response_type & 0x7FU) == XCB_MOTION_NOTIFY) break;
    std::memset(frame_, colour, bytes());
    const auto w = static_cast<std::uint16_t>(width_), h = static_cast<std::uint16_t>(height_);
    xcb_shm_put_image(x_, window_, pen_, w, h, 0, 0, w, h, 0, 0, 24, XCB_IMAGE_FORMAT_Z_PIXMAP, 0, segment_,
                      0);
    answered();
  }

 private:
  [[nodiscard]] std::size_t bytes() const {
    return std::size_t{4} * static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_);
  }
  void share() {
    const int file = memfd_create("frame", MFD_CLOEXEC);
    if (file < 0 || ftruncate(file, static_cast<off_t>(bytes())) != 0) return;
    void* const seen = mmap(nullptr, bytes(), PROT_READ | PROT_WRITE, MAP_SHARED, file, 0);
    segment_ = xcb_generate_id(x_);
    const Reply<xcb_generic_error_t> refused{
        xcb_request_check(x_, xcb_shm_attach_fd_checked(x_, segment_, file, 1))};
    if (!refused && seen != MAP_FAILED) frame_ = seen;
  }
  void answered() {
    const Reply<xcb_get_input_focus_reply_t> reply{
        xcb_get_input_focus_reply(x_, xcb_get_input_focus(x_), nullptr)};
  }

  xcb_connection_t* x_;
  int width_, height_;
  xcb_window_t window_ = 0;
  xcb_gcontext_t pen_ = 0;
  xcb_shm_seg_t segment_ = 0;
  void* frame_ = nullptr;
};

}  // namespace

std::vector<double> leastFrames(const std::string& display, int width, int height, int frames) {
  std::vector<double> times;
  // In a thread of its own, with the priority of one that draws: none need be allowed to go back.
  std::thread([&] {
    static_cast<void>(setpriority(PRIO_PROCESS, static_cast<id_t>(gettid()), -10));
    XHand hand(display);
    Client client(display, width, height);
    if (!hand.works() || !client.works()) return;
    for (int i = 0; i < frames; ++i) {
      client.drop();
      const Clock::time_point begin = Clock::now();
      hand.moveTo(width / 4 + i % 100, height / 2);
      client.follow(i % 256);
      times.push_back(std::chrono::duration<double, std::milli>(Clock::now() - begin).count());
      std::this_thread::sleep_until(begin + 8ms);
    }
  }).join();
  return times;
}

}  // namespace fettle::tests
