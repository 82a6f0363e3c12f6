#include "app/files/file_places.h"

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <optional>
#include <utility>

#include "app/texts/texts.h"
#include "app/work/recent_files.h"

namespace fettle::app {
namespace {

namespace fs = std::filesystem;

std::string environment(const char* name) {
  const char* const value = std::getenv(name);
  return value != nullptr ? value : "";
}

std::optional<int> hexDigit(char c) {
  if (c >= '0' && c <= '9') return c - '0';
  if (c >= 'a' && c <= 'f') return c - 'a' + 10;
  if (c >= 'A' && c <= 'F') return c - 'A' + 10;
  return std::nullopt;
}

std::string nameOf(const std::string& folder) {
  const std::string name = fs::path(folder).filename().string();
  return name.empty() ? folder : name;
}

// The bookmarks that the desktop's file managers and dialogs share: "URI NAME" per line, the name may be missing.
std::vector<FilePlace> desktopBookmarks() {
  const std::string home = environment("HOME");
  std::string settings = environment("XDG_CONFIG_HOME");
  if (settings.empty()) settings = home + "/.config";
  std::vector<FilePlace> found;
  std::ifstream in(settings + "/gtk-3.0/bookmarks");
  for (std::string line; std::getline(in, line);) {
    const std::size_t blank = line.find(' ');
    const std::string folder = pathOfUri(line.substr(0, blank));
    if (folder.empty()) continue;
    found.push_back({blank == std::string::npos ? nameOf(folder) : line.substr(blank + 1), folder});
  }
  return found;
}

}  // namespace

FilePlaces::FilePlaces(std::string file) : file_(std::move(file)) {
  std::ifstream in(file_);
  for (std::string line; std::getline(in, line);)
    if (!line.empty()) own_.push_back(line);
}

std::vector<FilePlace> FilePlaces::places(const std::vector<std::string>& recent) const {
  std::vector<FilePlace> all;
  const auto add = [&](FilePlace place) {
    std::error_code error;
    const bool known = std::any_of(all.begin(), all.end(),
                                   [&](const FilePlace& other) { return other.folder == place.folder; });
    if (!known && fs::is_directory(place.folder, error)) all.push_back(std::move(place));
  };
  for (const std::string& folder : own_) add({nameOf(folder), folder, true});
  if (const std::string home = environment("HOME"); !home.empty()) add({tr("Home"), home});
  for (FilePlace& place : desktopBookmarks()) add(std::move(place));
  for (const std::string& path : recent) {
    const std::string folder = fs::path(path).parent_path().string();
    add({nameOf(folder), folder});
  }
  return all;
}

bool FilePlaces::has(const std::string& folder) const {
  return std::find(own_.begin(), own_.end(), folder) != own_.end();
}

void FilePlaces::toggle(const std::string& folder) {
  if (has(folder))
    std::erase(own_, folder);
  else if (folder.find('\n') == std::string::npos)
    own_.push_back(folder);
  if (file_.empty()) return;
  std::ofstream out(file_, std::ios::trunc);
  for (const std::string& own : own_) out << own << '\n';
}

std::string bookmarkFile() {
  const std::string folder = settingsFolder();
  return folder.empty() ? std::string() : folder + "/bookmarks.txt";
}

std::string pathOfUri(const std::string& uri) {
  constexpr std::string_view kFile = "file://";
  if (!uri.starts_with(kFile)) return {};
  std::string path;
  for (std::size_t i = kFile.size(); i < uri.size(); ++i) {
    if (uri[i] == '%' && i + 2 < uri.size()) {
      const auto high = hexDigit(uri[i + 1]), low = hexDigit(uri[i + 2]);
      if (high && low) {
        path += static_cast<char>(16 * *high + *low);
        i += 2;
        continue;
      }
    }
    path += uri[i];
  }
  return path;
}

}  // namespace fettle::app
