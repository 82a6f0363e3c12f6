#pragma once

#include <cstdint>
#include <vector>

#include "engine/history/history.h"
#include "engine/session/session.h"

namespace fettle::haptic {

/// Whoever keeps what is done to a field: told in order, on the main thread, and returns at once.
class SessionSink {
 public:
  virtual ~SessionSink() = default;

  /// The step that led to state `number`; steps after it are gone.
  virtual void commit(std::int64_t number, engine::Step step, std::vector<engine::JournalEntry> journal) = 0;
  /// Undo, redo: the field is in state `number`.
  virtual void moveTo(std::int64_t number, std::vector<engine::JournalEntry> journal) = 0;
  /// What is no step.
  virtual void note(std::vector<engine::JournalEntry> journal) = 0;
};

}  // namespace fettle::haptic
