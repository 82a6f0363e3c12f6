#pragma once

#include <optional>
#include <string>
#include <vector>

#include "app/window/active_document.h"
#include "app/work/background.h"

namespace fettle::app {

/// Writing the document to files of the user's: where the work lives from then on, or a copy of it for others.
/// Nothing is replaced without a question. Threading: main.
class Saving {
 public:
  enum class Keeping : std::uint8_t { kWorkThere, kCopy };
  [[nodiscard]] static Keeping keepingOf(Question::Kind kind) {
    return kind == Question::Kind::kSaveAs ? Keeping::kWorkThere : Keeping::kCopy;
  }

  /// Another document, of so many samples.
  void begin(std::int64_t samples);
  /// The document goes: what was to be written once its session holds the scan is not.
  void dropWaiting() noexcept { waits_for_scan_ = false; }

  /// To where it was saved before, else asks where. `afterwards`: what follows once it is saved.
  void save(ActiveDocument& document, Feedback& feedback, Afterwards afterwards);
  /// Whether a path comes from a dialog that one can go back to.
  enum class Typed : std::uint8_t { kNo, kYes };
  /// To the path of `from`, a question for one, with a question first where a file would be replaced.
  void askToWrite(Question from, Typed typed, ActiveDocument& document, Feedback& feedback);
  /// To a path, over what is there.
  void start(const std::string& path, Keeping keeping, Afterwards afterwards, ActiveDocument& document,
             Feedback& feedback);
  void cancel(ActiveDocument& document);

  /// What came of it, once it is over.
  struct Saved {
    Afterwards afterwards;
    bool moved = false;  ///< the document lies elsewhere now
  };
  /// Once a frame. Nothing while it goes on, and where it failed, which is said in a dialog.
  [[nodiscard]] std::optional<Saved> poll(ActiveDocument& document, Feedback& feedback);

  /// Something is being written, or waits for that.
  [[nodiscard]] bool busy(const ActiveDocument& document) const;
  /// 0 .. 1; nothing unless files are being written.
  [[nodiscard]] std::optional<double> progress(const ActiveDocument& document) const;
  /// Where Ctrl+S writes the field to, without a session of the user's; empty until chosen.
  [[nodiscard]] const std::string& path() const noexcept { return path_; }

  bool embeds = true;  ///< the scan goes into a session saved as

 private:
  void write(ActiveDocument& document);

  std::string path_;
  std::vector<std::string> written_;  // all files of path_
  // What is being saved.
  std::string target_;
  Keeping keeping_ = Keeping::kCopy;
  Afterwards afterwards_;
  std::vector<std::string> outputs_;
  bool waits_for_scan_ = false;  // until the session holds the scan
  Background<engine::Version> writing_;
};

}  // namespace fettle::app
