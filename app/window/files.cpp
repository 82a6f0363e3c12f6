#include "app/window/files.h"

#include <filesystem>

#include "app/files/sample_part.h"

namespace fettle::app {
namespace {

// The folder that a typed path lies in, or is; empty: there is none yet.
std::string folderOf(const std::string& typed) {
  namespace fs = std::filesystem;
  std::error_code error;
  fs::path path = fs::absolute(typed.empty() ? "." : typed, error).lexically_normal();
  if (!path.has_filename() && path.has_relative_path()) path = path.parent_path();
  if (fs::is_directory(path, error)) return path.string();
  return fs::is_directory(path.parent_path(), error) ? path.parent_path().string() : std::string();
}

}  // namespace

void Files::begin(const std::string& path, const std::vector<std::string>& recent, FilesOf files) {
  shelf.forget();
  shown_places = places.places(recent);
  followed_ = folderOf(path);
  browser.begin(followed_, std::filesystem::path(path).filename().string(), files);
}

void Files::begin(const std::string& path, const ScanOptions& as, const ScanThumbnail* known) {
  shelf.forget();
  if (known != nullptr) shelf.put(path, as, *known);
  reading = as;
  form = ImportForm::of(as);
  found_grid.reset();
  found_warnings.clear();
  apply = fieldsOfName(path);
}

void Files::noteFound(const std::string& path, const ScanThumbnail& picture) {
  found_grid = picture.grid;
  found_warnings = picture.warnings;
  apply = picture.format.empty()
              ? fieldsOfName(path)
              : fieldsThatApply(picture.format, picture.grid && picture.grid->height_per_count != 0.0);
}

void Files::follow(const std::string& typed, bool narrows) {
  const std::string path = wholePath(typed);
  std::string folder = folderOf(path);
  if (folder.empty()) return;
  // The name of a folder is nothing to look for in it.
  const std::string last = std::filesystem::path(path).filename().string();
  const bool in_it = std::filesystem::path(folder).filename() == last && folder.size() >= path.size();
  const std::string name = narrows && !in_it ? last : std::string();
  const bool other = folder != followed_;
  followed_ = std::move(folder);
  if (other && followed_ != browser.folder())
    browser.goTo(followed_, last, name);
  else if (narrows)
    browser.narrow(name);
}

std::string Files::wholePath(const std::string& typed) const {
  const std::filesystem::path path(typed);
  return typed.empty() || path.is_absolute() ? typed : (browser.folder() / path).string();
}

void Files::toggleBookmark(const std::vector<std::string>& recent) {
  places.toggle(browser.folder());
  shown_places = places.places(recent);
}

void Files::makeSample() {
  if (!sample_.busy()) sample_.start([](engine::JobControl& job) { return sampleScan(job); });
}

bool Files::poll() {
  const bool listed = browser.poll();
  return shelf.poll() || listed;
}

}  // namespace fettle::app
