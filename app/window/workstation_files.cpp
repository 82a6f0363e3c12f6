#include <algorithm>
#include <filesystem>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "app/terminal.h"
#include "app/window/workstation.h"
#include "app/work/outputs.h"
#include "app/work/session_guard.h"
#include "engine/formats/formats.h"
#include "engine/io/raster/marks.h"

namespace fettle::app {
namespace {

namespace fs = std::filesystem;

// A scan up to so many samples goes into the session whole unless the user says otherwise.
constexpr std::int64_t kEmbedded = std::int64_t{16} << 20;
constexpr auto kNoteEvery = std::chrono::seconds(1);

std::string nameOf(const std::string& path) {
  return fs::path(path).filename().string();
}

bool anyMark(const engine::Version& version) {
  return version.reader().root().marked_children != 0;
}

// The marks lie beside the field: NAME_marks.png.
std::string marksPath(const std::string& path) {
  const fs::path p(path);
  return (p.parent_path() / (p.stem().string() + "_marks.png")).string();
}

std::string viewText(const render::View& view) {
  return nlohmann::json{{"azimuth", view.azimuth_deg},
                        {"elevation", view.elevation_deg},
                        {"zoom", view.zoom},
                        {"centre", {view.centre_x, view.centre_y}},
                        {"exaggeration", view.vertical_exaggeration},
                        {"perspective", view.projection == render::Projection::kPerspective}}
      .dump();
}

// What a session says of the camera; the start's where it does not.
render::View viewOf(const std::string& text) {
  render::View view;
  view.azimuth_deg = 330.0;
  const auto said = nlohmann::json::parse(text, nullptr, false);
  if (!said.is_object()) return view;
  try {
    view.azimuth_deg = said.at("azimuth").get<double>();
    view.elevation_deg = said.at("elevation").get<double>();
    view.zoom = said.at("zoom").get<double>();
    view.centre_x = said.at("centre").at(0).get<double>();
    view.centre_y = said.at("centre").at(1).get<double>();
    view.vertical_exaggeration = said.at("exaggeration").get<double>();
    if (said.at("perspective").get<bool>()) view.projection = render::Projection::kPerspective;
  } catch (const nlohmann::json::exception&) {
    view = {};
    view.azimuth_deg = 330.0;
  }
  return view;
}

}  // namespace

bool Workstation::unsaved() const {
  if (!touch_) return false;
  // A session of the user's holds everything, unless it cannot be written.
  if (keeper_->named()) return keeper_->error().has_value();
  return !(touch_->upright() == saved_);
}

std::string Workstation::sessionText() const {
  if (!keeper_) return {};
  if (const auto error = keeper_->error())
    return fmt::format("not kept: {}; the work is in memory, save it elsewhere", error->what);
  const std::size_t waiting = keeper_->waiting();
  if (keeper_->named())
    return fmt::format("{} {}", waiting > 0 ? "writing" : "kept in", nameOf(keeper_->path()));
  if (!unsaved()) return {};
  return keeper_->path().empty() || waiting > 0 ? "changed" : "changed, kept until it is saved";
}

std::string Workstation::suggestedPath(const char* ending) const {
  const fs::path scan(path_);
  return (scan.parent_path() / (scan.stem().string() + ending)).string();
}

void Workstation::askToOpen(const std::string& path) {
  if (unsaved()) {
    ask({.kind = Question::Kind::kUnsaved, .afterwards = {Afterwards::What::kOpen, path}});
  } else {
    open(path);
  }
}

void Workstation::askToQuit() {
  if (!unsaved()) {
    leave();
    return;
  }
  ask({.kind = Question::Kind::kUnsaved, .afterwards = {Afterwards::What::kQuit, ""}});
}

// With what waited for an answer, or for saving.
void Workstation::goOn(const Afterwards& afterwards) {
  if (afterwards.what == Afterwards::What::kQuit) leave();
  if (afterwards.what == Afterwards::What::kOpen) open(afterwards.path);
}

void Workstation::open(const std::string& path) {
  std::error_code error;
  const std::string recovery = isSessionPath(path) ? std::string() : recoveryPath(path);
  const bool own = keeper_ && keeper_->path() == recovery;
  if (!recovery.empty() && !own && fs::exists(recovery, error)) {
    ask({.kind = Question::Kind::kRecover, .path = path});
    return;
  }
  load(path, Recovery::kLeave);
}

void Workstation::load(const std::string& path, Recovery recovery) {
  loading_path_ = path;
  load_asked_ = std::chrono::steady_clock::now();
  dropCoarse();
  if (!touch_) opening_ = {load_asked_};
  loading_.start(openingWork(path, recovery));
}

void Workstation::takeDocument(Document document) {
  const double coarse_ms = touch_ ? 0.0 : opening_.coarse_ms;
  opening_ = {load_asked_, coarse_ms};
  opening_.read_ms = opening_.sinceAsked();
  const engine::Grid& grid = document.original.grid();
  LoopClientOptions options = options_.touch;
  options.fit_spring = !options_.scene.has_value();
  haptic::Scene scene = options_.scene.value_or(haptic::defaultScene());
  const auto noted = document.notes.find("scene");
  if (!options_.scene && noted != document.notes.end()) {
    if (const auto kept = haptic::parseScene(noted->second, "the session's scene")) {
      scene = *kept;
      options.fit_spring = false;
      // It may have been worked on with another device, and opens with this one all the same.
      options.lower_scene = true;
    }
  } else if (!options_.scene) {
    // Wider than the seed's one sample: what a person sees under a brush.
    scene.brush_radius_samples = 6.0;
    scene.mark_radius_samples = 3.0;
  }
  closeDocument(SessionKeeper::Afterwards::kDiscard);
  const engine::History history = document.history;
  keeper_ = std::make_unique<SessionKeeper>(document);
  auto touch = LoopClient::start(history, document.original, scene, options, keeper_.get());
  if (!touch) {
    keeper_.reset();
    dropCoarse();
    if (path_.empty())
      end_ = tl::unexpected(touch.error());
    else
      message(touch.error().line(), "");
    return;
  }
  touch_ = std::move(*touch);
  const bool looked_at = coarse_.has_value();
  dropCoarse();  // its picture stays until there is one of the whole
  opening_.touched_ms = opening_.sinceAsked();
  path_ = document.path;
  save_path_.clear();
  // What was recovered is still to be saved.
  saved_ = document.recovered ? document.original : history.current();
  measured_ = document.original;
  deviation_.reset();
  embeds_ = grid.samples() <= kEmbedded;
  const auto camera = document.notes.find("camera");
  // Who has turned the coarse picture goes on from there.
  if (!looked_at) view_ = viewOf(camera != document.notes.end() ? camera->second : std::string());
  shown_ = {};
  refinement_ = {};
  figures_ = {};
  chooseTool(std::nullopt);
  recent_.add(path_);
  for (const std::string& warning : document.warnings) notices_.push_back({warning, ""});
  if (options_.scene) noteWithoutForce(touch_->scene());
  if (document.recovered)
    notices_.push_back({fmt::format("{} steps that were not saved are here again", history.number()), ""});
  status_text_ = fmt::format("{}: {} x {} samples, {:.4g} x {:.4g} {}", nameOf(path_), grid.width,
                             grid.height, grid.spacing_x, grid.spacing_y, grid.lateral_unit.name);
  window_->setTitle(nameOf(path_) + " - Fettle");
  stale_ = true;
}

void Workstation::closeDocument(SessionKeeper::Afterwards afterwards) {
  if (!touch_) return;
  letGo();
  questions_.forgetField();
  filters_.cancel(*touch_);
  measuring_.cancel();
  write_after_scan_ = false;
  costs_.reset();
  // A stroke that runs is a step yet.
  touch_->finish();
  if (const auto closed = keeper_->close(afterwards); !closed)
    warn(fmt::format("{}: what was not written is gone", closed.error().line()));
  touch_.reset();
  keeper_.reset();
}

void Workstation::leave() {
  quit_ = true;
}

// Says once that the work cannot be kept, with the way out; texts that a session is opened with again.
void Workstation::lookAfterSession() {
  const auto error = keeper_ ? keeper_->error() : std::nullopt;
  if (error && !keeping_fails_)
    message(fmt::format("The work cannot be kept: {}", error->line()),
            "Nothing is lost while the program runs, and it tries again by itself. Save somewhere else: "
            "Ctrl+Shift+S.");
  keeping_fails_ = error.has_value();
  const auto now = std::chrono::steady_clock::now();
  if (!touch_ || now - noted_ < kNoteEvery) return;
  noted_ = now;
  keeper_->setNote("camera", viewText(view_));
  keeper_->setNote("scene", haptic::sceneText(touch_->scene()));
}

void Workstation::save(Afterwards afterwards) {
  if (keeper_->named()) {
    startSaving(keeper_->path(), Keeping::kWorkThere, std::move(afterwards));
  } else if (!save_path_.empty()) {
    // Written there before; but marks, when there were none then, may come upon a file of another's.
    std::vector<std::string> outputs = outputsOf(save_path_, Keeping::kWorkThere);
    std::erase_if(outputs, [&](const std::string& path) { return std::ranges::count(written_, path) > 0; });
    if (replacedFiles(outputs, {}).texts.empty())
      startSaving(save_path_, Keeping::kWorkThere, std::move(afterwards));
    else
      askToWrite({.kind = Question::Kind::kSaveAs, .path = save_path_, .afterwards = std::move(afterwards)},
                 Typed::kNo);
  } else {
    // Never over the scan itself without being told so.
    ask({.kind = Question::Kind::kSaveAs,
         .path = suggestedPath(".fettle"),
         .afterwards = std::move(afterwards)});
  }
}

// The files that are written, and may replace others.
std::vector<std::string> Workstation::outputsOf(const std::string& path, Keeping keeping) const {
  if (isSessionPath(path)) {
    // Onto itself a session loses nothing.
    std::error_code none;
    const bool itself = keeping == Keeping::kWorkThere && fs::equivalent(path, keeper_->path(), none);
    return itself ? std::vector<std::string>() : std::vector{path};
  }
  if (anyMark(touch_->upright())) return {path, marksPath(path)};
  return {path};
}

// The path of `from`, a question for one, with a question where a file would be replaced. kTyped: "go back"
// leads to `from` again.
void Workstation::askToWrite(Question from, Typed typed) {
  const Keeping keeping = keepingOf(from.kind);
  std::error_code none;
  if (keeping == Keeping::kCopy && fs::equivalent(from.path, keeper_->path(), none)) {
    message(
        fmt::format("{} is the session that is worked on: everything is kept there as it is done", from.path),
        "name another file for a copy");
    return;
  }
  ReplacedFiles files = replacedFiles(outputsOf(from.path, keeping), keeper_->scanPath());
  if (files.texts.empty()) {
    startSaving(from.path, keeping, std::move(from.afterwards));
    return;
  }
  ask({.kind = Question::Kind::kReplace,
       .path = std::move(from.path),
       .afterwards = std::move(from.afterwards),
       .from = from.kind,
       .typed = typed == Typed::kYes,
       .replaced = std::move(files.texts)});
}

void Workstation::startSaving(const std::string& path, Keeping keeping, Afterwards afterwards) {
  if (auto status = checkPlaces({{path, OutputKind::kField}}, {}); !status) {
    message(status.error().line(), "");
    return;
  }
  saving_path_ = path;
  keeping_ = keeping;
  after_saving_ = std::move(afterwards);
  // A session that refers to the scan could not be opened again with another file in the scan's place.
  if (replacedFiles(outputsOf(path, keeping), keeper_->scanPath()).scan) {
    write_after_scan_ = true;
    keeper_->keepScan();
    return;
  }
  write(path, keeping);
}

void Workstation::write(const std::string& path, Keeping keeping) {
  if (isSessionPath(path) && keeping == Keeping::kWorkThere) {
    touch_->poll();
    keeper_->saveAs(path,
                    embeds_ ? engine::OriginalStorage::kEmbedded : engine::OriginalStorage::kReferenced);
    return;
  }
  writing_ = outputsOf(path, keeping);
  saving_.start([path, field = touch_->upright(), original = touch_->original(),
                 outputs = writing_](engine::JobControl& job) -> engine::Result<engine::Version> {
    ScanGuard guard;  // of other sessions: this one does not need the file any more
    for (const std::string& output : outputs)
      if (auto spared = guard.protectSessions(output, job); !spared) return tl::unexpected(spared.error());
    engine::ExportOptions options;
    options.original = original;
    auto done = engine::exportField(field, path, options, job);
    if (!done) return tl::unexpected(done.error());
    if (anyMark(field) && !isSessionPath(path))
      if (auto marks = engine::exportMarks(field, marksPath(path)); !marks)
        return tl::unexpected(marks.error());
    return field;
  });
}

void Workstation::takeSaved() {
  std::optional<engine::Status> ended;
  if (auto kept = keeper_ ? keeper_->scanKept() : std::nullopt;
      kept && std::exchange(write_after_scan_, false)) {
    if (*kept)
      write(saving_path_, keeping_);
    else
      ended = std::move(*kept);
  }
  if (auto done = saving_.take()) {
    ended = *done ? engine::Status{} : tl::unexpected(done->error());
    if (*done && keeping_ == Keeping::kWorkThere) {
      save_path_ = saving_path_;
      written_ = writing_;
      saved_ = **done;
    }
  }
  if (keeper_)
    if (auto done = keeper_->saved()) {
      ended = std::move(*done);
      if (*ended) {
        path_ = keeper_->path();
        recent_.add(path_);
        window_->setTitle(nameOf(path_) + " - Fettle");
      }
    }
  if (!ended) return;
  const Afterwards afterwards = std::exchange(after_saving_, {});
  if (*ended) {
    status_text_ = fmt::format("written: {}", saving_path_);
    goOn(afterwards);
    return;
  }
  if (ended->error().kind != engine::ErrorKind::kCancelled)
    message(ended->error().line(), "the work is kept here; save it elsewhere");
}

void Workstation::undo() {
  const engine::History& history = touch_->history();
  if (touch_->canUndo() || history.first() == 0) {
    touch_->undo();
  } else if (!keeper_->readingOlder()) {
    keeper_->readOlder(history);
  }
}

}  // namespace fettle::app
