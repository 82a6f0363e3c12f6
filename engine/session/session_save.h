#pragma once

#include <string>

#include "engine/session/session.h"
#include "engine/session/session_lock.h"

namespace fettle::engine {

/// Waits this long for a reader that brings a session in order; a writer will not be waited for.
inline constexpr int kLockWaitMs = 1000;

/// The right to write a session to `real_path` (links followed). Error: someone else has it.
[[nodiscard]] Result<SessionLock> lockSession(const std::string& real_path, const std::string& shown);

/// saveSession for a caller who holds the lock of realPath(path).
[[nodiscard]] Result<SessionSize> saveSessionLocked(const Session& session, const std::string& path,
                                                    JobControl& job);

}  // namespace fettle::engine
