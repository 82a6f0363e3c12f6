#include "app/window/opening.h"

#include <chrono>
#include <filesystem>
#include <utility>

#include <fmt/format.h>

#include "app/files/reading_fields.h"
#include "app/files/thumbnail_shelf.h"
#include "app/texts/texts.h"
#include "engine/formats/formats.h"

namespace fettle::app {
// Memory of undo; older steps are read from the session on demand.
constexpr std::size_t kHistoryBytes = std::size_t{1} << 30;
constexpr std::int64_t kCoarseSamples = std::int64_t{1} << 20;
// Reading the rest uses all cores and, page by page, the lock under which the driver allocates memory:
// drawing the coarse picture would wait for it. So reading waits for that picture, at most this long.
constexpr std::chrono::milliseconds kShownFirst{500};

namespace {

// What the page shows of a scan that was read whole.
ScanThumbnail pictureOf(const Document& document) {
  ScanThumbnail picture = thumbnailOf(document.original, ThumbnailShelf::kSide);
  picture.format = document.scan.format;
  picture.warnings = document.warnings;
  picture.lone_values = document.lone_values;
  picture.whole = true;
  return picture;
}

}  // namespace

Background<Opened>::Work Opening::work(const std::string& path, Recovery recovery, const ScanOptions& reading,
                                       Guesses guesses, std::shared_ptr<CoarseSlot> slot, bool coarse_first) {
  return [path, recovery, guesses, coarse_first, slot = std::move(slot),
          reading](engine::JobControl& job) -> engine::Result<Opened> {
    const auto import = importOptions(reading);
    if (coarse_first && import) {
      // Errors in the file are reported by the full import.
      auto coarse = engine::importPreview(path, *import, kCoarseSamples, job);
      if (coarse && *coarse) {
        slot->put(**std::move(coarse));
        slot->waitShown(kShownFirst, job);
      }
    }
    auto document = openDocument(path, reading, recovery, kHistoryBytes, job);
    if (!document) return tl::unexpected(document.error());
    Opened opened{*std::move(document), nullptr};
    if (guesses == Guesses::kAsk && anyGuess(opened.document.warnings))
      opened.guessed = std::make_shared<const ScanThumbnail>(pictureOf(opened.document));
    return opened;
  };
}

void Opening::start(const std::string& path, Recovery recovery, const ScanOptions& reading, Guesses guesses,
                    bool instead) {
  path_ = path;
  since_asked_ = {};
  if (!instead) {
    times_ = {since_asked_};
    announced_ = false;
  }
  slot_ = std::make_shared<CoarseSlot>();
  const bool coarse_first = !instead && recovery == Recovery::kLeave && !isSessionPath(path);
  loading_.start(work(path, recovery, reading, guesses, slot_, coarse_first));
}

std::string Opening::fileName() const {
  return std::filesystem::path(path_).filename().string();
}

bool Opening::takeCoarse(bool open) {
  if (!slot_) return false;
  auto coarse = slot_->take();
  if (!coarse) return false;
  if (open) {
    slot_->shown();
    return false;
  }
  coarse_ = std::move(coarse);
  return true;
}

std::string Opening::coarseText() const {
  if (coarse_->overview)
    return trFormat(
        "coarse picture, the file's own overview, 1 in {} x {}: touch and tools wait for all "
        "of {} x {} samples",
        coarse_->step_columns, coarse_->step_rows, coarse_->width, coarse_->height);
  return trFormat("coarse picture, 1 sample in {} x {}: touch and tools wait for all of {} x {}",
                  coarse_->step_columns, coarse_->step_rows, coarse_->width, coarse_->height);
}

bool Opening::dropCoarse() {
  if (!coarse_) return false;
  coarse_.reset();
  slot_->shown();
  return true;
}

void Opening::noteRead(bool instead) {
  times_ = {since_asked_, instead ? 0.0 : times_.coarse_ms};
  times_.read_ms = times_.since_asked.ms();
  announced_ = false;
}

void Opening::noteFrame(Frame frame) {
  const auto note = [&](double& ms) {
    if (ms == 0.0) ms = times_.since_asked.ms();
  };
  if (frame == Frame::kCoarse && times_.coarse_ms == 0.0) {
    note(times_.coarse_ms);
    slot_->shown();
  }
  if (frame == Frame::kDocument || frame == Frame::kWhole) note(times_.seen_ms);
  if (frame == Frame::kWhole) note(times_.whole_ms);
}

}  // namespace fettle::app
