#include "app/window/saving.h"

#include <algorithm>
#include <ctime>
#include <filesystem>
#include <utility>

#include <fmt/chrono.h>
#include <fmt/format.h>

#include "app/texts/texts.h"
#include "app/work/outputs.h"
#include "app/work/session_guard.h"
#include "engine/formats/formats.h"
#include "engine/io/files/input_file.h"
#include "engine/io/lines/lines.h"
#include "engine/io/raster/marks.h"

namespace fettle::app {
namespace {

namespace fs = std::filesystem;

// A scan of up to so many samples is stored in the session unless the user chooses otherwise.
constexpr std::int64_t kEmbedded = std::int64_t{16} << 20;

bool anyMark(const engine::Version& version) {
  return version.reader().root().marked_children != 0;
}

bool hasLines(const engine::Version& version) {
  return version.lines() != nullptr && !version.lines()->empty();
}

// What a format does not hold is stored next to the field: NAME_marks.png, NAME_lines.csv.
std::string nextTo(const std::string& path, const char* ending) {
  const fs::path p(path);
  return (p.parent_path() / (p.stem().string() + ending)).string();
}
std::string marksPath(const std::string& path) {
  return nextTo(path, "_marks.png");
}
std::string linesPath(const std::string& path) {
  return nextTo(path, "_lines.csv");
}

// The files that are written, and may replace others.
std::vector<std::string> outputsOf(const std::string& path, Saving::Keeping keeping,
                                   const ActiveDocument& document) {
  if (isSessionPath(path)) {
    // Writing a session to itself loses nothing.
    std::error_code none;
    const bool itself =
        keeping == Saving::Keeping::kWorkThere && fs::equivalent(path, document.keeper()->path(), none);
    return itself ? std::vector<std::string>() : std::vector{path};
  }
  std::vector<std::string> outputs{path};
  const engine::Version field = document.client()->upright();
  if (anyMark(field)) outputs.push_back(marksPath(path));
  if (hasLines(field)) outputs.push_back(linesPath(path));
  return outputs;
}

engine::Result<Saving::Written> writeFiles(const std::string& path, const std::vector<std::string>& outputs,
                                           const engine::Version& field, const engine::ExportOptions& options,
                                           engine::JobControl& job) {
  ScanGuard guard;  // of other sessions: this one does not need the file any more
  for (const std::string& output : outputs)
    if (auto spared = guard.protectSessions(output, job); !spared) return tl::unexpected(spared.error());
  auto done = engine::exportField(field, path, options, job);
  if (!done) return tl::unexpected(done.error());
  if (anyMark(field) && !isSessionPath(path))
    if (auto marks = engine::exportMarks(field, marksPath(path)); !marks)
      return tl::unexpected(marks.error());
  if (hasLines(field) && !isSessionPath(path))
    if (auto lines = engine::exportLines(linesPath(path), *field.lines(), field.grid()); !lines)
      return tl::unexpected(lines.error());
  return Saving::Written{field, std::move(done->warnings)};
}

}  // namespace

bool Saving::hasMeshChoice(const engine::Grid& grid) {
  // A degree is no length, and its millimetres are a guess.
  return grid.lateral_unit.mm != 1.0 && grid.lateral_unit.name != "deg";
}

void Saving::begin(std::int64_t samples) {
  path_.clear();
  exported_.reset();
  embeds = samples <= kEmbedded;
  mesh_in_mm = true;
}

void Saving::save(ActiveDocument& document, Feedback& feedback, Afterwards afterwards) {
  const SessionKeeper& keeper = *document.keeper();
  if (keeper.named()) {
    start(keeper.path(), Keeping::kWorkThere, std::move(afterwards), document, feedback);
  } else if (!path_.empty()) {
    // These files were written before; but marks, if there were none then, may replace a file of other
    // content.
    std::vector<std::string> outputs = outputsOf(path_, Keeping::kWorkThere, document);
    std::erase_if(outputs, [&](const std::string& path) { return std::ranges::count(written_, path) > 0; });
    if (replacedFiles(outputs, {}).texts.empty())
      start(path_, Keeping::kWorkThere, std::move(afterwards), document, feedback);
    else
      askToWrite({.kind = Question::Kind::kSaveAs, .path = path_, .afterwards = std::move(afterwards)},
                 Typed::kNo, document, feedback);
  } else {
    // Never over the scan itself without a question.
    feedback.questions.ask({.kind = Question::Kind::kSaveAs,
                            .path = suggestedPath(document, ".fettle"),
                            .afterwards = std::move(afterwards)});
  }
}

void Saving::askToWrite(Question from, Typed typed, ActiveDocument& document, Feedback& feedback) {
  const SessionKeeper& keeper = *document.keeper();
  const Keeping keeping = keepingOf(from.kind);
  std::error_code none;
  if (keeping == Keeping::kCopy && fs::equivalent(from.path, keeper.path(), none)) {
    feedback.message(trFormat("{} is the open session: everything is stored there immediately", from.path),
                     tr("name another file for a copy"));
    return;
  }
  if (const auto status = checkPlaces({{from.path, OutputKind::kField}}, {});
      !status && typed == Typed::kYes) {
    // Back to the dialog in which it was chosen.
    feedback.questions.ask({.kind = from.kind,
                            .path = std::move(from.path),
                            .afterwards = std::move(from.afterwards),
                            .said = {status.error().line(), ""}});
    return;
  }
  ReplacedFiles files = replacedFiles(outputsOf(from.path, keeping, document), keeper.scanPath());
  if (files.texts.empty()) {
    start(from.path, keeping, std::move(from.afterwards), document, feedback);
    return;
  }
  feedback.questions.ask({.kind = Question::Kind::kReplace,
                          .path = std::move(from.path),
                          .afterwards = std::move(from.afterwards),
                          .from = from.kind,
                          .typed = typed == Typed::kYes,
                          .replaced = std::move(files.texts)});
}

void Saving::start(const std::string& path, Keeping keeping, Afterwards afterwards, ActiveDocument& document,
                   Feedback& feedback) {
  if (auto status = checkPlaces({{path, OutputKind::kField}}, {}); !status) {
    feedback.message(status.error().line(), "");
    return;
  }
  target_ = path;
  keeping_ = keeping;
  afterwards_ = std::move(afterwards);
  // A session that refers to the scan could not be opened if another file replaced the scan.
  SessionKeeper& keeper = *document.keeper();
  waits_for_scan_ = replacedFiles(outputsOf(path, keeping, document), keeper.scanPath()).scan;
  if (waits_for_scan_)
    keeper.keepScan();
  else
    write(document);
}

void Saving::write(ActiveDocument& document) {
  LoopClient& client = *document.client();
  if (isSessionPath(target_) && keeping_ == Keeping::kWorkThere) {
    client.poll();
    document.keeper()->saveAs(
        target_, embeds ? engine::OriginalStorage::kEmbedded : engine::OriginalStorage::kReferenced);
    return;
  }
  outputs_ = outputsOf(target_, keeping_, document);
  engine::ExportOptions options;
  options.original = client.original();
  if (engine::extensionOf(target_) == ".stl" && mesh_in_mm && hasMeshChoice(client.upright().grid()))
    options.mesh_unit = engine::LengthUnit();
  writing_.start([path = target_, outputs = outputs_, field = client.upright(), options](
                     engine::JobControl& job) { return writeFiles(path, outputs, field, options, job); });
}

void Saving::cancel(ActiveDocument& document) {
  if (writing_.busy())
    writing_.cancel();
  else
    document.keeper()->cancelSaving();
}

std::optional<Saving::Saved> Saving::poll(ActiveDocument& document, Feedback& feedback) {
  std::optional<engine::Status> ended;
  SessionKeeper* const keeper = document.keeper();
  bool moved = false;
  if (auto kept = keeper != nullptr ? keeper->scanKept() : std::nullopt;
      kept && std::exchange(waits_for_scan_, false)) {
    if (*kept)
      write(document);
    else
      ended = std::move(*kept);
  }
  if (auto done = writing_.take()) {
    ended = *done ? engine::Status{} : tl::unexpected(done->error());
    if (*done)
      for (const std::string& warning : (*done)->warnings)
        feedback.notices.push_back(
            {fmt::format("{}: {}", fs::path(target_).filename().string(), warning), ""});
    if (*done && keeping_ == Keeping::kCopy)
      exported_ =
          Exported{(*done)->field, target_, fmt::format("{:%H:%M}", fmt::localtime(std::time(nullptr)))};
    if (*done && keeping_ == Keeping::kWorkThere) {
      path_ = target_;
      written_ = outputs_;
      document.noteSaved((*done)->field);
    }
  }
  if (auto done = keeper != nullptr ? keeper->saved() : std::nullopt) {
    ended = std::move(*done);
    moved = ended->has_value();
    if (moved) document.noteMoved();
  }
  if (!ended) return std::nullopt;
  Afterwards afterwards = std::exchange(afterwards_, {});
  if (*ended) {
    feedback.status = trFormat("written: {}", target_);
    noteFolderOf(target_);
    return Saved{std::move(afterwards), moved};
  }
  if (ended->error().kind != engine::ErrorKind::kCancelled)
    feedback.message(ended->error().line(), tr("the work is stored here; save it elsewhere"));
  return std::nullopt;
}

std::string Saving::suggestedPath(const ActiveDocument& document, const char* ending) const {
  const std::string beside = document.suggestedPath(ending);
  return folder_.empty() ? beside : (fs::path(folder_) / fs::path(beside).filename()).string();
}

void Saving::noteFolderOf(const std::string& path) {
  folder_ = fs::path(path).parent_path().string();
}

std::string Saving::exportText(const ActiveDocument& document) const {
  if (!exported_ || !document.isOpen()) return {};
  const bool same = document.client()->upright() == exported_->field;
  return same ? trFormat("It was exported to {} at {}, as it is now.", exported_->path, exported_->at)
              : trFormat("It was exported to {} at {}, and changed since.", exported_->path, exported_->at);
}

std::string Saving::exportedTo(const ActiveDocument& document) const {
  const bool same = exported_ && document.isOpen() && document.client()->upright() == exported_->field;
  return same ? exported_->path : "";
}

std::string Saving::statusText(const std::string& status, const ActiveDocument& document) const {
  const std::string exported = exportedTo(document);
  const bool names = status == trFormat("written: {}", target_);
  if (names && exported == target_) return status;
  const std::string kept = document.keptText(exported);
  // Of a session every step is in the file.
  const bool changed = names && !isSessionPath(target_) && document.unsaved();
  std::string line = changed ? trFormat("written: {}, changed since", target_) : status;
  if (!kept.empty()) line += "  (" + kept + ")";
  return line;
}

bool Saving::busy(const ActiveDocument& document) const {
  const SessionKeeper* const keeper = document.keeper();
  return writing_.busy() || waits_for_scan_ || (keeper != nullptr && keeper->saving());
}

std::optional<WorkProgress> Saving::progress(const ActiveDocument& document) const {
  const SessionKeeper* const keeper = document.keeper();
  if (writing_.busy()) return writing_.progress();
  if (keeper != nullptr && keeper->saving()) return keeper->progress();
  return std::nullopt;
}

}  // namespace fettle::app
