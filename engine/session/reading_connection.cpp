#include <cerrno>
#include <filesystem>
#include <system_error>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <fmt/format.h>

#include "engine/session/session_reader.h"

namespace fettle::engine {

namespace {

namespace fs = std::filesystem;

bool hasLog(const std::string& path) {
  std::error_code error;
  const auto size = fs::file_size(path + "-wal", error);
  return !error && size != 0;
}

bool mayWrite(const std::string& path) {
  const fs::path folder = fs::path(path).parent_path();
  return access(path.c_str(), W_OK) == 0 && access(folder.empty() ? "." : folder.c_str(), W_OK) == 0;
}

// Errors that SQLite would report less clearly, or only after treating an empty file as an empty database.
Status checkFile(const std::string& path) {
  struct stat file {};
  if (stat(path.c_str(), &file) != 0)
    return inputError(fmt::format("the session cannot be read: {}", std::generic_category().message(errno)),
                      path, errno == ENOENT ? "check the name" : "check its rights");
  if (S_ISDIR(file.st_mode)) return inputError("the session is a folder", path, "name a file in it");
  if (!S_ISREG(file.st_mode)) return inputError("the session is not an ordinary file", path, "name a file");
  if (file.st_size == 0)
    return inputError("the file is empty, not a Fettle session", path, "name a session or a scan");
  if (access(path.c_str(), R_OK) != 0)
    return inputError(fmt::format("the session cannot be read: {}", std::generic_category().message(errno)),
                      path, "check its rights");
  return {};
}

}  // namespace

struct ReadingConnection::Copies {
  fs::path folder;
  explicit Copies(fs::path made) : folder(std::move(made)) {}
  Copies& operator=(Copies&&) = delete;
  ~Copies() {
    std::error_code ignored;
    fs::remove_all(folder, ignored);
  }
};

Result<ReadingConnection> ReadingConnection::open(const std::string& path) {
  if (Status status = checkFile(path); !status) return tl::unexpected(status.error());
  ReadingConnection connection;
  std::string at = path;
  DatabaseAccess access = DatabaseAccess::kRead;
  if (!mayWrite(path)) {
    access = DatabaseAccess::kFrozen;
    if (hasLog(path)) {
      // The index of the log can only be built in the same folder; so both are copied to a writable folder.
      std::error_code error;
      const fs::path folder = fs::temp_directory_path(error);
      std::string name = (folder / "fettle-session-XXXXXX").string();
      if (error || mkdtemp(name.data()) == nullptr)
        return inputError("the session needs a folder for a copy, and there is none", path,
                          "set TMPDIR to a folder you may write to");
      connection.copies_ = std::make_shared<Copies>(name);
      at = (fs::path(name) / "copy.fettle").string();
      fs::copy_file(path, at, error);
      if (!error) fs::copy_file(path + "-wal", at + "-wal", error);
      if (error)
        return inputError(fmt::format("the session cannot be copied for reading: {}", error.message()), path,
                          "free space in the temporary folder, or set TMPDIR to another");
      access = DatabaseAccess::kRead;
    }
  } else {
    // The last connection to close may remove log and index only while there is no writer (see SessionLock).
    auto lock = SessionLock::take(path, 0);
    if (lock) connection.lock_ = std::move(*lock);
  }
  auto database = Database::open(at, access, path);
  if (!database) return tl::unexpected(database.error());
  connection.database_ = std::move(*database);
  if (access == DatabaseAccess::kRead && !connection.copies_ && !connection.lock_)
    connection.database_->keepLogOnClose();
  return connection;
}

}  // namespace fettle::engine
