#include "app/files/file_browser.h"

#include <algorithm>
#include <filesystem>
#include <utility>

namespace fettle::app {

void FileBrowser::goTo(const std::string& folder, std::string chosen, std::string typed) {
  choose_next_ = std::move(chosen);
  typed_next_ = std::move(typed);
  job_.start([folder](engine::JobControl& job) { return listFolder(folder, job); });
}

void FileBrowser::begin(const std::string& folder, std::string chosen, FilesOf files) {
  view_.files = files;
  view_.typed.clear();
  view_.endings.clear();
  goTo(folder, std::move(chosen));
}

void FileBrowser::goUp() {
  const std::filesystem::path here(listing_.folder);
  if (here.has_relative_path()) goTo(here.parent_path().string(), here.filename().string());
}

bool FileBrowser::poll() {
  auto listed = job_.take();
  if (!listed) return false;
  problem_.reset();
  if (*listed) {
    if ((*listed)->folder != listing_.folder) view_.typed = typed_next_;
    listing_ = std::move(**listed);
    update(choose_next_);
  } else if (listed->error().kind != engine::ErrorKind::kCancelled) {
    problem_ = listed->error();
  }
  return true;
}

std::string FileBrowser::pathOf(std::size_t i) const {
  return (std::filesystem::path(listing_.folder) / entry(i).name).string();
}

void FileBrowser::setView(FolderView view) {
  const std::string chosen = chosenName();
  view_ = std::move(view);
  update(chosen);
}

void FileBrowser::narrow(const std::string& typed) {
  choose_next_ = typed_next_ = typed;  // where a folder is being listed
  view_.typed = typed;
  update(typed);
}

std::string FileBrowser::completion(const std::string& begun) const {
  std::optional<std::string> agreed;
  bool only_folder = false;
  for (const std::size_t i : shown_) {
    const FolderEntry& entry = listing_.entries[i];
    if (!entry.name.starts_with(begun)) continue;
    only_folder = !agreed && entry.folder;
    if (!agreed) agreed = entry.name;
    const auto end = std::ranges::mismatch(*agreed, entry.name).in1;
    agreed->erase(end, agreed->end());
  }
  return only_folder ? *agreed + "/" : agreed.value_or(begun);
}

void FileBrowser::move(std::ptrdiff_t by) {
  if (shown_.empty()) return;
  const auto last = static_cast<std::ptrdiff_t>(shown_.size()) - 1;
  const std::ptrdiff_t to = chosen_ ? static_cast<std::ptrdiff_t>(*chosen_) + by : 0;
  chosen_ = static_cast<std::size_t>(std::clamp<std::ptrdiff_t>(to, 0, last));
}

void FileBrowser::update(const std::string& chosen) {
  shown_ = shownEntries(listing_, view_);
  chosen_.reset();
  if (chosen.empty()) return;
  const auto found = std::find_if(shown_.begin(), shown_.end(),
                                  [&](std::size_t i) { return listing_.entries[i].name == chosen; });
  if (found != shown_.end()) chosen_ = static_cast<std::size_t>(found - shown_.begin());
}

}  // namespace fettle::app
