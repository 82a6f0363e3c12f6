#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace fettle::tests {

/// What a display shows: red, green, blue a pixel, row 0 on top.
struct Screen {
  int width = 0;
  int height = 0;
  std::vector<std::uint8_t> rgb;

  [[nodiscard]] const std::uint8_t* at(int x, int y) const {
    return &rgb[3 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
                     static_cast<std::size_t>(x))];
  }
};

/// A part of a screen [pixels].
struct Part {
  int x = 0, y = 0, width = 0, height = 0;
};

/// Pixels of a part in which two screens differ by more than `levels` in a channel.
[[nodiscard]] int differing(const Screen& a, const Screen& b, const Part& part, int levels = 8);

/// A virtual display of its own (Xvfb) with hands on it (xdotool), from the first free number. Ends with this
/// object; its picture is read from the file that the server draws into.
class Display {
 public:
  /// `more`: further arguments of the server.
  Display(int width, int height, const std::filesystem::path& folder,
          const std::vector<std::string>& more = {});
  ~Display();
  Display(const Display&) = delete;
  Display& operator=(const Display&) = delete;

  /// Whether there is one: Xvfb and xdotool are installed and the server started.
  [[nodiscard]] bool works() const { return !name_.empty(); }
  [[nodiscard]] const std::string& name() const { return name_; }  ///< ":99"
  [[nodiscard]] Screen screen() const;
  /// One call of xdotool.
  void hands(std::vector<std::string> arguments) const;
  /// Ends the server under the program's feet.
  void close();

 private:
  std::filesystem::path picture_;
  std::string name_;
  int pid_ = -1;
};

}  // namespace fettle::tests
