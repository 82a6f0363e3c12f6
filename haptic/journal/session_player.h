#pragma once

#include <cstdint>

#include "engine/base/error.h"
#include "engine/base/job.h"
#include "engine/field/version.h"
#include "engine/session/session.h"
#include "haptic/base/sound_tick.h"
#include "haptic/base/strokes.h"
#include "haptic/scene/scene.h"

namespace fettle::haptic {

/// Result of replaying a session's journal.
struct PlayedSession {
  engine::Version field;     ///< the state at its end, upright
  std::int64_t state = 0;    ///< its number
  std::int64_t loops = 0;    ///< times the session was opened and edited
  std::int64_t ticks = 0;    ///< played
  std::int64_t steps = 0;    ///< made, those undone later included
  std::int64_t filters = 0;  ///< adopted into the field
};

/// Hears the ticks of a session that is replayed.
class TickListener {
 public:
  virtual ~TickListener() = default;
  /// A loop begins, or another scene in a loop that runs.
  virtual void sceneIs(const Scene& scene) = 0;
  /// After each tick. An error ends the replay.
  [[nodiscard]] virtual engine::Status tickIs(const SoundTick& heard, const StrokeSample& input) = 0;
};

/// Reproduces a session's state from the scan and the journal alone: every tick through the loop's own code,
/// every filter computed and adopted in the recorded rounds, undo and redo at the recorded points. The result
/// is bit-identical on any machine. The steps stored in the session are not read, except those before the
/// journal: a command that wrote the session made them, and they are used as stored (journalStart).
///
/// Errors: kInput for a journal that cannot be read, lacks ticks (the recorder's ring was full: recorded
/// there), or is inconsistent; kFailed when memory runs out; kCancelled. Progress: one stage "replaying",
/// steps = journal entries. Thread: any.
/// The session's history must hold the states up to journalStart(). With a `listener` every scene has sound, which changes no bit of
/// the field.
[[nodiscard]] engine::Result<PlayedSession> playSession(const engine::Session& session,
                                                        engine::JobControl& job,
                                                        TickListener* listener = nullptr);

/// The state with which the journal begins: 0, unless a command wrote the session with its steps. 0 for an
/// empty journal and one that cannot be read.
[[nodiscard]] std::int64_t journalStart(const engine::Session& session);

}  // namespace fettle::haptic
