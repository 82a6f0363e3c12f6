#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "engine/base/error.h"
#include "engine/base/job.h"

namespace fettle::app {

/// What a folder shows of one of its files or folders.
struct FolderEntry {
  std::string name;
  bool folder = false;
  bool scan = false;           ///< by its extension a format that can be read
  bool scene = false;          ///< by its extension
  std::uint64_t bytes = 0;     ///< 0 for folders, and where the file system does not say
  std::int64_t changed_s = 0;  ///< last change [s since 1970]; 0 where the file system does not say
};

struct FolderListing {
  std::string folder;                ///< absolute, without a slash at its end but for "/"
  std::vector<FolderEntry> entries;  ///< as the file system gives them; hidden ones too
};

/// Everything in a folder, links followed; an entry that disappears meanwhile, or may not be looked at, is listed by its
/// name alone. Errors: kInput for what is no folder or may not be read, kCancelled. Thread: any; a long job on a slow disk.
[[nodiscard]] engine::Result<FolderListing> listFolder(const std::string& folder, engine::JobControl& job);

enum class FolderOrder : std::uint8_t { kName, kSize, kChanged };

/// Files of which kind are looked for.
enum class FilesOf : std::uint8_t { kScans, kScenes };

/// Which entries are shown, and in which order.
struct FolderView {
  FilesOf files = FilesOf::kScans;
  FolderOrder order = FolderOrder::kName;
  bool descending = false;
  bool all_files = false;  ///< else folders and those of `files`
  std::vector<std::string> endings =
      {};                  ///< ".tif": instead of those of `files`, in small letters; empty: those
  bool hidden = false;     ///< names that begin with a point
  std::string typed = {};  ///< only names that contain it, in any case; empty: every name
};

/// Positions in `listing.entries` of what `view` shows: folders first, both in its order, equal ones by name.
[[nodiscard]] std::vector<std::size_t> shownEntries(const FolderListing& listing, const FolderView& view);

/// Whether a name comes before another as people count: case does not matter, and part2 comes before part10. A strict weak
/// order; names that differ in nothing else are in the order of their bytes.
[[nodiscard]] bool comesBefore(std::string_view a, std::string_view b) noexcept;

}  // namespace fettle::app
