#pragma once

#include <map>
#include <string>

namespace fettle::tests {

/// Holds up frames of the window where they are about to be shown: what hands do meanwhile comes to the
/// program all at once, in the next frame. The layer in lose_device_layer.cpp asks here before each frame.
///
/// On the socket, a byte each: the layer says 'w' when a frame waits; 'h' makes frames wait from the next one
/// on, 's' shows the one that waits, 'f' shows it and all after it.
class FrameGate {
 public:
  /// `path`: of the socket, at most 100 bytes.
  explicit FrameGate(const std::string& path);
  ~FrameGate();
  FrameGate(const FrameGate&) = delete;
  FrameGate& operator=(const FrameGate&) = delete;

  /// What the program is to be started with.
  [[nodiscard]] std::map<std::string, std::string> environment() const;

  /// Waits until the program has a frame that waits. False: it has ended. Throws when neither comes.
  [[nodiscard]] bool hold();
  /// Shows the frame that waits, until the next one does. Returns and throws as hold().
  [[nodiscard]] bool step();
  /// Frames are shown as they come.
  void release();
  /// After a program has ended: the next one to show a frame is waited for.
  void disconnect();

 private:
  void say(char what) const;
  [[nodiscard]] bool waits();

  std::string path_;
  int listening_ = -1;
  int program_ = -1;
};

}  // namespace fettle::tests
