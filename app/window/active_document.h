#pragma once

#include <chrono>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "app/window/questions.h"
#include "app/work/loop_client.h"
#include "app/work/session_keeper.h"

namespace fettle::app {

/// The open document: the field with its loop, and the session that stores the work. None is open at first
/// and where a scan could not be started. Threading: main.
class ActiveDocument {
 public:
  /// Starts the loop on it. None must be open. `scene`: given by the user, else the session's or the default.
  /// Errors: LoopClient::start; none is open then.
  [[nodiscard]] engine::Status open(Document& document, const std::optional<haptic::Scene>& scene,
                                    LoopClientOptions options);
  /// Ends the loop, completes a running stroke as a step, and writes the session. Errors: what was not
  /// written is lost. None is open afterwards.
  engine::Status close(SessionKeeper::Afterwards afterwards);
  /// Ends it without a dialog, with the field in a file of its own if the session cannot be written. Returns
  /// the location of the work, as the beginning of a remedy; empty when nothing needs to be reported.
  [[nodiscard]] std::string rescue();

  [[nodiscard]] bool isOpen() const noexcept { return loop_ != nullptr; }
  /// Null while none is open.
  [[nodiscard]] LoopClient* client() const noexcept { return loop_.get(); }
  [[nodiscard]] SessionKeeper* keeper() const noexcept { return keeper_.get(); }
  /// Of the scan or session, the last one that was open; empty before the first.
  [[nodiscard]] const std::string& path() const noexcept { return path_; }
  [[nodiscard]] std::string fileName() const;
  /// "/folder/scan" + `ending`.
  [[nodiscard]] std::string suggestedPath(const char* ending) const;

  /// Processes the reports of loop and session; stores the notes of the session, and reports once if the work
  /// cannot be stored, with a remedy.
  void poll(const render::View& view, Feedback& feedback);
  /// Restores the previous step, read from the session where memory does not hold it.
  void undo();

  /// Gives the session what it keeps besides steps - camera, scene, sections, bookmarks - as it is now.
  void storeNotes(const render::View& view);

  /// Whether closing would lose something.
  [[nodiscard]] bool unsaved() const;
  /// How the work is stored, for the status bar. `exported`: a file that holds it as it is now; empty: there is none.
  [[nodiscard]] std::string keptText(const std::string& exported) const;
  /// A file contains this state, with sign +1.
  void noteSaved(const engine::Version& upright) { saved_ = upright; }
  /// The window's sections (sectionsText), for the session; it is written at most once a second, and at the end.
  void keepSections(std::string text) { sections_ = std::move(text); }
  /// The window's bookmarks (Bookmarks::text), likewise.
  void keepViews(std::string text) { views_ = std::move(text); }
  /// The session has moved to another file.
  void noteMoved() { path_ = keeper_->path(); }

 private:
  void updateSession(const render::View& view, Feedback& feedback);
  void noteDrawn();

  std::string path_;
  std::unique_ptr<SessionKeeper> keeper_;  // exists with loop_, and outlives it
  std::unique_ptr<LoopClient> loop_;
  engine::Version saved_;  // upright, as in the file
  std::string sections_;   // empty: none, and none before
  std::string views_;      // likewise
  std::chrono::steady_clock::time_point noted_{};
  std::chrono::steady_clock::time_point kept_{};  // nothing waited to be written
  bool keeping_fails_ = false;                    // and the user was informed
};

}  // namespace fettle::app
