#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace fettle::tests {

/// Another program on the display: what a file manager, a window manager and a settings daemon do, as far as
/// the window under test can notice. Connected by xcb, so that a display that ends does not end the test. One
/// thread.
class XClient {
 public:
  explicit XClient(const std::string& display);
  ~XClient();
  XClient(const XClient&) = delete;
  XClient& operator=(const XClient&) = delete;

  /// Whether there is a connection.
  [[nodiscard]] bool works() const;
  /// The top window of a class ("fettle"); 0 when there is none.
  [[nodiscard]] std::uint32_t windowOf(const std::string& window_class) const;
  /// Whether a window is on the screen.
  [[nodiscard]] bool visible(std::uint32_t window) const;

  /// Drags files to the middle of a window and drops them, by the XDND protocol, version 5
  /// (freedesktop.org/wiki/Specifications/XDND). What went wrong; empty when the window took them all the
  /// way.
  [[nodiscard]] std::string drop(std::uint32_t window, const std::vector<std::string>& paths);

  /// Lays a window of its own over all of the screen and takes it away again: what lay under it is lost.
  void coverAndUncover();

  /// What a window manager does when it is asked to minimise: hides the window and says that it did
  /// (WM_STATE, Inter-Client Communication Conventions Manual 4.1.4).
  void minimise(std::uint32_t window);
  void restore(std::uint32_t window);
  /// What a window manager does when the button that closes a window is pressed (WM_DELETE_WINDOW, same
  /// manual, 4.2.8.1).
  void askToClose(std::uint32_t window);

  /// Sets X resources ("Xft.dpi: 144"), as xrdb does. Programs started later see them.
  void setResources(const std::string& text);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace fettle::tests
