#pragma once

#include <condition_variable>
#include <cstdint>
#include <mutex>
#include <optional>

#include "haptic/loop/adopt_filtered.h"
#include "haptic/loop/messages.h"

namespace fettle::app {

/// Where a worker that brings a filter's result into the live field meets the main thread, which carries its
/// questions to the loop and the loop's answers back. One question at a time.
///
/// Threading: the functions of AdoptionPort on one worker at a time, the others on main.
class AdoptionMailbox final : public haptic::AdoptionPort {
 public:
  engine::Result<engine::Version> snapshot() override;
  engine::Result<Answer> adopt(engine::Version version) override;
  void pause() override;

  /// The command that asks the loop what the worker asked, once for each question. A snapshot takes the next
  /// id and counts it up; the adoption after it carries the same.
  [[nodiscard]] std::optional<haptic::LoopCommand> takeCommand(std::uint64_t& next_id);
  /// Wakes the worker with the live version; without a question it has no effect.
  void answer(engine::Version live, bool adopted);

  /// A worker that waits, or asks from now on, gets kCancelled, until open().
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
  engine::Version version_;  // of the question
  std::optional<Answer> answer_;
};

}  // namespace fettle::app
