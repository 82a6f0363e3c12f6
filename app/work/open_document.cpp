#include "app/work/open_document.h"

#include <algorithm>
#include <filesystem>

#include <fmt/format.h>

#include "app/work/recent_files.h"
#include "engine/field/seen_field.h"
#include "engine/formats/formats.h"
#include "engine/io/files/input_file.h"
#include "engine/session/checksum.h"

namespace fettle::app {
namespace {

namespace fs = std::filesystem;

constexpr const char* kUnderForm =
    "a form lies over the field: it is shown and edited with the form, as its samples are";

// The session itself, to continue writing to it if possible.
engine::Result<Document> openSessionDocument(const std::string& file, std::size_t history_bytes,
                                             engine::JobControl& job) {
  Document document;
  engine::SessionOpenOptions options;
  options.history_bytes = history_bytes;
  options.journal = engine::JournalReading::kLeave;
  auto resumed = engine::SessionWriter::open(file, options, {}, engine::importField, job);
  engine::Session session;
  if (resumed) {
    document.writer = std::move(resumed->writer);
    session = std::move(resumed->session);
  } else {
    if (resumed.error().kind == engine::ErrorKind::kCancelled) return tl::unexpected(resumed.error());
    auto read = engine::openSession(file, options, engine::importField, job);
    if (!read) return tl::unexpected(read.error());
    session = *std::move(read);
    document.warnings.push_back(fmt::format(
        "{}: work is not written to this session; save it under another name", resumed.error().what));
  }
  document.path = file;
  document.scan = std::move(session.scan);
  document.needs_scan = session.storage == engine::OriginalStorage::kReferenced;
  document.original = std::move(session.original);
  document.history = std::move(session.history);
  std::vector<engine::Version> dropped;
  document.history.setBound(history_bytes, dropped);
  document.notes = std::move(session.notes);
  if (document.history.current().form() != nullptr) document.warnings.emplace_back(kUnderForm);
  return document;
}

}  // namespace

std::string recoveryFolder() {
  return userFolder("XDG_STATE_HOME", ".local/state");
}

std::string recoveryPath(const std::string& scan) {
  const std::string folder = recoveryFolder();
  if (folder.empty()) return {};
  std::error_code error;
  const fs::path real = fs::weakly_canonical(scan, error);
  const std::string whole = error ? scan : real.string();
  return (fs::path(folder) /
          fmt::format("{}-{:016x}.fettle", fs::path(scan).stem().string(),
                      static_cast<std::uint64_t>(engine::RowChecksum().text(whole).value())))
      .string();
}

bool isSessionPath(const std::string& path) {
  return engine::extensionOf(path) == ".fettle";
}

void removeSession(const std::string& path) {
  std::error_code ignored;
  for (const char* suffix : {"", "-wal", "-shm", "-lock"}) fs::remove(path + suffix, ignored);
}

engine::Result<Document> openDocument(const std::string& path, const ScanOptions& reading, Recovery recovery,
                                      std::size_t history_bytes, engine::JobControl& job) {
  if (isSessionPath(path)) return openSessionDocument(path, history_bytes, job);
  if (recovery == Recovery::kTake) {
    auto document = openSessionDocument(recoveryPath(path), history_bytes, job);
    if (!document) return document;
    document->path = path;
    document->recovered = true;
    return document;
  }
  const auto import = importOptions(reading);
  if (!import) return tl::unexpected(import.error());
  // Before the first byte: a file that is replaced while it is read is detected too.
  const auto stamp = engine::fileStamp(path);
  auto imported = engine::importField(path, *import, job);
  if (!imported) return tl::unexpected(imported.error());
  Document document;
  document.path = path;
  document.scan = {path, *import, imported->format, stamp};
  document.warnings = std::move(imported->warnings);
  if (imported->field.seenOf() != nullptr) document.warnings.emplace_back(kUnderForm);
  auto samples = engine::withoutLayer(imported->field, job);
  if (!samples) return tl::unexpected(samples.error());
  document.original = *std::move(samples);
  document.history = engine::History(document.original, history_bytes);
  return document;
}

}  // namespace fettle::app
