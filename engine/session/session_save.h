#pragma once

#include <string>

#include "engine/session/session.h"
#include "engine/session/session_lock.h"

namespace fettle::engine {

/// Longest wait for a reader that recovers a session; a writer is not waited for.
inline constexpr int kLockWaitMs = 1000;

/// The right to write a session to `real_path` (links followed). Error: another program has it.
[[nodiscard]] Result<SessionLock> lockSession(const std::string& real_path, const std::string& shown);

/// saveSession for a caller who holds the lock of realPath(path).
[[nodiscard]] Result<SessionSize> saveSessionLocked(const Session& session, const std::string& path,
                                                    JobControl& job);

}  // namespace fettle::engine
