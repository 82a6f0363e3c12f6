#pragma once

#include <string>
#include <vector>

#include "app/files/file_browser.h"
#include "app/files/file_places.h"
#include "app/files/import_form.h"
#include "app/files/reading_fields.h"
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
  /// Of the page's file, as far as it was read: what stays while it is read again.
  std::optional<engine::Grid> found_grid;
  std::vector<std::string> found_warnings;
  FieldsThatApply apply;

  /// A dialog about paths appears: it begins in the folder of `path`, or in the working folder. `recent`: files opened last.
  void begin(const std::string& path, const std::vector<std::string>& recent,
             FilesOf files = FilesOf::kScans);
  /// The import page appears. `known`: what is known of the file read so; may be null.
  void begin(const std::string& path, const ScanOptions& as, const ScanThumbnail* known);
  /// The import page shows a picture of its file.
  void noteFound(const std::string& path, const ScanThumbnail& picture);
  /// Goes to the folder that a typed path lies in, where that is another one. `narrows`: the list shows what its name is in.
  void follow(const std::string& typed, bool narrows);
  /// A typed path as a whole one: what does not begin at the root lies in the folder on the screen.
  [[nodiscard]] std::string wholePath(const std::string& typed) const;
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
