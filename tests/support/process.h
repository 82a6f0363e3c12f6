#pragma once

#include <chrono>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace fettle::tests {

/// What a finished program left behind.
struct Outcome {
  int status = -1;  ///< exit status; 128 + signal when a signal ended it
  std::string out;
  std::string err;
  std::chrono::duration<double> seconds{};
  std::size_t peak_bytes =
      0;  ///< most memory it held at once (ru_maxrss); of a program with children, its own
};

struct ProcessOptions {
  std::string folder;                       ///< working folder; empty = the test's own
  std::optional<std::size_t> file_limit;    ///< largest file it may write [bytes] (RLIMIT_FSIZE)
  std::optional<std::size_t> memory_limit;  ///< address space [bytes] (RLIMIT_AS)
  std::string input;  ///< what standard input gives, from a file; empty = the test's own
  /// Called again and again with the process id while the program runs, until it returns true.
  std::function<bool(int pid)> while_running;
};

/// A program with its arguments and environment, prepared before a fork: the child of a process with threads may not
/// allocate, as another thread may hold the allocator's lock at the fork.
class ProgramImage {
 public:
  /// `environment` is added to this process's own, or replaces what it has of that name.
  explicit ProgramImage(std::vector<std::string> arguments,
                        const std::map<std::string, std::string>& environment = {});
  ProgramImage& operator=(ProgramImage&&) = delete;

  /// Becomes the program; ends with 127 where that fails. Allocates nothing.
  [[noreturn]] void become() const noexcept;

 private:
  std::vector<std::string> arguments_, environment_;
  std::vector<char*> argv_, envp_;
};

/// Runs a program to its end and collects what it printed.
[[nodiscard]] Outcome runProcess(const std::vector<std::string>& arguments,
                                 const ProcessOptions& options = {});

}  // namespace fettle::tests
