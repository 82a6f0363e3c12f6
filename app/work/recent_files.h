#pragma once

#include <string>
#include <vector>

namespace fettle::app {

/// The folder "fettle" in that of the environment's `variable`, else in `under_home` of the user's home (XDG Base
/// Directory Specification); created if necessary. Empty when it cannot be created.
[[nodiscard]] std::string userFolder(const char* variable, const char* under_home);

/// Folder for the user's settings: $XDG_CONFIG_HOME/fettle, else ~/.config/fettle; created if necessary.
/// Empty when it cannot be created: then nothing is stored.
[[nodiscard]] std::string settingsFolder();

/// File with the list of files opened last; empty without that folder.
[[nodiscard]] std::string recentFile();

/// The files opened last, newest first; stored in a text file, one path per line.
class RecentFiles {
 public:
  static constexpr std::size_t kMost = 9;  // Ctrl+1 .. Ctrl+9

  /// `file` empty: for this run only. A file that cannot be read counts as empty.
  explicit RecentFiles(std::string file);
  void add(const std::string& path);
  [[nodiscard]] const std::vector<std::string>& paths() const noexcept { return paths_; }

 private:
  std::string file_;
  std::vector<std::string> paths_;
};

}  // namespace fettle::app
