#pragma once

#include <optional>
#include <string>
#include <vector>

#include "app/window/active_document.h"
#include "app/work/background.h"

namespace fettle::app {

/// Writes the document to files of the user: as its new location, or as a copy. Nothing is replaced without a
/// question. Threading: main.
class Saving {
 public:
  enum class Keeping : std::uint8_t { kWorkThere, kCopy };
  [[nodiscard]] static Keeping keepingOf(Question::Kind kind) {
    return kind == Question::Kind::kSaveAs ? Keeping::kWorkThere : Keeping::kCopy;
  }

  /// Another document, of so many samples.
  void begin(std::int64_t samples);
  /// The document is being closed: cancels a write that waits for its session to store the scan.
  void dropWaiting() noexcept { waits_for_scan_ = false; }

  /// Saves to the previous path, or asks for one. `afterwards`: what follows after saving.
  void save(ActiveDocument& document, Feedback& feedback, Afterwards afterwards);
  /// Whether a path comes from a dialog to which the user can go back.
  enum class Typed : std::uint8_t { kNo, kYes };
  /// Saves to the path of `from`, a question for one, after a question where a file would be replaced.
  void askToWrite(Question from, Typed typed, ActiveDocument& document, Feedback& feedback);
  /// Writes to a path, replacing existing files.
  void start(const std::string& path, Keeping keeping, Afterwards afterwards, ActiveDocument& document,
             Feedback& feedback);
  void cancel(ActiveDocument& document);

  /// The result of a finished write.
  struct Saved {
    Afterwards afterwards;
    bool moved = false;  ///< the document has a new location
  };
  /// What was written [upright], and what the format does not hold of it.
  struct Written {
    engine::Version field;
    std::vector<std::string> warnings;
  };
  /// Once per frame. Nothing while it runs, or where it failed, which a dialog reports. What a format does not hold becomes
  /// notices.
  [[nodiscard]] std::optional<Saved> poll(ActiveDocument& document, Feedback& feedback);

  /// Whether something is being written, or waits for that.
  [[nodiscard]] bool busy(const ActiveDocument& document) const;
  /// Nothing unless files are being written.
  [[nodiscard]] std::optional<WorkProgress> progress(const ActiveDocument& document) const;
  /// The path of Ctrl+S for the field, without a session of the user; empty until chosen.
  [[nodiscard]] const std::string& path() const noexcept { return path_; }

  /// "/folder/scan" + `ending`, in the folder that was written to last, else in that of the scan.
  [[nodiscard]] std::string suggestedPath(const ActiveDocument& document, const char* ending) const;
  /// A file was written beside those of the document: the next one is suggested in its folder.
  void noteFolderOf(const std::string& path);
  /// Whether a file that was exported holds the present state: "It was exported to out.tif at 14:03, as it is now."; empty
  /// where nothing was exported since the document was opened.
  [[nodiscard]] std::string exportText(const ActiveDocument& document) const;

  /// The path of the file that was exported last, if it holds the present state; else empty.
  [[nodiscard]] std::string exportedTo(const ActiveDocument& document) const;

  /// The line of the status bar on a document whose status is `status`: where that is what was written last, the line does not
  /// name the file twice, and says so when the work has changed since.
  [[nodiscard]] std::string statusText(const std::string& status, const ActiveDocument& document) const;

  bool embeds = true;  ///< the scan is stored in a session saved as
  bool mesh_in_mm =
      true;  ///< numbers of a mesh without units are millimetres, where that can be chosen; else the scan's

  /// Whether the numbers of a mesh without units can be in two units: the scan's is a length other than mm.
  [[nodiscard]] static bool hasMeshChoice(const engine::Grid& grid);

 private:
  void write(ActiveDocument& document);

  std::string path_;
  std::vector<std::string> written_;  // all files of path_
  // The copy written last.
  struct Exported {
    engine::Version field;  // upright
    std::string path, at;
  };
  std::optional<Exported> exported_;
  std::string folder_;  // that was written to last
  // The current write.
  std::string target_;
  Keeping keeping_ = Keeping::kCopy;
  Afterwards afterwards_;
  std::vector<std::string> outputs_;
  bool waits_for_scan_ = false;  // until the session stores the scan
  Background<Written> writing_;
};

}  // namespace fettle::app
