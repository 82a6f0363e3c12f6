#include "haptic/loop/cyclictest.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <csignal>
#include <cstdint>
#include <cstdlib>
#include <string_view>
#include <utility>

#include <fcntl.h>
#include <poll.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

namespace fettle::haptic {

namespace {

// Wake-ups later than this are only known by the maximum. [us]
constexpr int kHistogram_us = 20000;

std::string programPath() {
  const char* path = std::getenv("PATH");  // NOLINT(concurrency-mt-unsafe): never set
  for (std::string_view rest = path == nullptr ? "" : path; !rest.empty();) {
    const std::string_view folder = rest.substr(0, rest.find(':'));
    rest.remove_prefix(std::min(folder.size() + 1, rest.size()));
    std::string program = std::string(folder) + "/cyclictest";
    if (::access(program.c_str(), X_OK) == 0) return program;
  }
  return "";
}

// A child that outlives its parent would keep the machine busy for no purpose; a parent that has already
// ended is detected by its process id.
void endWithParent(pid_t parent) noexcept {
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (getppid() != parent) _exit(1);
}

[[noreturn]] void keepBusy() noexcept {
  constexpr std::size_t kBytes = std::size_t{32} << 20;
  void* memory = mmap(nullptr, kBytes, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  auto* words = static_cast<volatile std::uint64_t*>(memory);
  const std::size_t count = memory == MAP_FAILED ? 0 : kBytes / sizeof(std::uint64_t);
  for (std::uint64_t sum = 1;;)
    for (std::size_t i = 0; i < count; ++i) words[i] = sum += words[i] * 0x9e3779b97f4a7c15U;
}

std::int64_t numberAfter(std::string_view line, std::string_view key) {
  if (!line.starts_with(key)) return -1;
  line.remove_prefix(key.size());
  while (!line.empty() && line.front() == ' ') line.remove_prefix(1);
  std::int64_t value = -1;
  std::from_chars(line.data(), line.data() + line.size(), value);
  return value;
}

}  // namespace

bool Cyclictest::installed() {
  return !programPath().empty();
}

engine::Result<Cyclictest> Cyclictest::start(const Settings& settings) {
  const std::string program = programPath();
  if (program.empty())
    return engine::failure("cyclictest is not installed", "bench loop", "apt install rt-tests");
  std::vector<std::string> words{program, "-q",
                                 "-m",    "-t1",
                                 "-a",    std::to_string(settings.core),
                                 "-i",    std::to_string(std::lround(1e6 / settings.rate_hz)),
                                 "-l",    std::to_string(std::lround(settings.rate_hz * settings.seconds)),
                                 "-h",    std::to_string(kHistogram_us),
                                 "-p",    std::to_string(settings.priority)};
  if (settings.priority == 0) words.resize(words.size() - 2);
  std::vector<char*> arguments;
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  std::array<int, 2> ends{};
  if (pipe2(ends.data(), O_CLOEXEC) != 0)
    return engine::failure("no pipe can be created", "starting cyclictest");
  const pid_t parent = getpid();
  const pid_t child = fork();
  if (child < 0) {
    close(ends[0]);
    close(ends[1]);
    return engine::failure("no process can be started", "starting cyclictest");
  }
  if (child == 0) {
    // Only calls that are safe between fork and exec in a program with threads.
    endWithParent(parent);
    dup2(ends[1], STDOUT_FILENO);
    dup2(ends[1], STDERR_FILENO);
    execv(arguments[0], arguments.data());
    _exit(127);
  }
  close(ends[1]);
  return Cyclictest(child, ends[0]);
}

Cyclictest::Cyclictest(Cyclictest&& other) noexcept
    : child_(std::exchange(other.child_, -1)), output_(std::exchange(other.output_, -1)) {}

Cyclictest::~Cyclictest() {
  if (child_ > 0) {
    kill(child_, SIGKILL);
    waitpid(child_, nullptr, 0);
  }
  if (output_ >= 0) close(output_);
}

engine::Status Cyclictest::finish(TimingHistogram& lateness) {
  std::string text;
  std::array<char, 4096> buffer;
  for (ssize_t n; (n = read(output_, buffer.data(), buffer.size())) > 0;)
    text.append(buffer.data(), static_cast<std::size_t>(n));
  int status = 0;
  waitpid(std::exchange(child_, -1), &status, 0);
  if (WIFEXITED(status) && WEXITSTATUS(status) == 0 && addCyclictestHistogram(text, lateness)) return {};
  const std::string words = text.substr(0, text.find('\n'));
  return engine::failure("cyclictest measured nothing" + (words.empty() ? "" : ": " + words), "bench loop",
                         "run it by hand to see why");
}

bool addCyclictestHistogram(const std::string& text, TimingHistogram& lateness) {
  std::int64_t seen = 0;
  std::int64_t overflows = 0;
  std::int64_t most = 0;
  for (std::string_view rest = text; !rest.empty();) {
    const std::string_view line = rest.substr(0, rest.find('\n'));
    rest.remove_prefix(std::min(line.size() + 1, rest.size()));
    overflows = std::max(overflows, numberAfter(line, "# Histogram Overflows:"));
    most = std::max(most, numberAfter(line, "# Max Latencies:"));
    std::int64_t us = 0;
    std::int64_t count = 0;
    const auto [after, problem] = std::from_chars(line.data(), line.data() + line.size(), us);
    if (problem != std::errc{} || after == line.data() + line.size() || *after != ' ') continue;
    if (std::from_chars(after + 1, line.data() + line.size(), count).ec != std::errc{}) continue;
    seen += count;
    for (; count > 0; --count) lateness.add(1000 * us);
  }
  for (; overflows > 0; --overflows, ++seen) lateness.add(1000 * most);
  return seen > 0;
}

BusyProcesses::BusyProcesses(unsigned number) {
  const pid_t parent = getpid();
  for (unsigned i = 0; i < number; ++i) {
    const pid_t child = fork();
    if (child < 0) return;
    if (child == 0) {
      endWithParent(parent);
      keepBusy();
    }
    children_.push_back(child);
  }
}

BusyProcesses::~BusyProcesses() {
  for (const pid_t child : children_) kill(child, SIGKILL);
  for (const pid_t child : children_) waitpid(child, nullptr, 0);
}

}  // namespace fettle::haptic
