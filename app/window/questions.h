#pragma once

#include <chrono>
#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "app/files/scan_thumbnail.h"
#include "app/texts/texts.h"
#include "app/window/actions.h"
#include "app/work/filter_list.h"
#include "app/work/loop_client.h"
#include "app/work/scan_reading.h"
#include "render/window/window.h"

namespace fettle::app {

/// What to do after the work is saved, or dropped.
struct Afterwards {
  enum class What : std::uint8_t { kNothing, kQuit, kOpen };
  What what = What::kNothing;
  std::string path = {};  ///< kOpen
  std::optional<ScanOptions> reading =
      {};  ///< kOpen: how it is to be read; nothing: as every scan of this run
};

/// A dialog that the user answers, or reads, before anything else, with all its data.
struct Question {
  enum class Kind : std::uint8_t {
    kOpen,
    kImport,
    kCompare,
    kJoin,
    kSaveAs,
    kExport,
    kOpenScene,
    kSaveScene,
    kExportSections,
    kExportReport,
    kExportFits,
    kExportFeatures,
    kUnsaved,
    kUnsavedScene,
    kReplace,
    kRecover,
    kDevice,
    kShortcuts,
    kMessage
  };
  Kind kind = Kind::kMessage;
  std::string path =
      {};  ///< kOpen, kCompare, kJoin, kSaveAs, kExport and others: as typed so far; kReplace: the confirmed one; kImport, kRecover: of the scan
  Afterwards afterwards = {};               ///< kSaveAs, kSaveScene, kUnsaved, kUnsavedScene, kReplace
  std::optional<ScanOptions> reading = {};  ///< kImport, kRecover: of the scan, as Afterwards::reading
  /// kImport: the scan was read, something had to be guessed, and it waits to be confirmed; its picture.
  std::shared_ptr<const ScanThumbnail> guessed = {};
  std::string sought = {};  ///< kShortcuts: as typed so far
  /// kShortcuts: what was chosen there, an action, a panel by its name, or a filter.
  std::optional<Action> wanted = {};
  std::string panel = {};
  std::optional<engine::FilterKind> filter = {};
  bool stop_asking = false;  ///< kUnsaved, kUnsavedScene: ticked so far
  Notice said =
      {};  ///< kMessage; kOpen, kCompare, kJoin, kOpenScene: why the file of the path could not be read
  Kind from = Kind::kSaveAs;               ///< kReplace, kImport: the dialog of the path
  bool typed = false;                      ///< the path came from there, and the user can go back to it
  std::vector<std::string> replaced = {};  ///< kReplace: a sentence for each file to be replaced
  bool confirmed = false;  ///< kCompare, kJoin: it is answered when it is known whether the file can be read
};

/// "open", "save as", ...: stable, for scripts.
[[nodiscard]] const char* name(Question::Kind kind);

/// The dialogs: the one on the screen and those that wait for it. Whether one is on the screen is read from
/// ImGui's stack of popups: ImGui closes popups by itself, when the keyboard focus moves to another window,
/// so a state of our own could differ. A question stays until it is answered or ImGui has closed its popup;
/// one that was closed before it was visible is shown again.
///
/// Threading: main thread, with an ImGui context.
class Questions {
 public:
  /// Shows a question with the next frame, or after those before it. A request of the user replaces the
  /// previous request of the user, answered or not; a message waits until the dialog on the screen is closed,
  /// and stays until it is closed itself. A message is never shown twice at the same time.
  void ask(Question question);
  /// Whether there was a question since the last call: other input ends until it is answered.
  [[nodiscard]] bool takeAsked() { return std::exchange(asked_, false); }
  /// Drops the questions about a field that is being closed: where to save it, whether to.
  void dropOfField();

  /// Whether one is on the screen or will be with the next frame. It gets all keys until it is answered.
  [[nodiscard]] bool pending() const { return !waiting_.empty() || unseen() || shown() != nullptr; }
  /// The one on the screen; null: none.
  [[nodiscard]] const Question* shown() const;
  /// Frames in which the one on the screen was laid out; it is visible from the second one on.
  [[nodiscard]] int frames() const { return shown() != nullptr ? frames_ : 0; }

  /// A key while pending(). It answers the dialog that was on the screen when it was pressed: a key that
  /// comes before the dialog, or is not used by it, is dropped.
  void press(const render::InputEvent& event);
  /// Whether a key waits to be used as an answer in the next frame: later input refers to the state after
  /// that.
  [[nodiscard]] bool answering() const { return key_ != render::Key::kNone; }

  /// Once per frame, with no window begun: the question to lay out; null: none. Between begin() and end().
  [[nodiscard]] Question* next();
  /// Begins its popup, as ImGui::BeginPopupModal; end() is called only after true.
  [[nodiscard]] bool begin();
  void end();
  /// Between begin() and end(): whether this key answers; once. Key::kEnter is that of the keypad, too.
  [[nodiscard]] bool take(render::Key key);
  /// Between begin() and end(): it is answered, and removed from the screen with the next frame.
  Question close();
  /// Whether there was one in one of the last frames: for two frames ImGui still reports that a text field
  /// has the keyboard, that of the closed dialog.
  [[nodiscard]] bool justClosed() const noexcept { return frames_without_ < kClosed; }

 private:
  // Shown and closed by ImGui before it was visible.
  [[nodiscard]] bool unseen() const { return shown_.has_value() && frames_ < kSeen && shown() == nullptr; }
  void drop();

  static constexpr int kSeen = 2;  // frames: ImGui measures a dialog in the first one and hides it there
  static constexpr int kClosed = 3;

  std::deque<Question> waiting_;
  std::optional<Question> shown_;  // invalid once ImGui has closed the popup
  unsigned id_ = 0;                // ImGui's, of that popup
  int frames_ = 0;
  int frames_without_ = kClosed;
  bool asked_ = false;
  render::Key key_ = render::Key::kNone;
};

/// What notices of the graphics device contain.
inline constexpr const char* kDeviceLost = textOf("the graphics device was lost");

/// Messages and dialogs for the user: the notices over the panels, the line of the status bar, the dialogs.
/// The parts of the window report here. Threading: main.
struct Feedback {
  static constexpr std::size_t kMostNotices = 6;
  static constexpr std::chrono::seconds kPassing{12};  ///< enough to read two lines twice

  std::vector<Notice> notices;  ///< oldest first
  std::string status;
  Questions questions;

  /// Once per frame in which notices are shown: those that pass go after kPassing.
  void dropPassed(std::chrono::steady_clock::time_point now);
  /// What is said of a field goes with it: questions, and notices but for those of the graphics device.
  void dropOfField();
  /// A notice, unless it stands there, or was said and is to be said once.
  void take(Notice notice);
  void note(const engine::Error& error) { notices.push_back({error.what, error.remedy}); }
  /// Shows a message dialog.
  void message(std::string what, std::string remedy) {
    questions.ask({.kind = Question::Kind::kMessage, .said = {std::move(what), std::move(remedy)}});
  }

 private:
  std::vector<Notice> said_once_;
};

}  // namespace fettle::app
