#pragma once

#include <cstdint>

#include "engine/base/error.h"
#include "engine/base/job.h"
#include "engine/field/version.h"
#include "engine/session/session.h"

namespace fettle::haptic {

/// What a session's journal came to.
struct PlayedSession {
  engine::Version field;     ///< the state at its end, the right way up
  std::int64_t state = 0;    ///< its number
  std::int64_t loops = 0;    ///< times the session was opened and worked on
  std::int64_t ticks = 0;    ///< played
  std::int64_t steps = 0;    ///< made, those undone later included
  std::int64_t filters = 0;  ///< brought into the field
};

/// Makes a session's state again from the scan and the journal alone: every tick through the loop's own code,
/// every filter computed and adopted round by round as it was, undo and redo where they were. Same session,
/// same bits, on any machine. The steps stored in the session are not looked at, but for those before the
/// journal: a command that wrote the session made them, and they are taken as stored (journalStart).
///
/// Errors: kInput for a journal that cannot be read, lacks ticks (the recorder's ring overran: said there),
/// or does not fit itself; kFailed when memory runs out; kCancelled. Progress: one stage "replaying", steps =
/// journal entries. Thread: any.
/// States up to journalStart() must be held by the session's history.
[[nodiscard]] engine::Result<PlayedSession> playSession(const engine::Session& session,
                                                        engine::JobControl& job);

/// The state that the journal begins on: 0, unless the session came from a command with its work done. 0 for
/// an empty journal and one that cannot be read.
[[nodiscard]] std::int64_t journalStart(const engine::Session& session);

}  // namespace fettle::haptic
