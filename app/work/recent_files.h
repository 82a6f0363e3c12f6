#pragma once

#include <string>
#include <vector>

namespace fettle::app {

/// Folder for what the program remembers about its user: $XDG_CONFIG_HOME/fettle, else ~/.config/fettle; made
/// when it is not there. Empty when it cannot be: nothing is remembered then.
[[nodiscard]] std::string settingsFolder();

/// Where the window keeps the list of files opened last; empty without that folder.
[[nodiscard]] std::string recentFile();

/// The files opened last, newest first; kept in a text file, a path a line.
class RecentFiles {
 public:
  static constexpr std::size_t kMost = 9;  // Ctrl+1 .. Ctrl+9

  /// `file` empty: remembers for this run only. A file that cannot be read holds nothing.
  explicit RecentFiles(std::string file);
  void add(const std::string& path);
  [[nodiscard]] const std::vector<std::string>& paths() const noexcept { return paths_; }

 private:
  std::string file_;
  std::vector<std::string> paths_;
};

}  // namespace fettle::app
