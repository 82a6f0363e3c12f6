#pragma once

#include <cstdint>
#include <vector>

#include "engine/history/history.h"
#include "engine/session/session.h"

namespace fettle::haptic {

/// Receives what is done to a field, in order, on the main thread; returns immediately.
class SessionSink {
 public:
  virtual ~SessionSink() = default;

  /// The step that led to state `number`; steps after it are discarded.
  virtual void commit(std::int64_t number, engine::Step step, std::vector<engine::JournalEntry> journal) = 0;
  /// Undo, redo: the field is in state `number`.
  virtual void moveTo(std::int64_t number, std::vector<engine::JournalEntry> journal) = 0;
  /// Journal entries without a step.
  virtual void note(std::vector<engine::JournalEntry> journal) = 0;
};

}  // namespace fettle::haptic
