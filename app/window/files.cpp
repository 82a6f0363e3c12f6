#include "app/window/files.h"

#include <filesystem>

#include "app/files/sample_part.h"

namespace fettle::app {
namespace {

// The folder that a typed path lies in, or is; empty: there is none yet.
std::string folderOf(const std::string& typed) {
  namespace fs = std::filesystem;
  std::error_code error;
  const fs::path path = fs::absolute(typed.empty() ? "." : typed, error).lexically_normal();
  if (fs::is_directory(path, error)) return path.string();
  return fs::is_directory(path.parent_path(), error) ? path.parent_path().string() : std::string();
}

}  // namespace

void Files::begin(const std::string& path, const std::vector<std::string>& recent) {
  shelf.forget();
  shown_places = places.places(recent);
  followed_ = folderOf(path);
  browser.goTo(followed_, std::filesystem::path(path).filename().string());
}

void Files::begin(const ScanOptions& as) {
  shelf.forget();
  reading = as;
  form = ImportForm::of(as);
}

void Files::follow(const std::string& typed) {
  std::string folder = folderOf(typed);
  if (folder.empty() || folder == followed_) return;
  followed_ = std::move(folder);
  if (followed_ != browser.folder()) browser.goTo(followed_);
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
