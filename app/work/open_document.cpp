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

// The states of a session as they are seen; nothing is made where no form lies over one.
engine::Result<engine::History> seenHistory(const engine::History& stored, std::size_t history_bytes,
                                            engine::JobControl& job) {
  bool any = false;
  for (std::int64_t k = stored.first(); k <= stored.last(); ++k) any |= stored.state(k).form() != nullptr;
  if (!any) return stored;
  std::vector<engine::Version> states;
  for (std::int64_t k = stored.first(); k <= stored.last(); ++k) {
    const engine::Version near = states.empty() ? stored.state(k) : states.back();
    auto seen = engine::seenNear(stored.state(k), near, job);
    if (!seen) return tl::unexpected(seen.error());
    states.push_back(*std::move(seen));
  }
  std::vector<engine::Step> steps;
  for (std::size_t i = 0; i + 1 < states.size(); ++i)
    steps.push_back(
        {stored.info(stored.first() + static_cast<std::int64_t>(i) + 1), states[i], states[i + 1]});
  return engine::History(states[static_cast<std::size_t>(stored.number() - stored.first())], stored.number(),
                         stored.first(), std::move(steps), history_bytes);
}

// The original under the forms over the states, of a document whose history is as seen.
engine::Status addOriginals(Document& document, engine::JobControl& job) {
  document.originals = FormOriginals(document.original);
  if (auto made = document.originals.makeAll(document.history, job); !made) return made;
  auto first = engine::seenNear(document.original, document.history.current(), job);
  if (!first) return tl::unexpected(first.error());
  document.first = *std::move(first);
  return {};
}

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
  auto history = seenHistory(session.history, history_bytes, job);
  if (!history) return tl::unexpected(history.error());
  document.history = *std::move(history);
  if (auto added = addOriginals(document, job); !added) return tl::unexpected(added.error());
  std::vector<engine::Version> dropped;
  document.history.setBound(history_bytes, dropped);
  document.notes = std::move(session.notes);
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
  document.lone_values = std::move(imported->lone_values);
  auto samples = engine::restored(imported->field, job);
  if (!samples) return tl::unexpected(samples.error());
  document.original = *std::move(samples);
  document.history = engine::History(imported->field, history_bytes);
  if (auto added = addOriginals(document, job); !added) return tl::unexpected(added.error());
  return document;
}

}  // namespace fettle::app
