#include "tests/end_to_end/live/live_program.h"

#include <csignal>
#include <cstdlib>

#include <array>
#include <stdexcept>
#include <utility>

#include <fcntl.h>
#include <poll.h>
#include <sys/wait.h>
#include <unistd.h>

#include "tests/support/process.h"

namespace fettle::tests {

LiveProgram::LiveProgram(std::vector<std::string> arguments, const std::string& hid_folder,
                         const std::string& inverse3) {
  arguments.insert(arguments.begin(), FETTLE_PROGRAM);
  std::array<int, 2> in{};
  std::array<int, 2> out{};
  std::array<int, 2> err{};
  for (auto* p : {&in, &out, &err})
    if (pipe2(p->data(), O_CLOEXEC) != 0) throw std::runtime_error("pipe failed");
  const ProgramImage program(std::move(arguments), {{"FETTLE_FAKE_HID", hid_folder},
                                                    {"LD_LIBRARY_PATH", FETTLE_FAKE_HIDAPI_FOLDER},
                                                    {"HOME", hid_folder},  // no user's own configuration
                                                    // Nor makers' software of this machine.
                                                    {"FETTLE_LIBHD", hid_folder + "/libHD.so"},
                                                    {"FETTLE_LIBDHD", hid_folder + "/libdhd.so"},
                                                    {"FETTLE_INVERSE3", inverse3}});
  pid_ = fork();
  if (pid_ < 0) throw std::runtime_error("fork failed");
  if (pid_ == 0) {
    dup2(in[0], STDIN_FILENO);
    dup2(out[1], STDOUT_FILENO);
    dup2(err[1], STDERR_FILENO);
    program.become();
  }
  close(in[0]);
  close(out[1]);
  close(err[1]);
  keys_ = in[1];
  out_end_ = out[0];
  err_end_ = err[0];
}

LiveProgram::~LiveProgram() {
  if (status_ < 0) {
    kill(pid_, SIGKILL);
    static_cast<void>(wait());
  }
  for (const int end : {keys_, out_end_, err_end_})
    if (end >= 0) close(end);
}

void LiveProgram::press(char key) {
  if (write(keys_, &key, 1) != 1) throw std::runtime_error("nobody takes keys");
}

void LiveProgram::signal(int number) const {
  kill(pid_, number);
}

bool LiveProgram::listen(int ms) {
  std::array<pollfd, 2> ends{{{out_end_, POLLIN, 0}, {err_end_, POLLIN, 0}}};
  if (out_end_ < 0 && err_end_ < 0) return false;
  if (poll(ends.data(), ends.size(), ms) <= 0) return true;
  for (pollfd& end : ends) {
    if (end.fd < 0 || end.revents == 0) continue;
    std::array<char, 4096> buffer;
    const ssize_t n = read(end.fd, buffer.data(), buffer.size());
    const bool is_out = end.fd == out_end_;
    if (n > 0) {
      (is_out ? out_ : err_).append(buffer.data(), static_cast<std::size_t>(n));
    } else {
      close(end.fd);
      (is_out ? out_end_ : err_end_) = -1;
    }
  }
  return true;
}

bool LiveProgram::said(const std::string& text) {
  static_cast<void>(listen(0));
  const std::size_t at = err_.find(text, heard_);
  if (at == std::string::npos) return false;
  heard_ = at + text.size();
  return true;
}

bool LiveProgram::says(const std::string& text, std::chrono::seconds patience) {
  const auto deadline = std::chrono::steady_clock::now() + patience;
  for (;;) {
    const std::size_t at = err_.find(text, heard_);
    if (at != std::string::npos) {
      heard_ = at + text.size();
      return true;
    }
    if (std::chrono::steady_clock::now() > deadline || !listen(50)) return false;
  }
}

int LiveProgram::wait() {
  while (listen(1000)) {
  }
  int status = 0;
  waitpid(pid_, &status, 0);
  return status_ = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

nlohmann::json LiveProgram::report() const {
  auto report = nlohmann::json::parse(out_, nullptr, false);
  return report.is_discarded() ? nlohmann::json() : report;
}

}  // namespace fettle::tests
