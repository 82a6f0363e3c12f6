#pragma once

#include <optional>
#include <string>
#include <vector>

#include "app/files/import_form.h"

namespace fettle::app {

/// How files were said to be read, for the next time; newest first, in a JSON file. Threading: main.
class ReadingMemory {
 public:
  static constexpr std::size_t kMost = 200;

  /// `file` empty: for this run only. A file that cannot be read counts as empty.
  explicit ReadingMemory(std::string file);

  /// What was said of a file, which may be that it is as it says; nothing where nothing was said.
  [[nodiscard]] std::optional<ScanOptions> find(const std::string& path) const;
  /// Keeps it; that a file is as it says, too: nobody is asked again.
  void note(const std::string& path, const ScanOptions& reading);

 private:
  struct Said {
    std::string path;  // absolute
    ImportForm form;
  };
  void save() const;

  std::string file_;
  std::vector<Said> said_;
};

/// Its file in the settings folder; empty without that folder.
[[nodiscard]] std::string readingFile();

}  // namespace fettle::app
