#include "tests/end_to_end/window/x_hand.h"

#include <cstdlib>
#include <cstring>

#include <chrono>
#include <memory>
#include <stdexcept>

#include <sys/uio.h>
#include <xcb/xcb.h>
#include <xcb/xcbext.h>

namespace fettle::tests {
namespace {

struct FreeReply {
  void operator()(void* p) const noexcept { std::free(p); }
};

// XTEST's FakeInput, request 2: its own packages offer no more than this structure.
struct FakeInput {
  std::uint8_t opcode = 0, minor = 2;
  std::uint16_t length = 0;  // set by xcb
  std::uint8_t type = 0, detail = 0;
  std::uint16_t pad = 0;
  std::uint32_t time = 0, root = 0;
  std::uint32_t pad2[2] = {};
  std::int16_t x = 0, y = 0;
  std::uint8_t pad3[7] = {}, device = 0;
};
static_assert(sizeof(FakeInput) == 36);

xcb_extension_t kXTest{"XTEST", 0};

std::uint8_t codeOf(xcb_connection_t* x, char sign) {
  const xcb_setup_t* setup = xcb_get_setup(x);
  const auto count = static_cast<std::uint8_t>(setup->max_keycode - setup->min_keycode + 1);
  const std::unique_ptr<xcb_get_keyboard_mapping_reply_t, FreeReply> map(
      xcb_get_keyboard_mapping_reply(x, xcb_get_keyboard_mapping(x, setup->min_keycode, count), nullptr));
  if (!map) throw std::runtime_error("no keyboard");
  const xcb_keysym_t* symbols = xcb_get_keyboard_mapping_keysyms(map.get());
  for (int i = 0; i < count; ++i)
    if (symbols[i * map->keysyms_per_keycode] == static_cast<xcb_keysym_t>(sign))
      return static_cast<std::uint8_t>(setup->min_keycode + i);
  throw std::runtime_error(std::string("no key for ") + sign);
}

}  // namespace

XHand::XHand(const std::string& display) : x_(xcb_connect(display.c_str(), nullptr)) {
  if (xcb_connection_has_error(x_) != 0) return;
  root_ = xcb_setup_roots_iterator(xcb_get_setup(x_)).data->root;
  const xcb_query_extension_reply_t* found = xcb_get_extension_data(x_, &kXTest);
  if (found != nullptr && found->present != 0) opcode_ = found->major_opcode;
}

XHand::~XHand() {
  xcb_disconnect(x_);
}

void XHand::fake(std::uint8_t type, std::uint8_t detail, int x, int y) {
  FakeInput request;
  request.type = type;
  request.detail = detail;
  request.root = root_;
  request.x = static_cast<std::int16_t>(x);
  request.y = static_cast<std::int16_t>(y);
  const xcb_protocol_request_t what{1, &kXTest, 2, 1};
  iovec parts[3] = {{}, {}, {&request, sizeof request}};  // xcb needs two before the first
  xcb_send_request(x_, 0, parts + 2, &what);
  xcb_flush(x_);
}

std::int64_t XHand::key(char sign) {
  const std::uint8_t code = codeOf(x_, sign);
  const auto now = std::chrono::steady_clock::now().time_since_epoch();
  fake(XCB_KEY_PRESS, code);
  fake(XCB_KEY_RELEASE, code);
  return std::chrono::duration_cast<std::chrono::nanoseconds>(now).count();
}

void XHand::moveTo(int x, int y) {
  fake(XCB_MOTION_NOTIFY, 0, x, y);
}

void XHand::press(int button) {
  fake(XCB_BUTTON_PRESS, static_cast<std::uint8_t>(button));
}

void XHand::release(int button) {
  fake(XCB_BUTTON_RELEASE, static_cast<std::uint8_t>(button));
}

}  // namespace fettle::tests
