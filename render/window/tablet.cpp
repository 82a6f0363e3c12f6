#include "render/window/tablet.h"

#include <array>
#include <cstdlib>
#include <string_view>
#include <vector>

namespace fettle::render {
namespace {

struct Free {
  void operator()(void* reply) const { std::free(reply); }
};
template <class T>
using Reply = std::unique_ptr<T, Free>;

constexpr std::uint32_t kOfPens = XCB_INPUT_XI_EVENT_MASK_MOTION | XCB_INPUT_XI_EVENT_MASK_BUTTON_PRESS |
                                  XCB_INPUT_XI_EVENT_MASK_BUTTON_RELEASE |
                                  XCB_INPUT_XI_EVENT_MASK_DEVICE_CHANGED;

// As a request has it.
struct Selected {
  xcb_input_event_mask_t of;
  std::uint32_t events;
};
static_assert(sizeof(Selected) == sizeof(xcb_input_event_mask_t) + sizeof(std::uint32_t));

void select(xcb_connection_t* connection, xcb_window_t window, const std::vector<Selected>& all) {
  xcb_input_xi_select_events(connection, window, static_cast<std::uint16_t>(all.size()),
                             reinterpret_cast<const xcb_input_event_mask_t*>(all.data()));
}

// Of a name that a driver of pens has brought; none where no driver has.
PenLabels labelsOf(xcb_connection_t* connection) {
  constexpr std::array<std::string_view, 3> kNames{"Abs Pressure", "Abs Tilt X", "Abs Tilt Y"};
  std::array<xcb_intern_atom_cookie_t, kNames.size()> asked;
  for (std::size_t i = 0; i < kNames.size(); ++i)
    asked[i] = xcb_intern_atom(connection, 1, static_cast<std::uint16_t>(kNames[i].size()), kNames[i].data());
  std::array<xcb_atom_t, kNames.size()> atoms{};
  for (std::size_t i = 0; i < kNames.size(); ++i)
    if (const Reply<xcb_intern_atom_reply_t> reply{xcb_intern_atom_reply(connection, asked[i], nullptr)})
      atoms[i] = reply->atom;
  return {atoms[0], atoms[1], atoms[2]};
}

}  // namespace

std::unique_ptr<Tablet> Tablet::open(xcb_window_t window) {
  return over(xcb_connect(nullptr, nullptr), window);
}

std::unique_ptr<Tablet> Tablet::over(xcb_connection_t* connection, xcb_window_t window) {
  std::unique_ptr<Tablet> tablet(new Tablet(connection, window));
  return tablet->start() ? std::move(tablet) : nullptr;
}

bool Tablet::start() {
  xcb_connection_t* const connection = connection_.get();
  if (xcb_connection_has_error(connection) != 0) return false;
  const xcb_query_extension_reply_t* const input = xcb_get_extension_data(connection, &xcb_input_id);
  if (input == nullptr || input->present == 0) return false;
  extension_ = input->major_opcode;
  const Reply<xcb_input_xi_query_version_reply_t> version{
      xcb_input_xi_query_version_reply(connection, xcb_input_xi_query_version(connection, 2, 0), nullptr)};
  if (!version || version->major_version < 2) return false;
  const xcb_screen_iterator_t screens = xcb_setup_roots_iterator(xcb_get_setup(connection));
  if (screens.rem > 0)
    select(connection, screens.data->root, {{{XCB_INPUT_DEVICE_ALL, 1}, XCB_INPUT_XI_EVENT_MASK_HIERARCHY}});
  findPens();
  return xcb_connection_has_error(connection) == 0;
}

void Tablet::findPens() {
  xcb_connection_t* const connection = connection_.get();
  const PenLabels labels = labelsOf(connection);
  const Reply<xcb_input_xi_query_device_reply_t> devices{xcb_input_xi_query_device_reply(
      connection, xcb_input_xi_query_device(connection, XCB_INPUT_DEVICE_ALL), nullptr)};
  if (!devices) return;
  decoder_.describe(*devices, labels);
  std::vector<Selected> all;
  for (const xcb_input_device_id_t id : decoder_.pens()) all.push_back({{id, 1}, kOfPens});
  if (!all.empty()) select(connection, window_, all);
  xcb_flush(connection);
}

void Tablet::takeAll() {
  bool changed = false;
  while (const Reply<xcb_generic_event_t> event{xcb_poll_for_event(connection_.get())}) {
    if ((event->response_type & 0x7FU) != XCB_GE_GENERIC) continue;
    const auto& generic = *reinterpret_cast<const xcb_ge_generic_event_t*>(event.get());
    if (generic.extension != extension_) continue;
    changed = changed || generic.event_type == XCB_INPUT_HIERARCHY ||
              generic.event_type == XCB_INPUT_DEVICE_CHANGED;
    decoder_.take(generic);
  }
  if (changed) findPens();
}

std::optional<Pen> Tablet::pen() {
  takeAll();
  return decoder_.down();
}

std::optional<Pen> Tablet::penOfPress() {
  if (hasPens()) {
    const Reply<xcb_get_input_focus_reply_t> answered{
        xcb_get_input_focus_reply(connection_.get(), xcb_get_input_focus(connection_.get()), nullptr)};
  }
  return pen();
}

}  // namespace fettle::render
