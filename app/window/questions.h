#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "app/work/loop_client.h"
#include "render/window/window.h"

namespace fettle::app {

/// What is to be done once the work is saved, or dropped.
struct Afterwards {
  enum class What : std::uint8_t { kNothing, kQuit, kOpen };
  What what = What::kNothing;
  std::string path;  ///< kOpen
};

/// A dialog: what the user answers, or reads, before anything else goes on, with all that belongs to it.
struct Question {
  enum class Kind : std::uint8_t {
    kOpen,
    kSaveAs,
    kExport,
    kUnsaved,
    kReplace,
    kRecover,
    kShortcuts,
    kMessage
  };
  Kind kind = Kind::kMessage;
  std::string path = {};  ///< kOpen, kSaveAs, kExport: as typed so far; kReplace: that; kRecover: of the scan
  Afterwards afterwards = {};              ///< kSaveAs, kUnsaved, kReplace
  bool stop_asking = false;                ///< kUnsaved: ticked so far
  Notice said = {};                        ///< kMessage
  Kind from = Kind::kSaveAs;               ///< kReplace: what asked for the path, kSaveAs or kExport
  bool typed = false;                      ///< kReplace: and was on the screen, so that one can go back to it
  std::vector<std::string> replaced = {};  ///< kReplace: a sentence on each file that goes
};

/// "open", "save as", ...: stable, for scripts.
[[nodiscard]] const char* name(Question::Kind kind);

/// The dialogs: the one on the screen and those that wait for it. Whether one is on the screen is what
/// ImGui's stack of popups says, whenever it is asked: ImGui closes popups by itself, when the keyboard goes
/// to another window, and there is no second account of it that could differ. A question lives until it is
/// answered or ImGui has closed its popup; one that was closed before it could be seen is put up again.
///
/// Threading: main thread, with an ImGui context.
class Questions {
 public:
  /// Puts a question up with the next frame, or after those before it. What the user asks for takes the place
  /// of what the user asked for before, answered or not; a message waits until the dialog on the screen is
  /// left, and stays until it is. A message that is there already is not there twice.
  void ask(Question question);
  /// Whether something was asked since the last call: hands have nothing else to do until it is answered.
  [[nodiscard]] bool takeAsked() { return std::exchange(asked_, false); }
  /// Drops those about a field that goes: where to save it, whether to.
  void dropOfField();

  /// Whether one is on the screen or is put there with the next frame. Keys are its own until it is answered.
  [[nodiscard]] bool pending() const { return !waiting_.empty() || unseen() || shown() != nullptr; }
  /// The one on the screen; null: none.
  [[nodiscard]] const Question* shown() const;
  /// Frames that the one on the screen was laid out in; it is seen from the second one on.
  [[nodiscard]] int frames() const { return shown() != nullptr ? frames_ : 0; }

  /// A key while pending(). It answers what was on the screen when it was pressed: one that comes before the
  /// dialog does, or means nothing to it, is dropped.
  void press(const render::InputEvent& event);
  /// Whether a key waits for the next frame to answer with it: what a hand did after it is about what comes
  /// then.
  [[nodiscard]] bool answering() const { return key_ != render::Key::kNone; }

  /// Once a frame, with no window begun: the question to lay out; null: none. Between begin() and end().
  [[nodiscard]] Question* next();
  /// Begins its popup, as ImGui::BeginPopupModal; end() is called only after true.
  [[nodiscard]] bool begin();
  void end();
  /// Between begin() and end(): whether this key answers; once. Key::kEnter is that of the keypad, too.
  [[nodiscard]] bool take(render::Key key);
  /// Between begin() and end(): it is answered, and gone from the screen with the next frame.
  Question close();
  /// Whether there was one in one of the last frames: for two of them ImGui still says that a text field has
  /// the keyboard, that of the dialog which was closed.
  [[nodiscard]] bool justClosed() const noexcept { return frames_without_ < kClosed; }

 private:
  // Put up and closed by ImGui before it could be seen.
  [[nodiscard]] bool unseen() const { return shown_.has_value() && frames_ < kSeen && shown() == nullptr; }
  void drop();

  static constexpr int kSeen = 2;  // frames: ImGui measures a dialog in the first one and hides it there
  static constexpr int kClosed = 3;

  std::deque<Question> waiting_;
  std::optional<Question> shown_;  // of no meaning once ImGui has closed the popup
  unsigned id_ = 0;                // ImGui's, of that popup
  int frames_ = 0;
  int frames_without_ = kClosed;
  bool asked_ = false;
  render::Key key_ = render::Key::kNone;
};

}  // namespace fettle::app
