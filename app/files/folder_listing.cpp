#include "app/files/folder_listing.h"

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <numeric>

#include <fmt/format.h>

#include "engine/base/digit.h"
#include "engine/formats/formats.h"
#include "engine/io/files/input_file.h"

namespace fettle::app {
namespace {

namespace fs = std::filesystem;

// Of ASCII letters alone: file names are UTF-8, whose other bytes stay as they are.
char lower(char c) {
  return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
}

std::string lower(std::string_view text) {
  std::string result(text);
  std::transform(result.begin(), result.end(), result.begin(), [](char c) { return lower(c); });
  return result;
}

// A number at the beginning of `text`, without leading zeros, taken off it.
std::string_view takeNumber(std::string_view& text) {
  const auto end = std::find_if_not(text.begin(), text.end(), engine::isDigit);
  std::string_view number = text.substr(0, static_cast<std::size_t>(end - text.begin()));
  text.remove_prefix(number.size());
  while (number.size() > 1 && number.front() == '0') number.remove_prefix(1);
  return number;
}

// -1, 0, 1; numbers by their value, of any length.
int compared(std::string_view a, std::string_view b) {
  while (!a.empty() && !b.empty()) {
    if (engine::isDigit(a.front()) && engine::isDigit(b.front())) {
      const std::string_view x = takeNumber(a), y = takeNumber(b);
      if (x.size() != y.size()) return x.size() < y.size() ? -1 : 1;
      if (const int order = x.compare(y); order != 0) return order < 0 ? -1 : 1;
    } else {
      const auto x = static_cast<unsigned char>(lower(a.front()));
      const auto y = static_cast<unsigned char>(lower(b.front()));
      if (x != y) return x < y ? -1 : 1;
      a.remove_prefix(1);
      b.remove_prefix(1);
    }
  }
  return a.empty() ? (b.empty() ? 0 : -1) : 1;
}

bool readsExtension(const std::string& extension) {
  const auto formats = engine::formats();
  return std::any_of(formats.begin(), formats.end(), [&](const engine::FormatInfo& format) {
    return format.reads && std::find(format.extensions.begin(), format.extensions.end(), extension) !=
                               format.extensions.end();
  });
}

FolderEntry entryOf(const fs::directory_entry& found) {
  FolderEntry entry;
  entry.name = found.path().filename().string();
  std::error_code unknown;
  entry.folder = found.is_directory(unknown);
  if (!entry.folder) {
    const std::string extension = engine::extensionOf(entry.name);
    entry.scan = readsExtension(extension);
    entry.scene = extension == ".toml";
    if (const auto bytes = found.file_size(unknown); !unknown) entry.bytes = bytes;
  }
  if (const auto changed = found.last_write_time(unknown); !unknown)
    entry.changed_s = std::chrono::duration_cast<std::chrono::seconds>(
                          std::chrono::file_clock::to_sys(changed).time_since_epoch())
                          .count();
  return entry;
}

}  // namespace

engine::Result<FolderListing> listFolder(const std::string& folder, engine::JobControl& job) {
  std::error_code error;
  fs::path path = fs::absolute(folder.empty() ? "." : folder, error).lexically_normal();
  if (!path.has_filename() && path.has_relative_path()) path = path.parent_path();
  FolderListing listing{path.string(), {}};
  fs::directory_iterator it(path, error);
  if (error)
    return engine::inputError(fmt::format("cannot list the folder: {}", error.message()), path.string(),
                              "choose another one");
  // What cannot be read further was listed so far: a disk that is taken away leaves its beginning.
  for (const fs::directory_iterator end; it != end && !error; it.increment(error)) {
    if (job.cancelled()) return engine::cancelled();
    listing.entries.push_back(entryOf(*it));
  }
  return listing;
}

std::vector<std::size_t> shownEntries(const FolderListing& listing, const FolderView& view) {
  const std::vector<FolderEntry>& entries = listing.entries;
  const std::string typed = lower(view.typed);
  std::vector<std::size_t> shown;
  for (std::size_t i = 0; i < entries.size(); ++i) {
    const FolderEntry& entry = entries[i];
    if (!view.hidden && entry.name.starts_with('.')) continue;
    const bool sought = !view.endings.empty()
                            ? std::find(view.endings.begin(), view.endings.end(),
                                        engine::extensionOf(entry.name)) != view.endings.end()
                        : view.files == FilesOf::kScenes ? entry.scene
                                                         : entry.scan;
    if (!view.all_files && !entry.folder && !sought) continue;
    if (!typed.empty() && lower(entry.name).find(typed) == std::string::npos) continue;
    shown.push_back(i);
  }
  const auto before = [&](std::size_t i, std::size_t j) {
    const FolderEntry &a = entries[i], &b = entries[j];
    if (a.folder != b.folder) return a.folder;
    if (view.order == FolderOrder::kSize && a.bytes != b.bytes) return (a.bytes < b.bytes) != view.descending;
    if (view.order == FolderOrder::kChanged && a.changed_s != b.changed_s)
      return (a.changed_s < b.changed_s) != view.descending;
    const bool backwards = view.descending && view.order == FolderOrder::kName;
    return backwards ? comesBefore(b.name, a.name) : comesBefore(a.name, b.name);
  };
  std::sort(shown.begin(), shown.end(), before);
  return shown;
}

bool comesBefore(std::string_view a, std::string_view b) noexcept {
  const int order = compared(a, b);
  return order != 0 ? order < 0 : a < b;
}

}  // namespace fettle::app
