#include "tests/end_to_end/window/x_client.h"

#include <cstdlib>
#include <cstring>

#include <algorithm>
#include <array>
#include <chrono>
#include <map>
#include <optional>

#include <poll.h>
#include <xcb/xcb.h>

namespace fettle::tests {
namespace {

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;

struct Free {
  void operator()(void* p) const noexcept { std::free(p); }
};
template <class T>
using Reply = std::unique_ptr<T, Free>;
using Event = Reply<xcb_generic_event_t>;

constexpr auto kPatience = 60s;
constexpr auto kStillThere = 100ms;  // between two looks whether a window is there
constexpr std::uint32_t kXdndVersion = 5;

std::string uriOf(const std::string& path) {
  static constexpr const char* kHex = "0123456789ABCDEF";
  std::string uri = "file://";
  for (const char c : path) {
    const auto byte = static_cast<unsigned char>(c);
    const bool plain = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
                       std::strchr("-_.~/", c) != nullptr;
    if (plain) {
      uri += c;
    } else {
      uri += '%';
      uri += kHex[byte >> 4U];
      uri += kHex[byte & 15U];
    }
  }
  return uri + "\r\n";
}

}  // namespace

struct XClient::Impl {
  xcb_connection_t* x = nullptr;
  xcb_window_t root = 0;
  xcb_window_t own = 0;
  std::map<std::string, xcb_atom_t> atoms;

  xcb_atom_t atom(const std::string& name) {
    const auto found = atoms.find(name);
    if (found != atoms.end()) return found->second;
    const Reply<xcb_intern_atom_reply_t> reply(xcb_intern_atom_reply(
        x, xcb_intern_atom(x, 0, static_cast<std::uint16_t>(name.size()), name.c_str()), nullptr));
    return atoms[name] = reply ? reply->atom : xcb_atom_t{XCB_ATOM_NONE};
  }
  [[nodiscard]] std::string property(xcb_window_t window, xcb_atom_t name) const {
    const Reply<xcb_get_property_reply_t> reply(xcb_get_property_reply(
        x, xcb_get_property(x, 0, window, name, XCB_GET_PROPERTY_TYPE_ANY, 0, 1024), nullptr));
    if (!reply) return {};
    return {static_cast<const char*>(xcb_get_property_value(reply.get())),
            static_cast<std::size_t>(xcb_get_property_value_length(reply.get()))};
  }
  void send(xcb_window_t to, const std::string& type, const std::array<std::uint32_t, 5>& data) {
    xcb_client_message_event_t event{};
    event.response_type = XCB_CLIENT_MESSAGE;
    event.format = 32;
    event.window = to;
    event.type = atom(type);
    std::copy(data.begin(), data.end(), event.data.data32);
    xcb_send_event(x, 0, to, XCB_EVENT_MASK_NO_EVENT, reinterpret_cast<const char*>(&event));
    xcb_flush(x);
  }
  [[nodiscard]] bool exists(xcb_window_t window) const {
    return Reply<xcb_get_window_attributes_reply_t>(
               xcb_get_window_attributes_reply(x, xcb_get_window_attributes(x, window), nullptr)) != nullptr;
  }
  // The next event, or nothing when none comes in time.
  [[nodiscard]] Event next(Clock::time_point until) const {
    for (;;) {
      if (Event event(xcb_poll_for_event(x)); event) return event;
      const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(until - Clock::now()).count();
      if (left <= 0 || xcb_connection_has_error(x) != 0) return nullptr;
      pollfd wait{xcb_get_file_descriptor(x), POLLIN, 0};
      poll(&wait, 1, static_cast<int>(left));
    }
  }
  void setState(xcb_window_t window, std::uint32_t state) {
    const std::array<std::uint32_t, 2> value{state, XCB_NONE};
    xcb_change_property(x, XCB_PROP_MODE_REPLACE, window, atom("WM_STATE"), atom("WM_STATE"), 32, 2,
                        value.data());
  }
  void answer(const xcb_selection_request_event_t& asked, const std::string& text) {
    xcb_change_property(x, XCB_PROP_MODE_REPLACE, asked.requestor, asked.property, asked.target, 8,
                        static_cast<std::uint32_t>(text.size()), text.data());
    xcb_selection_notify_event_t done{};
    done.response_type = XCB_SELECTION_NOTIFY;
    done.time = asked.time;
    done.requestor = asked.requestor;
    done.selection = asked.selection;
    done.target = asked.target;
    done.property = asked.property;
    xcb_send_event(x, 0, asked.requestor, XCB_EVENT_MASK_NO_EVENT, reinterpret_cast<const char*>(&done));
    xcb_flush(x);
  }
};

XClient::XClient(const std::string& display) : impl_(std::make_unique<Impl>()) {
  impl_->x = xcb_connect(display.c_str(), nullptr);
  if (!works()) return;
  const xcb_screen_t* screen = xcb_setup_roots_iterator(xcb_get_setup(impl_->x)).data;
  impl_->root = screen->root;
  impl_->own = xcb_generate_id(impl_->x);
  xcb_create_window(impl_->x, XCB_COPY_FROM_PARENT, impl_->own, impl_->root, 0, 0, 1, 1, 0,
                    XCB_WINDOW_CLASS_INPUT_ONLY, XCB_COPY_FROM_PARENT, 0, nullptr);
  xcb_flush(impl_->x);
}

XClient::~XClient() {
  xcb_disconnect(impl_->x);
}

bool XClient::works() const {
  return impl_->x != nullptr && xcb_connection_has_error(impl_->x) == 0;
}

std::uint32_t XClient::windowOf(const std::string& window_class) const {
  const Reply<xcb_query_tree_reply_t> tree(
      xcb_query_tree_reply(impl_->x, xcb_query_tree(impl_->x, impl_->root), nullptr));
  if (!tree) return 0;
  const xcb_window_t* children = xcb_query_tree_children(tree.get());
  for (int i = 0; i < xcb_query_tree_children_length(tree.get()); ++i) {
    // Instance and class, each ended by a zero.
    const std::string name = impl_->property(children[i], XCB_ATOM_WM_CLASS);
    if (name.substr(0, name.find('\0')) == window_class) return children[i];
  }
  return 0;
}

bool XClient::visible(std::uint32_t window) const {
  const Reply<xcb_get_window_attributes_reply_t> reply(
      xcb_get_window_attributes_reply(impl_->x, xcb_get_window_attributes(impl_->x, window), nullptr));
  return reply && reply->map_state == XCB_MAP_STATE_VIEWABLE;
}

std::string XClient::drop(std::uint32_t window, const std::vector<std::string>& paths) {
  Impl& c = *impl_;
  if (c.property(window, c.atom("XdndAware")).empty()) return "the window takes no drops";
  const Reply<xcb_get_geometry_reply_t> size(
      xcb_get_geometry_reply(c.x, xcb_get_geometry(c.x, window), nullptr));
  if (!size) return "there is no such window";
  const auto x = static_cast<std::uint32_t>(size->x + size->width / 2);
  const auto y = static_cast<std::uint32_t>(size->y + size->height / 2);
  std::string uris;
  for (const std::string& path : paths) uris += uriOf(path);

  xcb_set_selection_owner(c.x, c.own, c.atom("XdndSelection"), XCB_CURRENT_TIME);
  c.send(window, "XdndEnter", {c.own, kXdndVersion << 24U, c.atom("text/uri-list"), 0, 0});
  c.send(window, "XdndPosition", {c.own, 0, x << 16U | y, XCB_CURRENT_TIME, c.atom("XdndActionCopy")});
  const Clock::time_point until = Clock::now() + kPatience;
  bool dropped = false;
  for (;;) {
    const Event event = c.next(std::min(until, Clock::now() + kStillThere));
    if (!event) {
      if (!c.exists(window)) return "the window has gone";
      if (Clock::now() >= until) break;
      continue;
    }
    const int kind = event->response_type & 0x7f;
    if (kind == XCB_SELECTION_REQUEST) {
      c.answer(reinterpret_cast<const xcb_selection_request_event_t&>(*event), uris);
    } else if (kind == XCB_CLIENT_MESSAGE) {
      const auto& message = reinterpret_cast<const xcb_client_message_event_t&>(*event);
      if (message.type == c.atom("XdndStatus") && !dropped) {
        if ((message.data.data32[1] & 1U) == 0) return "the window refuses the drop";
        c.send(window, "XdndDrop", {c.own, 0, XCB_CURRENT_TIME, 0, 0});
        dropped = true;
      } else if (message.type == c.atom("XdndFinished")) {
        // Bit 0 says so; GLFW 3.3 puts the number of bytes it took there.
        return message.data.data32[1] != 0 ? "" : "the window did not take the drop";
      }
    }
  }
  return dropped ? "the window never finished" : "the window never answered";
}

void XClient::coverAndUncover() {
  const xcb_screen_t* const screen = xcb_setup_roots_iterator(xcb_get_setup(impl_->x)).data;
  const xcb_window_t cover = xcb_generate_id(impl_->x);
  const std::array<std::uint32_t, 2> values{screen->white_pixel, 1};
  xcb_create_window(impl_->x, XCB_COPY_FROM_PARENT, cover, impl_->root, 0, 0, screen->width_in_pixels,
                    screen->height_in_pixels, 0, XCB_WINDOW_CLASS_INPUT_OUTPUT, XCB_COPY_FROM_PARENT,
                    XCB_CW_BACK_PIXEL | XCB_CW_OVERRIDE_REDIRECT, values.data());
  xcb_map_window(impl_->x, cover);
  xcb_destroy_window(impl_->x, cover);
  // Answered: the server has done it.
  (void)impl_->exists(cover);
}

void XClient::minimise(std::uint32_t window) {
  impl_->setState(window, 3);  // IconicState
  xcb_unmap_window(impl_->x, window);
  xcb_flush(impl_->x);
}

void XClient::restore(std::uint32_t window) {
  impl_->setState(window, 1);  // NormalState
  xcb_map_window(impl_->x, window);
  xcb_flush(impl_->x);
}

void XClient::askToClose(std::uint32_t window) {
  impl_->send(window, "WM_PROTOCOLS", {impl_->atom("WM_DELETE_WINDOW"), XCB_CURRENT_TIME, 0, 0, 0});
}

void XClient::setResources(const std::string& text) {
  xcb_change_property(impl_->x, XCB_PROP_MODE_REPLACE, impl_->root, XCB_ATOM_RESOURCE_MANAGER,
                      XCB_ATOM_STRING, 8, static_cast<std::uint32_t>(text.size()), text.data());
  // The server has it when it has answered.
  const Reply<xcb_get_input_focus_reply_t> round_trip(
      xcb_get_input_focus_reply(impl_->x, xcb_get_input_focus(impl_->x), nullptr));
}

}  // namespace fettle::tests
