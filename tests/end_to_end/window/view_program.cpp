#include "tests/end_to_end/window/view_program.h"

#include <csignal>
#include <cstdlib>

#include <array>
#include <stdexcept>
#include <utility>

#include <fcntl.h>
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <sys/wait.h>
#include <unistd.h>

#include "tests/end_to_end/report_check.h"
#include "tests/support/process.h"

namespace fettle::tests {
namespace {

constexpr int kEvents = 9;  // the program's descriptor for what it reports

std::array<int, 2> makePipe() {
  std::array<int, 2> ends{};
  if (pipe2(ends.data(), O_CLOEXEC) != 0) throw std::runtime_error("pipe failed");
  return ends;
}

}  // namespace

ViewProgram::ViewProgram(std::vector<std::string> arguments,
                         const std::map<std::string, std::string>& environment, Watched watched) {
  arguments.insert(arguments.begin(), {FETTLE_PROGRAM, "view"});
  arguments.insert(arguments.end(), {"--events", "/dev/fd/" + std::to_string(kEvents), "--json"});
  if (watched == Watched::kYes) arguments.emplace_back("--validate");
  const ProgramImage program(std::move(arguments), environment);
  const auto out = makePipe(), err = makePipe(), events = makePipe();
  pid_ = fork();
  if (pid_ < 0) throw std::runtime_error("fork failed");
  if (pid_ == 0) {
    dup2(out[1], STDOUT_FILENO);
    dup2(err[1], STDERR_FILENO);
    if (events[1] == kEvents)
      fcntl(kEvents, F_SETFD, 0);
    else
      dup2(events[1], kEvents);
    program.become();
  }
  for (const int end : {out[1], err[1], events[1]}) close(end);
  out_end_ = out[0];
  err_end_ = err[0];
  events_end_ = events[0];
  listener_ = std::jthread([this] { listen(); });
}

ViewProgram::~ViewProgram() {
  if (status_ < 0) {
    kill(pid_, SIGKILL);
    (void)wait();
  }
}

void ViewProgram::listen() {
  std::array<pollfd, 3> ends{{{out_end_, POLLIN, 0}, {err_end_, POLLIN, 0}, {events_end_, POLLIN, 0}}};
  std::string line;
  for (int open = 3; open > 0;) {
    poll(ends.data(), ends.size(), -1);
    for (std::size_t i = 0; i < ends.size(); ++i) {
      if (ends[i].fd < 0 || ends[i].revents == 0) continue;
      std::array<char, 65536> bytes;
      const ssize_t n = read(ends[i].fd, bytes.data(), bytes.size());
      if (n <= 0) {
        close(ends[i].fd);
        ends[i].fd = -1;
        --open;
      } else if (i < 2) {
        (i == 0 ? out_ : err_).append(bytes.data(), static_cast<std::size_t>(n));
      } else {
        line.append(bytes.data(), static_cast<std::size_t>(n));
        for (std::size_t end; (end = line.find('\n')) != std::string::npos; line.erase(0, end + 1)) {
          State state = State::parse(line.substr(0, end));
          const std::scoped_lock lock(mutex_);
          states_.push_back(std::move(state));
          reported_.notify_all();
        }
      }
    }
  }
  const std::scoped_lock lock(mutex_);
  ended_ = true;
  reported_.notify_all();
}

// The last state, and what changed in those before it.
std::string ViewProgram::lastReported() const {
  constexpr int kChanges = 40;
  std::string text;
  const auto without = [](State state) {
    for (const char* figure : {"texts", "words", "frames"}) state.erase(figure);
    return state;
  };
  int changes = 0;
  for (std::size_t i = states_.size(); i-- > 1 && changes < kChanges;) {
    if (!states_[i].is_object() || !states_[i - 1].is_object()) continue;
    const State before = without(states_[i - 1]), after = without(states_[i]);
    State changed;
    for (const auto& [key, value] : after.items())
      if (before.value(key, State()) != value) changed[key] = value;
    if (changed.is_null()) continue;
    text = fmt::format("changed in frame {}: {}\n", states_[i].value("frames", 0), changed.dump()) + text;
    ++changes;
  }
  State last = states_.empty() ? State() : states_.back();
  // Where texts stand is left out.
  if (last.is_object())
    for (State& written : last["texts"]) written = State(written.value("text", ""));
  return text + "last reported: " + last.dump();
}

ViewProgram::State ViewProgram::until(const std::string& what, const std::function<bool(const State&)>& is,
                                      std::chrono::seconds patience) {
  const auto end = std::chrono::steady_clock::now() + patience;
  std::unique_lock lock(mutex_);
  for (;;) {
    while (seen_ < states_.size()) {
      // Looked at without the lock: who looks may ask for what there is now.
      State state = states_[seen_];
      lock.unlock();
      if (is(state)) return state;
      lock.lock();
      ++seen_;
    }
    if (ended_) throw std::runtime_error("the program ended before: " + what + "\n" + err_);
    if (reported_.wait_until(lock, end) == std::cv_status::timeout) {
      throw std::runtime_error("never reported: " + what + "\n" + lastReported());
    }
  }
}

ViewProgram::State ViewProgram::now() {
  const std::scoped_lock lock(mutex_);
  return states_.empty() ? State() : states_.back();
}

void ViewProgram::each(const std::function<void(const State&)>& look) {
  const std::scoped_lock lock(mutex_);
  for (; shown_ < states_.size(); ++shown_) look(states_[shown_]);
  if (states_.size() > 1) states_.erase(states_.begin(), states_.end() - 1);
  shown_ = states_.size();
  // until() may wait for what is so already: a window at rest reports nothing more.
  seen_ = states_.empty() ? 0 : states_.size() - 1;
}

void ViewProgram::skipToNewest() {
  const std::scoped_lock lock(mutex_);
  seen_ = states_.empty() ? 0 : states_.size() - 1;
}

bool ViewProgram::ended() {
  const std::scoped_lock lock(mutex_);
  return ended_;
}

void ViewProgram::signal(int number) const {
  kill(pid_, number);
}

int ViewProgram::wait() {
  if (status_ < 0) {
    {
      std::unique_lock lock(mutex_);
      if (!reported_.wait_for(lock, kPatience, [this] { return ended_; }))
        throw std::runtime_error("the program never ended\n" + lastReported());
    }
    listener_.join();  // its streams are closed: it has ended, or soon has
    int status = 0;
    waitpid(pid_, &status, 0);
    status_ = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  }
  return status_;
}

ViewProgram::State ViewProgram::report() const {
  if (out_.empty()) return State::object();
  EXPECT_EQ(problemOf(nlohmann::json::parse(out_)), "");
  return State::parse(out_);
}

}  // namespace fettle::tests
