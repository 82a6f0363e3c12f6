#pragma once

#include <memory>
#include <optional>
#include <string>

#include "render/window/pen_decoder.h"

namespace fettle::render {

/// How the pens of tablets press and lean over a window. GLFW reports a pen's place and its tip as those of a mouse; what else it
/// measures is read here, over a connection of its own to the same X server. Pens that are plugged in later are found.
/// Threading: main.
class Tablet {
 public:
  /// The server that the environment names; null where there is none, or one without XInput 2.
  [[nodiscard]] static std::unique_ptr<Tablet> open(xcb_window_t window);
  /// Over a connection that is already there, which it closes in the end; null as above.
  [[nodiscard]] static std::unique_ptr<Tablet> over(xcb_connection_t* connection, xcb_window_t window);

  /// The pen whose tip is down, by what the server has sent so far. Waits for nothing.
  [[nodiscard]] std::optional<Pen> pen();
  /// The same by all that the server has noticed so far: waits for its answer, if there are pens. For the press of a button:
  /// whether it is a pen's must be known.
  [[nodiscard]] std::optional<Pen> penOfPress();
  /// Whether any is plugged in.
  [[nodiscard]] bool hasPens() const { return !decoder_.pens().empty(); }

 private:
  struct Close {
    void operator()(xcb_connection_t* connection) const { xcb_disconnect(connection); }
  };
  Tablet(xcb_connection_t* connection, xcb_window_t window) : connection_(connection), window_(window) {}
  [[nodiscard]] bool start();
  void findPens();
  void takeAll();

  std::unique_ptr<xcb_connection_t, Close> connection_;
  const xcb_window_t window_;
  std::uint8_t extension_ = 0;
  PenDecoder decoder_;
};

}  // namespace fettle::render
