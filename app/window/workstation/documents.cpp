// Which scan is worked on: how one is asked for, read and begun with.
#include "app/texts/texts.h"
#include "app/window/workstation/workstation.h"

#include <filesystem>
#include <utility>

#include <fmt/format.h>

#include "app/files/reading_fields.h"
#include "app/window/panels/scan_facts.h"
#include "app/window/scene_edits.h"

namespace fettle::app {

void Workstation::askToOpen(const std::string& path, std::optional<ScanOptions> reading) {
  if (parts_.document.unsaved())
    parts_.feedback.questions.ask({.kind = Question::Kind::kUnsaved,
                                   .afterwards = {Afterwards::What::kOpen, path, std::move(reading)}});
  else
    open(path, reading);
}

// Continues with what waited for an answer, or for saving.
void Workstation::resumeAfterSave(const Afterwards& afterwards) {
  if (afterwards.what == Afterwards::What::kQuit) parts_.quit = Quit::kDone;
  if (afterwards.what == Afterwards::What::kOpen) open(afterwards.path, afterwards.reading);
}

void Workstation::open(const std::string& path, const std::optional<ScanOptions>& reading) {
  std::error_code error;
  const std::string recovery = isSessionPath(path) ? std::string() : recoveryPath(path);
  const SessionKeeper* const keeper = parts_.document.keeper();
  const bool own = keeper != nullptr && keeper->path() == recovery;
  if (!recovery.empty() && !own && std::filesystem::exists(recovery, error))
    parts_.feedback.questions.ask({.kind = Question::Kind::kRecover, .path = path, .reading = reading});
  else
    load(path, Recovery::kLeave, reading);
}

void Workstation::load(const std::string& path, Recovery recovery,
                       const std::optional<ScanOptions>& reading) {
  parts_.dropCoarse();
  unconfirmed_.reset();
  // The command line says how its scan and all scans are to be read, work is what it was begun on, and of some scans it
  // was said before.
  const bool said = reading || recovery == Recovery::kTake || path == options_.scan ||
                    !scanOptionsText(parts_.usual_reading).empty() || parts_.files.readings.find(path);
  parts_.opening.start(path, recovery, reading ? *reading : parts_.readingOf(path),
                       said ? Guesses::kTake : Guesses::kAsk, parts_.document.isOpen());
}

void Workstation::takeOpened() {
  if (unconfirmed_ && !parts_.feedback.questions.pending()) unconfirmed_.reset();  // nobody wants it
  auto done = parts_.opening.take();
  if (!done) return;
  parts_.picture.requestRedraw();
  if (*done) {
    Opened& opened = **done;
    if (opened.guessed == nullptr)
      startDocument(std::move(opened.document));
    else
      askHowToRead(std::move(opened));
    return;
  }
  parts_.dropCoarse();
  const engine::Error& error = done->error();
  if (error.kind == engine::ErrorKind::kCancelled) return;
  if (!parts_.document.isOpen() && parts_.opening.path() == options_.scan)
    end_ = tl::unexpected(error);  // named on the command line: its errors are the command's
  else if (std::exchange(dialog_path_, {}) == parts_.opening.path())
    // Back to the dialog in which it was chosen: another one is chosen there, or how this one is read.
    parts_.feedback.questions.ask({.kind = Question::Kind::kOpen,
                                   .path = parts_.opening.path(),
                                   .said = {inFieldWords(error.line()), ""}});
  else
    parts_.feedback.message(inFieldWords(error.line()), "");
}

// It was read, and waits until somebody has said that what was guessed is right.
void Workstation::askHowToRead(Opened opened) {
  parts_.dropCoarse();
  parts_.feedback.questions.ask({.kind = Question::Kind::kImport,
                                 .path = opened.document.path,
                                 .reading = ScanOptions(),
                                 .guessed = std::move(opened.guessed),
                                 .from = Question::Kind::kOpen,
                                 .typed = std::exchange(dialog_path_, {}) == opened.document.path});
  unconfirmed_ = std::move(opened.document);
}

void Workstation::startDocument(Document document) {
  ++documents_;
  Parts& p = parts_;
  p.opening.noteRead(p.document.isOpen());
  p.closeDocument(SessionKeeper::Afterwards::kDiscard);
  const bool first = p.document.path().empty();
  options_.client.loudness = p.settings.loudness;
  options_.client.setups = p.settings.devices;
  if (const auto opened = p.document.open(document, options_.scene, options_.client); !opened) {
    p.dropCoarse();
    if (first)
      end_ = opened;
    else
      p.feedback.message(opened.error().line(), "");
    return;
  }
  LoopClient& client = *p.document.client();
  const engine::Grid& grid = document.original.grid();
  const bool looked_at = p.opening.coarse() != nullptr;
  p.dropCoarse();  // the coarse picture stays until the scan is read
  p.opening.noteTouched();
  p.reading = scanOptionsOf(document.scan.import);
  p.saving.begin(grid.samples());
  p.change.begin(client.original());
  p.settings.display.marks = true;
  p.steps_seen = client.history().number();
  tool_results_.begin(p);
  p.scene_files.begin(client, options_.scene ? options_.scene_path : std::string());
  // A view that was changed in the coarse picture is kept.
  const auto camera = document.notes.find("camera");
  if (!looked_at) p.view = camera != document.notes.end() ? viewOf(camera->second) : startView();
  restoreSections(document);
  if (const auto views = document.notes.find(Bookmarks::kNote); views != document.notes.end())
    p.bookmarks.restore(views->second);
  p.picture.clear();
  p.chooseTool(std::nullopt);
  p.recent.add(p.document.path());
  noteWarnings(document.warnings);
  if (options_.scene) noteWithoutForce(client, p.feedback.notices);
  if (document.scan.import.depth_camera && client.scene().invert)
    p.feedback.notices.push_back({tr("distances from a camera are shown upside down: what is near is high"),
                                  tr("I shows them as they are stored")});
  if (document.recovered)
    p.feedback.notices.push_back({trFormat("{} unsaved steps were restored", client.history().number()), ""});
  p.feedback.status =
      trFormat("{}: {} x {} samples, {}", p.document.fileName(), grid.width, grid.height, spacingText(grid));
  window_->setTitle(p.document.fileName() + " - Fettle");
}

// What reading said, with the name of the file; where a person can say more, with the page for it.
void Workstation::noteWarnings(const std::vector<std::string>& warnings) {
  Parts& p = parts_;
  const bool scan = !isSessionPath(p.document.path());
  const auto said = scan ? p.files.readings.find(p.document.path()) : std::nullopt;
  const bool as_said = said && scanOptionsText(*said) == scanOptionsText(p.reading);
  if (const std::string text = as_said ? readingText(*said) : ""; !text.empty())
    p.feedback.notices.push_back(
        {trFormat("{} is read as you said: {}", p.document.fileName(), text), "", "", 1, true, true});
  for (const std::string& warning : warnings) {
    // Who has seen the page and left it so does not want to be asked again.
    if (as_said && isGuess(warning)) continue;
    const std::string text = inFieldWords(warning);
    p.feedback.notices.push_back(
        {fmt::format("{}: {}", p.document.fileName(), text), "", "", 1, scan && text != warning});
  }
}

void Workstation::restoreSections(const Document& document) {
  const auto kept = document.notes.find(engine::kSectionsNote);
  if (kept == document.notes.end()) return;
  auto sections = sectionsOf(kept->second);
  if (sections)
    parts_.section.restore(*std::move(sections));
  else
    parts_.feedback.notices.push_back({sections.error().what, tr("the session is as it was otherwise")});
}

}  // namespace fettle::app
