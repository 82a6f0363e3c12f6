#include "app/files/thumbnail_shelf.h"

#include <algorithm>
#include <utility>

namespace fettle::app {
ThumbnailShelf::Shown ThumbnailShelf::find(const std::string& path, const ScanOptions& reading) {
  Key key{path, scanOptionsText(reading)};
  const auto kept = std::find_if(kept_.begin(), kept_.end(), [&](const Kept& k) { return k.key == key; });
  if (kept != kept_.end()) {
    kept_.splice(kept_.begin(), kept_, kept);
    return {kept->picture ? &*kept->picture : nullptr, kept->problem ? &*kept->problem : nullptr};
  }
  if (reading_ != key) {
    wanted_ = Request{std::move(key), reading};
    begin();
  }
  return {};
}

void ThumbnailShelf::begin() {
  if (job_.busy() || !wanted_) return;
  reading_ = wanted_->key;
  job_.start([path = wanted_->key.path, reading = std::move(wanted_->reading)](
                 engine::JobControl& job) -> engine::Result<ScanThumbnail> {
    const auto import = importOptions(reading);
    if (!import) return tl::unexpected(import.error());
    return readThumbnail(path, *import, kSide, job);
  });
  wanted_.reset();
}

void ThumbnailShelf::keep(Kept kept) {
  kept_.push_front(std::move(kept));
  if (kept_.size() > kMost) kept_.pop_back();
}

void ThumbnailShelf::put(const std::string& path, const ScanOptions& reading, ScanThumbnail picture) {
  keep({Key{path, scanOptionsText(reading)}, std::move(picture), std::nullopt});
}

bool ThumbnailShelf::poll() {
  auto done = job_.take();
  if (!done) return false;
  const bool cancelled = !*done && done->error().kind == engine::ErrorKind::kCancelled;
  if (reading_ && !cancelled) {
    Kept kept{*std::move(reading_), std::nullopt, std::nullopt};
    if (*done)
      kept.picture = std::move(**done);
    else
      kept.problem = done->error();
    keep(std::move(kept));
  }
  reading_.reset();
  begin();
  return true;
}

void ThumbnailShelf::forget() {
  wanted_.reset();
  job_.cancel();
  kept_.clear();
}

}  // namespace fettle::app
