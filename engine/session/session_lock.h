#pragma once

#include <optional>
#include <string>
#include <utility>

#include "engine/base/error.h"

namespace fettle::engine {

/// The right to write to a session: an advisory lock (flock) on the file NAME.fettle-lock in the same folder.
/// The system releases it when the program ends, however it ends; a remaining file has no meaning. It is a
/// separate file because closing any descriptor of the session itself would release SQLite's locks (a rule of
/// POSIX).
///
/// Threading: one thread at a time.
class SessionLock {
 public:
  /// Tries for `wait_ms`. Empty when another program (or writer of this one) has it. Errors: the lock file
  /// cannot be created, because the folder is read-only.
  [[nodiscard]] static Result<std::optional<SessionLock>> take(const std::string& session_path, int wait_ms);

  SessionLock(SessionLock&& other) noexcept
      : path_(std::move(other.path_)), descriptor_(std::exchange(other.descriptor_, -1)) {}
  SessionLock& operator=(SessionLock&& other) noexcept {
    std::swap(path_, other.path_);
    std::swap(descriptor_, other.descriptor_);
    return *this;
  }
  ~SessionLock();

  /// "process 1234", as the holder wrote it; "another program" when it cannot be read.
  [[nodiscard]] static std::string holder(const std::string& session_path);

 private:
  SessionLock(std::string path, int descriptor) : path_(std::move(path)), descriptor_(descriptor) {}
  std::string path_;
  int descriptor_ = -1;
};

/// The error when another program has the lock.
[[nodiscard]] tl::unexpected<Error> sessionInUse(const std::string& session_path, const std::string& shown);

}  // namespace fettle::engine
