#include "app/window/active_document.h"

#include <charconv>
#include <filesystem>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "app/texts/texts.h"
#include "app/window/bookmarks.h"
#include "app/window/view_text.h"
#include "app/work/recent_files.h"
#include "engine/formats/formats.h"

namespace fettle::app {
namespace {

namespace fs = std::filesystem;

constexpr auto kNoteEvery = std::chrono::seconds(1);
// Writing what came since is a matter of milliseconds, and no word for it shall flicker.
constexpr auto kSayWaiting = std::chrono::seconds(1);
constexpr const char* kFittedNote =
    "fitted scene";  // what of the note "scene" is no choice of the user; empty: all is
constexpr const char* kPlainNote = "plain scene";  // what was fitted: SceneFit::plain
constexpr const char* kContactNote = "contact";  // what the words of the note "scene" mean: kContactRevision

// Of the scene that a session notes: none is noted by the programs that had only the first.
int contactRevision(const Document& document) {
  const auto noted = document.notes.find(kContactNote);
  if (noted == document.notes.end()) return 1;
  int revision = 0;  // parseScene refuses it
  std::from_chars(noted->second.data(), noted->second.data() + noted->second.size(), revision);
  return revision;
}

std::optional<haptic::Scene> sceneNoted(const Document& document, const char* note) {
  const auto noted = document.notes.find(note);
  if (noted == document.notes.end() || noted->second.empty()) return std::nullopt;
  const auto scene = haptic::parseScene(noted->second, "the session's scene", contactRevision(document));
  return scene ? std::optional(*scene) : std::nullopt;
}

// The first scene for a scan or session.
haptic::Scene firstScene(const Document& document, const std::optional<haptic::Scene>& given,
                         LoopClientOptions& options) {
  options.fitting = {.fits = !given.has_value()};
  if (given) return *given;
  haptic::Scene scene = haptic::defaultScene();
  // Wider than the default of one sample: as wide as the displayed brush.
  scene.brush_radius_samples = 6.0;
  scene.mark_radius_samples = 3.0;
  // Samples are distances: what is near is high.
  scene.invert = document.scan.import.depth_camera.has_value();
  const auto kept = sceneNoted(document, "scene");
  if (!kept) return scene;
  // The session may come from another device, and must open with this one too.
  options.fitting.lowers = true;
  options.fitting.fits = false;
  if (const auto fitted = sceneNoted(document, kFittedNote)) {
    options.fitting.fits = true;
    // Programs that noted no plain scene began with the default one.
    options.fitting.last = SceneFit{sceneNoted(document, kPlainNote).value_or(scene), *fitted};
  }
  return *kept;
}

}  // namespace

engine::Status ActiveDocument::open(Document& document, const std::optional<haptic::Scene>& scene,
                                    LoopClientOptions options) {
  const haptic::Scene first = firstScene(document, scene, options);
  const engine::History history = document.history;
  keeper_ = std::make_unique<SessionKeeper>(document);
  auto client = LoopClient::start(history, document.originals, first, options, keeper_.get());
  if (!client) {
    keeper_.reset();
    return tl::unexpected(client.error());
  }
  loop_ = std::move(*client);
  sections_.clear();
  views_.clear();
  path_ = document.path;
  // Recovered work is not saved yet.
  saved_ = document.recovered ? document.first : history.current();
  return {};
}

engine::Status ActiveDocument::close(SessionKeeper::Afterwards afterwards) {
  loop_->finish();
  noteDrawn();
  engine::Status closed = keeper_->close(afterwards);
  loop_.reset();
  keeper_.reset();
  return closed;
}

std::string ActiveDocument::rescue() {
  const bool had_unsaved = unsaved();
  const std::string session = keeper_->named() ? keeper_->path() : std::string();
  loop_->finish();
  const engine::Version field = loop_->upright();
  const engine::Status closed = close(SessionKeeper::Afterwards::kKeep);
  if (closed && !session.empty()) return trFormat("everything is stored in {}; ", session);
  if (closed)
    return had_unsaved ? trFormat("unsaved work is stored, and offered when {} is opened again; ", path_)
                       : "";

  // The session cannot be written: save at least the field, next to the scan or in a writable folder.
  const std::string why = closed.error().line();
  for (const fs::path& folder :
       {fs::path(path_).parent_path(), fs::path(settingsFolder()), fs::path("/tmp")}) {
    const std::string stem = (folder / (fs::path(path_).stem().string() + "_rescued")).string();
    std::error_code error;
    std::string path = stem + ".fettle";
    for (int n = 2; fs::exists(path, error); ++n) path = fmt::format("{}_{}.fettle", stem, n);
    engine::JobControl job;
    if (engine::exportField(field, path, {}, job))
      return trFormat("{}; the field with its marks is stored in {}; ", why, path);
  }
  return trFormat("{}; unsaved work is lost; ", why);
}

std::string ActiveDocument::fileName() const {
  return fs::path(path_).filename().string();
}

std::string ActiveDocument::suggestedPath(const char* ending) const {
  const fs::path scan(path_);
  return (scan.parent_path() / (scan.stem().string() + ending)).string();
}

void ActiveDocument::poll(const render::View& view, Feedback& feedback) {
  loop_->poll();
  if (auto older = keeper_->older()) {
    if (*older) {
      loop_->prepend((*older)->step, (*older)->original);
      loop_->undo();
    } else {
      feedback.note(older->error());
    }
  }
  updateSession(view, feedback);
  if (keeper_->waiting() == 0) kept_ = std::chrono::steady_clock::now();
}

void ActiveDocument::updateSession(const render::View& view, Feedback& feedback) {
  const auto error = keeper_->error();
  if (error && !keeping_fails_)
    feedback.message(
        trFormat("The work cannot be stored: {}", error->line()),
        tr("Nothing is lost while the program runs, and it tries again automatically. Save somewhere "
           "else: Ctrl+Shift+S."));
  keeping_fails_ = error.has_value();
  const auto now = std::chrono::steady_clock::now();
  if (now - noted_ < kNoteEvery) return;
  noted_ = now;
  storeNotes(view);
}

void ActiveDocument::storeNotes(const render::View& view) {
  keeper_->setNote("camera", viewText(view));
  // Of the user, not as lowered to what a device holds: the next one may hold more.
  keeper_->setNote("scene", haptic::sceneText(loop_->unlowered()));
  const std::optional<SceneFit>& fit = loop_->fit();
  keeper_->setNote(kFittedNote, fit ? haptic::sceneText(fit->fitted) : std::string());
  keeper_->setNote(kPlainNote, fit ? haptic::sceneText(fit->plain) : std::string());
  keeper_->setNote(kContactNote, std::to_string(haptic::kContactRevision));
  noteDrawn();
}

void ActiveDocument::noteDrawn() {
  if (!sections_.empty()) keeper_->setNote(engine::kSectionsNote, sections_);
  if (!views_.empty()) keeper_->setNote(Bookmarks::kNote, views_);
}

void ActiveDocument::undo() {
  const engine::History& history = loop_->history();
  if (loop_->canUndo() || history.first() == 0) {
    loop_->undo();
  } else if (!keeper_->readingOlder()) {
    keeper_->readOlder(history);
  }
}

bool ActiveDocument::unsaved() const {
  if (!loop_) return false;
  // A session of the user stores everything, unless it cannot be written.
  if (keeper_->named()) return keeper_->error().has_value();
  return !(loop_->upright() == saved_);
}

std::string ActiveDocument::keptText(const std::string& exported) const {
  if (const auto error = keeper_->error())
    return trFormat("not stored: {}; the work is in memory, save it elsewhere", error->what);
  const bool waiting = keeper_->waiting() > 0 && std::chrono::steady_clock::now() - kept_ > kSayWaiting;
  const std::string session = keeper_->path();
  if (keeper_->named())
    return waiting ? trFormat("writing {}", fs::path(session).filename().string())
                   : trFormat("kept in {}", fs::path(session).filename().string());
  if (!unsaved()) return {};
  if (!exported.empty()) return trFormat("exported to {}", fs::path(exported).filename().string());
  return session.empty() || waiting ? tr("not saved") : tr("not saved; kept for the next start");
}

}  // namespace fettle::app
