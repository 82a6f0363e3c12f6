#pragma once

#include <condition_variable>
#include <cstdint>
#include <mutex>
#include <optional>

#include "haptic/loop/adopt_filtered.h"
#include "haptic/loop/messages.h"

namespace fettle::app {

/// Passes the requests of a worker that adopts a filter's result to the main thread, which sends them to the
/// loop and returns the loop's answers. One request at a time.
///
/// Threading: the functions of AdoptionPort on one worker at a time, the others on main.
class AdoptionMailbox final : public haptic::AdoptionPort {
 public:
  engine::Result<engine::Version> snapshot() override;
  engine::Result<Answer> adopt(engine::Version version) override;
  void pause() override;

  /// The loop command for the worker's request, once per request. A snapshot takes the next id and increments
  /// it; the adoption after it has the same id.
  [[nodiscard]] std::optional<haptic::LoopCommand> takeCommand(std::uint64_t& next_id);
  /// Wakes the worker with the live version; no effect without a request.
  void answer(engine::Version live, bool adopted);

  /// A worker that waits, or makes a request from now on, gets kCancelled, until open().
  void close();
  void open();

 private:
  enum class Question : std::uint8_t { kNone, kSnapshot, kAdopt };
  [[nodiscard]] engine::Result<Answer> ask(Question question, engine::Version given);

  std::mutex mutex_;
  std::condition_variable answered_;
  Question question_ = Question::kNone;
  bool sent_ = false;
  bool closed_ = false;
  std::uint64_t id_ = 0;     // of the newest snapshot
  engine::Version version_;  // of the request
  std::optional<Answer> answer_;
};

}  // namespace fettle::app
