#include "engine/session/database.h"

#include <system_error>

#include <fmt/format.h>
#include <sqlite3.h>

namespace fettle::engine {

namespace {

constexpr const char* kElsewhere = "free space on the disk or save the session elsewhere";
constexpr const char* kDamage = "open a copy of it, or the scan itself";

// Percent signs, question marks and hashes have a meaning in a file name given as URI.
std::string uriOf(const std::string& path) {
  std::string uri = "file:";
  if (path.starts_with('/')) uri += "//";
  for (const char c : path)
    if (c == '%' || c == '?' || c == '#')
      uri += fmt::format("%{:02x}", static_cast<unsigned char>(c));
    else
      uri += c;
  return uri + "?immutable=1";
}

}  // namespace

tl::unexpected<Error> damaged(const std::string& what, const std::string& path) {
  return inputError("the session is damaged: " + what, path, kDamage);
}

void Statement::Close::operator()(sqlite3_stmt* statement) const noexcept {
  sqlite3_finalize(statement);
}

Statement& Statement::bind(int place, std::int64_t value) noexcept {
  sqlite3_bind_int64(statement_.get(), place, value);
  return *this;
}
Statement& Statement::bindReal(int place, double value) noexcept {
  sqlite3_bind_double(statement_.get(), place, value);
  return *this;
}
Statement& Statement::bindText(int place, std::string_view value) noexcept {
  sqlite3_bind_text64(statement_.get(), place, value.data() == nullptr ? "" : value.data(), value.size(),
                      SQLITE_STATIC, SQLITE_UTF8);
  return *this;
}
Statement& Statement::bindBlob(int place, std::string_view value) noexcept {
  sqlite3_bind_blob64(statement_.get(), place, value.data() == nullptr ? "" : value.data(), value.size(),
                      SQLITE_STATIC);
  return *this;
}
Statement& Statement::bindNull(int place) noexcept {
  sqlite3_bind_null(statement_.get(), place);
  return *this;
}

Result<bool> Statement::step() {
  const int code = sqlite3_step(statement_.get());
  if (code == SQLITE_ROW) return true;
  if (code == SQLITE_DONE) return false;
  const Error error = database_->error();
  reset();
  return tl::unexpected(error);
}

Status Statement::run() {
  const Result<bool> row = step();
  if (!row) return tl::unexpected(row.error());
  reset();
  return {};
}

void Statement::reset() noexcept {
  sqlite3_reset(statement_.get());
  sqlite3_clear_bindings(statement_.get());
}

bool Statement::isNull(int column) const noexcept {
  return sqlite3_column_type(statement_.get(), column) == SQLITE_NULL;
}
std::int64_t Statement::integer(int column) const noexcept {
  return sqlite3_column_int64(statement_.get(), column);
}
double Statement::real(int column) const noexcept {
  return sqlite3_column_double(statement_.get(), column);
}
std::string_view Statement::bytes(int column) const noexcept {
  const void* data = sqlite3_column_blob(statement_.get(), column);
  const int size = sqlite3_column_bytes(statement_.get(), column);
  return data == nullptr ? std::string_view()
                         : std::string_view(static_cast<const char*>(data), static_cast<std::size_t>(size));
}

Result<std::unique_ptr<Database>> Database::open(const std::string& path, DatabaseAccess access,
                                                 const std::string& shown) {
  const bool frozen = access == DatabaseAccess::kFrozen;
  // A reader opens for writing too where permitted: only then can it recover a crashed program's log and
  // remove the files next to the session.
  const int flags = SQLITE_OPEN_NOMUTEX | SQLITE_OPEN_EXRESCODE |
                    (frozen ? SQLITE_OPEN_READONLY | SQLITE_OPEN_URI : SQLITE_OPEN_READWRITE);
  sqlite3* handle = nullptr;
  const int code = sqlite3_open_v2((frozen ? uriOf(path) : path).c_str(), &handle, flags, nullptr);
  std::unique_ptr<Database> database(new Database(handle, shown));
  if (handle == nullptr) return failure("memory for the session could not be allocated", shown);
  if (code != SQLITE_OK) return tl::unexpected(database->error());
  // The file may come from others: nothing in its schema is executed.
  sqlite3_db_config(handle, SQLITE_DBCONFIG_DEFENSIVE, 1, nullptr);
  sqlite3_db_config(handle, SQLITE_DBCONFIG_TRUSTED_SCHEMA, 0, nullptr);
  sqlite3_db_config(handle, SQLITE_DBCONFIG_ENABLE_TRIGGER, 0, nullptr);
  sqlite3_db_config(handle, SQLITE_DBCONFIG_ENABLE_VIEW, 0, nullptr);
  sqlite3_busy_timeout(handle, 5000);  // longer than another connection's checkpoint or recovery
  // In place of SQLite's own checkpoints, which would come in the middle of a commit.
  sqlite3_wal_hook(
      handle,
      [](void* context, sqlite3*, const char*, int pages) {
        auto* self = static_cast<Database*>(context);
        self->log_bytes_ = static_cast<std::uint64_t>(pages) * kSessionPageBytes;
        return SQLITE_OK;
      },
      database.get());
  if (access == DatabaseAccess::kRead || frozen)
    if (Status status = database->execute("PRAGMA query_only=ON"); !status)
      return tl::unexpected(status.error());
  return database;
}

Database::~Database() {
  sqlite3_close_v2(handle_);
}

Status Database::execute(const std::string& sql) {
  if (sqlite3_exec(handle_, sql.c_str(), nullptr, nullptr, nullptr) != SQLITE_OK)
    return tl::unexpected(error());
  return {};
}

Result<Statement> Database::prepare(const std::string& sql) {
  sqlite3_stmt* statement = nullptr;
  if (sqlite3_prepare_v3(handle_, sql.c_str(), static_cast<int>(sql.size()), SQLITE_PREPARE_PERSISTENT,
                         &statement, nullptr) != SQLITE_OK)
    return tl::unexpected(error());
  Statement prepared;
  prepared.statement_.reset(statement);
  prepared.database_ = this;
  return prepared;
}

Result<std::int64_t> Database::integer(const std::string& sql) {
  Result<Statement> statement = prepare(sql);
  if (!statement) return tl::unexpected(statement.error());
  const Result<bool> row = statement->step();
  if (!row) return tl::unexpected(row.error());
  return *row ? statement->integer(0) : 0;
}

Result<std::string> Database::text(const std::string& sql) {
  Result<Statement> statement = prepare(sql);
  if (!statement) return tl::unexpected(statement.error());
  const Result<bool> row = statement->step();
  if (!row) return tl::unexpected(row.error());
  return *row ? std::string(statement->bytes(0)) : std::string();
}

Result<bool> Database::checkpoint() {
  int in_log = 0;
  int worked_in = 0;
  // PASSIVE does not wait; a log that was checkpointed completely is written from its start again.
  const int code =
      sqlite3_wal_checkpoint_v2(handle_, nullptr, SQLITE_CHECKPOINT_PASSIVE, &in_log, &worked_in);
  if (code != SQLITE_OK && code != SQLITE_BUSY) return tl::unexpected(error());
  const bool all = code == SQLITE_OK && in_log == worked_in;
  if (all) log_bytes_ = 0;
  return all;
}

void Database::stopWith(const JobControl* job) noexcept {
  const auto stop = [](void* context) {
    return static_cast<const JobControl*>(context)->cancelled() ? 1 : 0;
  };
  sqlite3_progress_handler(handle_, job == nullptr ? 0 : 10000, job == nullptr ? nullptr : +stop,
                           const_cast<JobControl*>(job));
}

void Database::keepLogOnClose() noexcept {
  sqlite3_db_config(handle_, SQLITE_DBCONFIG_NO_CKPT_ON_CLOSE, 1, nullptr);
}

Error Database::error() const {
  const int extended = sqlite3_extended_errcode(handle_);
  const int system = sqlite3_system_errno(handle_);
  const std::string reason = system != 0 ? std::generic_category().message(system) : sqlite3_errmsg(handle_);
  const auto input = [&](std::string what, std::string remedy) {
    return Error{ErrorKind::kInput, std::move(what), shown_, std::move(remedy)};
  };
  switch (extended & 0xff) {
    case SQLITE_FULL:
      return {ErrorKind::kFailed, "the session cannot be written: the disk is full", shown_, kElsewhere};
    case SQLITE_READONLY:
    case SQLITE_PERM:
      return input("the session cannot be written: the file or its folder is read-only",
                   "save the session elsewhere");
    case SQLITE_AUTH:
    case SQLITE_CANTOPEN:
      return input("the session cannot be opened: " + reason,
                   "check the rights of the file and its folder, or save the session elsewhere");
    case SQLITE_BUSY:
    case SQLITE_LOCKED:
      return input("another program is using the session", "close it there, or save the session elsewhere");
    case SQLITE_CORRUPT:
    case SQLITE_ERROR:  // "no such table": the statements themselves are correct
    case SQLITE_MISMATCH:
    case SQLITE_SCHEMA:
      return input(fmt::format("the session is damaged: {}", sqlite3_errmsg(handle_)), kDamage);
    case SQLITE_NOTADB:
      return input("the file is not a Fettle session", "name a session or a scan");
    case SQLITE_INTERRUPT:
      return cancelled().value();
    case SQLITE_NOMEM:
      return {ErrorKind::kFailed, "memory for the session could not be allocated", shown_, {}};
    case SQLITE_IOERR:
      if (extended == SQLITE_IOERR_SHORT_READ || extended == SQLITE_IOERR_CORRUPTFS)
        return input("the session is damaged: the file ends too early", kDamage);
      if (extended == SQLITE_IOERR_NOMEM)
        return {ErrorKind::kFailed, "memory for the session could not be allocated", shown_, {}};
      return {ErrorKind::kFailed, "the session cannot be read or written: " + reason, shown_, kElsewhere};
    default:
      return input("the session cannot be read or written: " + reason, kElsewhere);
  }
}

Result<Transaction> Transaction::begin(Database& database) {
  if (Status status = database.execute("BEGIN IMMEDIATE"); !status) return tl::unexpected(status.error());
  return Transaction(database);
}

Transaction::~Transaction() {
  // After some errors SQLite has rolled back by itself; then this only returns an error.
  if (database_ != nullptr) (void)database_->execute("ROLLBACK");
}

Status Transaction::commit() {
  if (Status status = database_->execute("COMMIT"); !status) return status;
  database_ = nullptr;
  return {};
}

}  // namespace fettle::engine
