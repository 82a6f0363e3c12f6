#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <utility>

#include "engine/base/error.h"
#include "engine/base/job.h"

struct sqlite3;
struct sqlite3_stmt;

namespace fettle::engine {

class Database;

/// Bytes of a page of every session, fixed when it is made.
inline constexpr int kSessionPageBytes = 4096;

/// A prepared statement. Bind (positions count from 1), then step() until it returns false, then reset().
/// Values of a row are valid until the next step(); bound texts and blobs must stay valid until the statement
/// is reset.
class Statement {
 public:
  Statement() = default;

  Statement& bind(int place, std::int64_t value) noexcept;
  Statement& bindReal(int place, double value) noexcept;
  Statement& bindText(int place, std::string_view value) noexcept;
  Statement& bindBlob(int place, std::string_view value) noexcept;
  Statement& bindNull(int place) noexcept;

  /// True: a row is available. False: done. Error: as Database::error().
  [[nodiscard]] Result<bool> step();
  /// For statements without rows: step, then reset.
  [[nodiscard]] Status run();
  void reset() noexcept;

  [[nodiscard]] bool isNull(int column) const noexcept;
  [[nodiscard]] std::int64_t integer(int column) const noexcept;
  [[nodiscard]] double real(int column) const noexcept;
  /// Text or blob.
  [[nodiscard]] std::string_view bytes(int column) const noexcept;

 private:
  friend class Database;
  struct Close {
    void operator()(sqlite3_stmt* statement) const noexcept;
  };
  std::unique_ptr<sqlite3_stmt, Close> statement_;
  const Database* database_ = nullptr;
};

enum class DatabaseAccess : std::uint8_t {
  kWrite,   ///< an existing file
  kCreate,  ///< an empty file, yet to become a database
  kRead,    ///< an existing file; no statement may change it, but a crashed program's log is recovered
  kFrozen,  ///< an existing file that no program changes: no lock, no log, nothing is written
};

/// One SQLite connection with errors as values. `shown` is the path that errors name.
/// Threading: one thread at a time. Movable only before statements are prepared from it; hence held by
/// pointer.
class Database {
 public:
  [[nodiscard]] static Result<std::unique_ptr<Database>> open(const std::string& path, DatabaseAccess access,
                                                              const std::string& shown);
  Database& operator=(Database&&) = delete;
  ~Database();

  [[nodiscard]] Status execute(const std::string& sql);
  [[nodiscard]] Result<Statement> prepare(const std::string& sql);
  /// First column of the first row.
  [[nodiscard]] Result<std::int64_t> integer(const std::string& sql);
  [[nodiscard]] Result<std::string> text(const std::string& sql);

  /// Checkpoints the log into the file as far as readers allow. True when nothing is left in it.
  [[nodiscard]] Result<bool> checkpoint();
  /// Bytes in the log that this connection's last commit left.
  [[nodiscard]] std::uint64_t logBytes() const noexcept { return log_bytes_; }
  /// Statements end with an error soon after the job is cancelled; null ends that.
  void stopWith(const JobControl* job) noexcept;
  /// The last connection to close leaves the log unchanged.
  void keepLogOnClose() noexcept;

  /// The error of the last call that failed: full disk, no right to write, damage, not a database, in use ...
  [[nodiscard]] Error error() const;
  [[nodiscard]] const std::string& shownPath() const noexcept { return shown_; }
  void show(const std::string& path) { shown_ = path; }

 private:
  Database(sqlite3* handle, std::string shown) : handle_(handle), shown_(std::move(shown)) {}
  friend class Statement;

  sqlite3* handle_;
  std::string shown_;
  std::uint64_t log_bytes_ = 0;
};

/// "the session is damaged: WHAT", with what to do about it.
[[nodiscard]] tl::unexpected<Error> damaged(const std::string& what, const std::string& path);

/// BEGIN; ROLLBACK at the end of the scope unless commit() succeeded.
class Transaction {
 public:
  [[nodiscard]] static Result<Transaction> begin(Database& database);
  Transaction(Transaction&& other) noexcept : database_(std::exchange(other.database_, nullptr)) {}
  Transaction& operator=(Transaction&&) = delete;
  ~Transaction();
  [[nodiscard]] Status commit();

 private:
  explicit Transaction(Database& database) : database_(&database) {}
  Database* database_;
};

}  // namespace fettle::engine
