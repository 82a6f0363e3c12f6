#pragma once

#include <cstdint>
#include <string>

struct xcb_connection_t;

namespace fettle::tests {

/// A hand on a display that costs no process per movement, so that what it measures is the window: key presses, buttons and
/// movements by the XTEST extension (X Consortium, "XTEST Extension Protocol", 2.2). One thread.
class XHand {
 public:
  explicit XHand(const std::string& display);
  ~XHand();
  XHand& operator=(XHand&&) = delete;

  /// Whether there is a connection, and the display has the extension.
  [[nodiscard]] bool works() const { return x_ != nullptr && opcode_ != 0; }
  /// Presses and releases the key of an unshifted sign. Returns the time just before [steady clock, ns].
  std::int64_t key(char sign);
  void moveTo(int x, int y);
  void press(int button);
  void release(int button);

 private:
  // `type`: of the event, `detail`: key code or button.
  void fake(std::uint8_t type, std::uint8_t detail, int x = 0, int y = 0);

  xcb_connection_t* x_ = nullptr;
  std::uint32_t root_ = 0;
  std::uint8_t opcode_ = 0;
};

}  // namespace fettle::tests
