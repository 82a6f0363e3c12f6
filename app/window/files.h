#pragma once

#include <string>
#include <vector>

#include "app/files/file_browser.h"
#include "app/files/file_places.h"
#include "app/files/import_form.h"
#include "app/files/reading_memory.h"
#include "app/files/thumbnail_shelf.h"
#include "app/work/background.h"

namespace fettle::app {

/// What the window shows of files that are not open: the folder of a dialog, pictures of scans, the page on which a file's
/// reading is chosen. Nothing is looked at before a page needs it. Threading: main.
class Files {
 public:
  FileBrowser browser;
  FilePlaces places{bookmarkFile()};
  ThumbnailShelf shelf;
  ReadingMemory readings{readingFile()};
  std::vector<FilePlace> shown_places;
  ImportForm form;      ///< as typed so far
  ScanOptions reading;  ///< the last of them that could be read

  /// A dialog about paths appears: it begins in the folder of `path`, or in the working folder. `recent`: files opened last.
  void begin(const std::string& path, const std::vector<std::string>& recent);
  /// The import page appears.
  void begin(const ScanOptions& as);
  /// Goes to the folder that a typed path lies in, where that is another one.
  void follow(const std::string& typed);
  void toggleBookmark(const std::vector<std::string>& recent);

  /// Makes the sample scan where it is not there yet.
  void makeSample();
  /// Its path, or why there is none, once.
  [[nodiscard]] std::optional<engine::Result<std::string>> takeSample() { return sample_.take(); }

  /// True when something new is to be shown.
  bool poll();
  [[nodiscard]] bool busy() const noexcept { return browser.busy() || shelf.busy() || sample_.busy(); }

 private:
  std::string followed_;  // the folder of the path typed last
  Background<std::string> sample_;
};

}  // namespace fettle::app
