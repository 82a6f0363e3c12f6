#include "engine/session/session_lock.h"

#include <cerrno>
#include <chrono>
#include <fstream>
#include <system_error>
#include <thread>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

namespace fettle::engine {

namespace {

std::string lockPath(const std::string& session_path) {
  return session_path + "-lock";
}

// Whether the name still refers to the locked file: its last holder may have removed it in between.
bool stillThere(const std::string& path, int descriptor) {
  struct stat by_name {};
  struct stat held {};
  return stat(path.c_str(), &by_name) == 0 && fstat(descriptor, &held) == 0 &&
         by_name.st_ino == held.st_ino && by_name.st_dev == held.st_dev;
}

}  // namespace

Result<std::optional<SessionLock>> SessionLock::take(const std::string& session_path, int wait_ms) {
  const std::string path = lockPath(session_path);
  const auto until = std::chrono::steady_clock::now() + std::chrono::milliseconds(wait_ms);
  for (;;) {
    const int descriptor = open(path.c_str(), O_CREAT | O_RDWR | O_CLOEXEC, 0666);
    if (descriptor < 0)
      return inputError(
          fmt::format("the session cannot be written: {}", std::generic_category().message(errno)),
          session_path, "check the rights of its folder, or save the session elsewhere");
    const bool locked = flock(descriptor, LOCK_EX | LOCK_NB) == 0;
    if (locked && stillThere(path, descriptor)) {
      const std::string holder = fmt::format("process {}\n", getpid());
      // Only for messages: a disk too full for it does not matter.
      if (ftruncate(descriptor, 0) == 0) (void)!pwrite(descriptor, holder.data(), holder.size(), 0);
      return SessionLock(path, descriptor);
    }
    close(descriptor);
    if (locked) continue;
    if (std::chrono::steady_clock::now() >= until) return std::optional<SessionLock>();
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
}

SessionLock::~SessionLock() {
  if (descriptor_ < 0) return;
  unlink(path_.c_str());  // before the unlock: a later holder detects that the name was removed
  close(descriptor_);
}

std::string SessionLock::holder(const std::string& session_path) {
  std::ifstream file(lockPath(session_path));
  std::string line;
  return std::getline(file, line) && line.starts_with("process ") && line.size() < 32 ? line
                                                                                      : "another program";
}

tl::unexpected<Error> sessionInUse(const std::string& session_path, const std::string& shown) {
  return inputError(fmt::format("{} is working on the session", SessionLock::holder(session_path)), shown,
                    "close it there, or save the session under another name");
}

}  // namespace fettle::engine
