#pragma once

#include <string>
#include <vector>

namespace fettle::app {

/// A folder to go to at once.
struct FilePlace {
  std::string name;
  std::string folder;
  bool own = false;  ///< a bookmark of this program
};

/// Folders that people go to: their home, the bookmarks of this program, those of the desktop's file manager
/// (gtk-3.0/bookmarks), and the folders of the files opened last. Threading: main.
class FilePlaces {
 public:
  /// `file`: of this program's bookmarks, one folder per line; empty: for this run only. A file that cannot be read
  /// counts as empty.
  explicit FilePlaces(std::string file);

  /// Each folder once, those that do not exist left out; `recent`: files opened last. Looks at the disk.
  [[nodiscard]] std::vector<FilePlace> places(const std::vector<std::string>& recent) const;

  [[nodiscard]] bool has(const std::string& folder) const;
  /// Makes a folder a bookmark of this program, or no more. Names with a line feed are not kept.
  void toggle(const std::string& folder);

 private:
  std::string file_;
  std::vector<std::string> own_;
};

/// File of this program's bookmarks in the settings folder; empty without that folder.
[[nodiscard]] std::string bookmarkFile();

/// The path of a "file:" URI, percent signs decoded; empty for other URIs.
[[nodiscard]] std::string pathOfUri(const std::string& uri);

}  // namespace fettle::app
