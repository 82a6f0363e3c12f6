#include "tests/end_to_end/shell_line.h"

#include <csignal>

#include <array>
#include <chrono>
#include <cstddef>
#include <stdexcept>
#include <string_view>

#include <poll.h>
#include <pty.h>
#include <sys/ioctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include "tests/support/process.h"

namespace fettle::tests {

namespace {

constexpr const char* kShow = "\x18\x18";  // Ctrl-X Ctrl-X

class ShellTerminal {
 public:
  explicit ShellTerminal(const ProgramImage& shell) {
    winsize size{};
    size.ws_row = 50;
    size.ws_col = 500;  // no line is folded
    pid_ = forkpty(&terminal_, nullptr, nullptr, &size);
    if (pid_ < 0) throw std::runtime_error("no terminal");
    if (pid_ == 0) shell.become();
  }
  ShellTerminal& operator=(ShellTerminal&&) = delete;
  ~ShellTerminal() {
    close(terminal_);
    kill(pid_, SIGKILL);
    waitpid(pid_, nullptr, 0);
  }

  void type(std::string_view text) const {
    while (!text.empty()) {
      const ssize_t written = write(terminal_, text.data(), text.size());
      if (written <= 0) throw std::runtime_error("the shell has ended");
      text.remove_prefix(static_cast<std::size_t>(written));
    }
  }

  // The text between the next '<' and '>'.
  std::string shown() {
    const auto begun = std::chrono::steady_clock::now();
    while (std::chrono::steady_clock::now() - begun < std::chrono::seconds(20)) {
      const std::size_t first = read_.find('<');
      const std::size_t last = first == std::string::npos ? first : read_.find('>', first);
      if (last != std::string::npos) {
        std::string text = read_.substr(first + 1, last - first - 1);
        read_.erase(0, last + 1);
        return text;
      }
      pollfd wait{terminal_, POLLIN, 0};
      poll(&wait, 1, 100);
      if (wait.revents == 0) continue;
      std::array<char, 4096> buffer;
      const ssize_t n = ::read(terminal_, buffer.data(), buffer.size());
      if (n <= 0) break;
      read_.append(buffer.data(), static_cast<std::size_t>(n));
    }
    return "";
  }

 private:
  int terminal_ = -1;
  pid_t pid_ = -1;
  std::string read_;
};

}  // namespace

std::vector<std::string> completedInTerminal(const std::vector<std::string>& shell,
                                             const std::vector<std::string>& setup,
                                             const std::vector<std::string>& typed) {
  ShellTerminal terminal(ProgramImage(shell, {{"TERM", "dumb"}}));
  for (const std::string& line : setup) terminal.type(line + "\n");
  std::vector<std::string> lines;
  lines.reserve(typed.size());
  for (const std::string& text : typed) {
    terminal.type("\x15" + text + "\t " + kShow);  // Ctrl-U: an empty line
    lines.push_back(terminal.shown());
  }
  return lines;
}

}  // namespace fettle::tests
