#pragma once

#include <chrono>
#include <memory>
#include <optional>
#include <string>

#include "app/window/feedback.h"
#include "app/work/loop_client.h"
#include "app/work/session_keeper.h"

namespace fettle::app {

/// What is worked on: the field with its loop, and the session that keeps what is done to it. None is open at
/// first and where a scan could not be started. Threading: main.
class ActiveDocument {
 public:
  /// Starts the loop on it. None must be open. `scene`: given by the user, else the session's or the default.
  /// Errors: LoopClient::start; none is open then.
  [[nodiscard]] engine::Status open(Document& document, const std::optional<haptic::Scene>& scene,
                                    LoopClientOptions options);
  /// Ends the loop, a stroke that runs becomes a step, and the session is written. Errors: what was not
  /// written is lost. None is open afterwards.
  engine::Status close(SessionKeeper::Afterwards afterwards);
  /// Ends it where nobody can be asked any more, with the field in a file of its own if the session cannot be
  /// written. Returns where the work is, as the beginning of a remedy; empty when there is nothing to say.
  [[nodiscard]] std::string rescue();

  [[nodiscard]] bool isOpen() const noexcept { return touch_ != nullptr; }
  /// Null while none is open.
  [[nodiscard]] LoopClient* touch() const noexcept { return touch_.get(); }
  [[nodiscard]] SessionKeeper* keeper() const noexcept { return keeper_.get(); }
  /// Of the scan or session, the last one that was open; empty before the first.
  [[nodiscard]] const std::string& path() const noexcept { return path_; }
  [[nodiscard]] std::string fileName() const;
  /// "/folder/scan" + `ending`.
  [[nodiscard]] std::string suggestedPath(const char* ending) const;

  /// Takes in what loop and session report; texts that the session is opened with again are noted, and once
  /// it is said that the work cannot be kept, with the way out.
  void poll(const render::View& view, Feedback& feedback);
  /// The step before, read from the session where memory does not hold it.
  void undo();

  /// Whether closing loses something.
  [[nodiscard]] bool unsaved() const;
  /// How the work is kept, for the status bar.
  [[nodiscard]] std::string keptText() const;
  /// A file holds this state, the right way up.
  void noteSaved(const engine::Version& upright) { saved_ = upright; }
  /// The session lies elsewhere from now on.
  void noteMoved() { path_ = keeper_->path(); }

 private:
  void updateSession(const render::View& view, Feedback& feedback);

  std::string path_;
  std::unique_ptr<SessionKeeper> keeper_;  // there with touch_, and outlives it
  std::unique_ptr<LoopClient> touch_;
  engine::Version saved_;  // upright, as the file holds it
  std::chrono::steady_clock::time_point noted_{};
  bool keeping_fails_ = false;  // and the user knows
};

}  // namespace fettle::app
