#include "app/window/active_document.h"

#include <filesystem>
#include <utility>

#include <fmt/format.h>

#include "app/window/view_text.h"
#include "app/work/recent_files.h"
#include "engine/formats/formats.h"

namespace fettle::app {
namespace {

namespace fs = std::filesystem;

constexpr auto kNoteEvery = std::chrono::seconds(1);

// What a scan or session is felt with at first.
haptic::Scene firstScene(const Document& document, const std::optional<haptic::Scene>& given,
                         LoopClientOptions& options) {
  options.fit_spring = !given.has_value();
  if (given) return *given;
  haptic::Scene scene = haptic::defaultScene();
  if (const auto noted = document.notes.find("scene"); noted == document.notes.end()) {
    // Wider than the default's one sample: what a person sees under a brush.
    scene.brush_radius_samples = 6.0;
    scene.mark_radius_samples = 3.0;
  } else if (const auto kept = haptic::parseScene(noted->second, "the session's scene")) {
    scene = *kept;
    options.fit_spring = false;
    // It may have been worked on with another device, and opens with this one all the same.
    options.lower_scene = true;
  }
  return scene;
}

}  // namespace

engine::Status ActiveDocument::open(Document& document, const std::optional<haptic::Scene>& scene,
                                    LoopClientOptions options) {
  const haptic::Scene first = firstScene(document, scene, options);
  const engine::History history = document.history;
  keeper_ = std::make_unique<SessionKeeper>(document);
  auto touch = LoopClient::start(history, document.original, first, options, keeper_.get());
  if (!touch) {
    keeper_.reset();
    return tl::unexpected(touch.error());
  }
  touch_ = std::move(*touch);
  path_ = document.path;
  // What was recovered is still to be saved.
  saved_ = document.recovered ? document.original : history.current();
  return {};
}

engine::Status ActiveDocument::close(SessionKeeper::Afterwards afterwards) {
  touch_->finish();
  engine::Status closed = keeper_->close(afterwards);
  touch_.reset();
  keeper_.reset();
  return closed;
}

std::string ActiveDocument::rescue() {
  const bool had_unsaved = unsaved();
  const std::string session = keeper_->named() ? keeper_->path() : std::string();
  touch_->finish();
  const engine::Version field = touch_->upright();
  const engine::Status closed = close(SessionKeeper::Afterwards::kKeep);
  if (closed && !session.empty()) return fmt::format("everything is kept in {}; ", session);
  if (closed)
    return had_unsaved ? fmt::format("what was not saved is kept for when {} is opened again; ", path_) : "";

  // The session cannot be written where it is: the field, at least, goes next to the scan or to where programs
  // may write.
  const std::string why = closed.error().line();
  for (const fs::path& folder :
       {fs::path(path_).parent_path(), fs::path(settingsFolder()), fs::path("/tmp")}) {
    const std::string stem = (folder / (fs::path(path_).stem().string() + "_rescued")).string();
    std::error_code error;
    std::string path = stem + ".fettle";
    for (int n = 2; fs::exists(path, error); ++n) path = fmt::format("{}_{}.fettle", stem, n);
    engine::JobControl job;
    if (engine::exportField(field, path, {}, job))
      return fmt::format("{}; the field with its marks is kept in {}; ", why, path);
  }
  return fmt::format("{}; what was not saved is gone; ", why);
}

std::string ActiveDocument::fileName() const {
  return fs::path(path_).filename().string();
}

std::string ActiveDocument::suggestedPath(const char* ending) const {
  const fs::path scan(path_);
  return (scan.parent_path() / (scan.stem().string() + ending)).string();
}

void ActiveDocument::poll(const render::View& view, Feedback& feedback) {
  touch_->poll();
  if (auto older = keeper_->older()) {
    if (*older) {
      touch_->prepend(**older);
      touch_->undo();
    } else {
      feedback.note(older->error());
    }
  }
  updateSession(view, feedback);
}

void ActiveDocument::updateSession(const render::View& view, Feedback& feedback) {
  const auto error = keeper_->error();
  if (error && !keeping_fails_)
    feedback.message(fmt::format("The work cannot be kept: {}", error->line()),
                     "Nothing is lost while the program runs, and it tries again by itself. Save somewhere "
                     "else: Ctrl+Shift+S.");
  keeping_fails_ = error.has_value();
  const auto now = std::chrono::steady_clock::now();
  if (now - noted_ < kNoteEvery) return;
  noted_ = now;
  keeper_->setNote("camera", viewText(view));
  keeper_->setNote("scene", haptic::sceneText(touch_->scene()));
}

void ActiveDocument::undo() {
  const engine::History& history = touch_->history();
  if (touch_->canUndo() || history.first() == 0) {
    touch_->undo();
  } else if (!keeper_->readingOlder()) {
    keeper_->readOlder(history);
  }
}

bool ActiveDocument::unsaved() const {
  if (!touch_) return false;
  // A session of the user's holds everything, unless it cannot be written.
  if (keeper_->named()) return keeper_->error().has_value();
  return !(touch_->upright() == saved_);
}

std::string ActiveDocument::keptText() const {
  if (const auto error = keeper_->error())
    return fmt::format("not kept: {}; the work is in memory, save it elsewhere", error->what);
  const std::size_t waiting = keeper_->waiting();
  const std::string session = keeper_->path();
  if (keeper_->named())
    return fmt::format("{} {}", waiting > 0 ? "writing" : "kept in", fs::path(session).filename().string());
  if (!unsaved()) return {};
  return session.empty() || waiting > 0 ? "changed" : "changed, kept until it is saved";
}

}  // namespace fettle::app
