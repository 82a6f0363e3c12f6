#include "tests/support/process.h"

#include <csignal>
#include <cstdio>
#include <cstdlib>

#include <array>
#include <stdexcept>
#include <string_view>
#include <utility>

#include <fcntl.h>
#include <poll.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

namespace fettle::tests {

namespace {

[[noreturn]] void becomeProgram(const ProgramImage& program, const ProcessOptions& options, int in, int out,
                                int err) {
  if (in >= 0) dup2(in, STDIN_FILENO);
  dup2(out, STDOUT_FILENO);
  dup2(err, STDERR_FILENO);
  if (!options.folder.empty() && chdir(options.folder.c_str()) != 0) _exit(126);
  if (options.file_limit) {
    const rlimit limit{*options.file_limit, *options.file_limit};
    setrlimit(RLIMIT_FSIZE, &limit);
    // The write then fails with EFBIG, as a full disk fails with ENOSPC, instead of ending the program.
    std::signal(SIGXFSZ, SIG_IGN);
  }
  if (options.memory_limit) {
    const rlimit limit{*options.memory_limit, *options.memory_limit};
    setrlimit(RLIMIT_AS, &limit);
  }
  program.become();
}

}  // namespace

ProgramImage::ProgramImage(std::vector<std::string> arguments,
                           const std::map<std::string, std::string>& environment)
    : arguments_(std::move(arguments)) {
  for (char** each = environ; *each != nullptr; ++each) {
    const std::string_view entry = *each;
    if (!environment.contains(std::string(entry.substr(0, entry.find('=')))))
      environment_.emplace_back(entry);
  }
  for (const auto& [name, value] : environment) environment_.push_back(name + "=" + value);
  argv_.reserve(arguments_.size() + 1);
  for (std::string& argument : arguments_) argv_.push_back(argument.data());
  argv_.push_back(nullptr);
  envp_.reserve(environment_.size() + 1);
  for (std::string& entry : environment_) envp_.push_back(entry.data());
  envp_.push_back(nullptr);
}

void ProgramImage::become() const noexcept {
  execvpe(argv_.front(), argv_.data(), envp_.data());
  _exit(127);
}

Outcome runProcess(const std::vector<std::string>& arguments, const ProcessOptions& options) {
  std::array<int, 2> out{};
  std::array<int, 2> err{};
  if (pipe2(out.data(), O_CLOEXEC) != 0 || pipe2(err.data(), O_CLOEXEC) != 0)
    throw std::runtime_error("pipe failed");
  const auto start = std::chrono::steady_clock::now();
  const int in = options.input.empty() ? -1 : open(options.input.c_str(), O_RDONLY | O_CLOEXEC);
  if (!options.input.empty() && in < 0) throw std::runtime_error("no input");
  const ProgramImage program(arguments);
  const pid_t pid = fork();
  if (pid < 0) throw std::runtime_error("fork failed");
  if (pid == 0) becomeProgram(program, options, in, out[1], err[1]);
  if (in >= 0) close(in);
  close(out[1]);
  close(err[1]);

  Outcome outcome;
  std::array<pollfd, 2> waits{{{out[0], POLLIN, 0}, {err[0], POLLIN, 0}}};
  bool watching = static_cast<bool>(options.while_running);
  int open_ends = 2;
  while (open_ends > 0) {
    poll(waits.data(), waits.size(), watching ? 1 : -1);
    for (pollfd& wait : waits) {
      if (wait.fd < 0 || wait.revents == 0) continue;
      std::array<char, 65536> buffer;
      const ssize_t n = read(wait.fd, buffer.data(), buffer.size());
      if (n > 0) {
        (wait.fd == out[0] ? outcome.out : outcome.err).append(buffer.data(), static_cast<std::size_t>(n));
      } else {
        wait.fd = -1;
        --open_ends;
      }
    }
    if (watching && open_ends > 0) watching = !options.while_running(pid);
  }
  int status = 0;
  rusage usage{};
  wait4(pid, &status, 0, &usage);
  outcome.peak_bytes = static_cast<std::size_t>(usage.ru_maxrss) * 1024;
  close(out[0]);
  close(err[0]);
  outcome.seconds = std::chrono::steady_clock::now() - start;
  outcome.status = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  return outcome;
}

}  // namespace fettle::tests
