#include "tests/end_to_end/window/display.h"

#include <cstdlib>

#include <algorithm>
#include <fstream>
#include <iterator>
#include <thread>

#include <fcntl.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include "tests/support/process.h"

namespace fettle::tests {

int differing(const Screen& a, const Screen& b, const Part& part, int levels) {
  int count = 0;
  for (int y = part.y; y < part.y + part.height; ++y)
    for (int x = part.x; x < part.x + part.width; ++x) {
      const std::uint8_t *p = a.at(x, y), *q = b.at(x, y);
      int most = 0;
      for (int c = 0; c < 3; ++c) most = std::max(most, std::abs(p[c] - q[c]));
      count += most > levels;
    }
  return count;
}

Display::Display(int width, int height, const std::filesystem::path& folder,
                 const std::vector<std::string>& more)
    : picture_(folder / "Xvfb_screen0") {
  int ends[2];
  if (pipe2(ends, O_CLOEXEC) != 0) return;
  const std::string size = std::to_string(width) + "x" + std::to_string(height) + "x24";
  // On descriptor 9 the server reports its display's number.
  std::vector<std::string> words{"Xvfb",   "-displayfd", "9",         "-screen", "0",       size,
                                 "-fbdir", folder,       "-nolisten", "tcp",     "-noreset"};
  words.insert(words.end(), more.begin(), more.end());
  std::vector<char*> arguments;
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  pid_ = fork();
  if (pid_ == 0) {
    dup2(ends[1], 9);
    const int quiet = open("/dev/null", O_WRONLY);
    dup2(quiet, STDERR_FILENO);
    execvp(arguments.front(), arguments.data());
    _exit(127);
  }
  ::close(ends[1]);
  char c = 0;
  std::string digits;
  while (read(ends[0], &c, 1) == 1 && c != '\n') digits += c;
  ::close(ends[0]);
  if (!digits.empty()) name_ = ":" + digits;
}

Display::~Display() {
  close();
}

void Display::close() {
  if (pid_ <= 0) return;
  kill(pid_, SIGTERM);
  waitpid(pid_, nullptr, 0);
  pid_ = -1;
}

// X window dump: 32-bit numbers, most significant byte first, then colours, then rows of 32-bit pixels.
Screen Display::screen() const {
  std::ifstream in(picture_, std::ios::binary);
  const std::string file{std::istreambuf_iterator<char>(in), {}};
  const auto number = [&](std::size_t i) {
    std::uint32_t v = 0;
    for (std::size_t k = 0; k < 4; ++k) v = v << 8 | static_cast<std::uint8_t>(file.at(4 * i + k));
    return v;
  };
  Screen screen;
  if (file.size() < 100) return screen;
  screen.width = static_cast<int>(number(4));
  screen.height = static_cast<int>(number(5));
  const std::size_t stride = number(12), data = number(0) + std::size_t{12} * number(19);
  const auto height = static_cast<std::size_t>(screen.height), width = static_cast<std::size_t>(screen.width);
  if (file.size() < data + stride * height) return {};
  screen.rgb.reserve(3 * width * height);
  for (std::size_t y = 0; y < height; ++y)
    for (std::size_t x = 0; x < width; ++x)
      for (const std::size_t channel : {2U, 1U, 0U})
        screen.rgb.push_back(static_cast<std::uint8_t>(file[data + y * stride + 4 * x + channel]));
  return screen;
}

void Display::hands(std::vector<std::string> arguments) const {
  arguments.insert(arguments.begin(), "xdotool");
  const Outcome outcome = runProcess(arguments);
  EXPECT_EQ(outcome.status, 0) << outcome.err;
}

}  // namespace fettle::tests
