// What is seen of a large scan while it is read: a coarse picture that can be looked at from all sides, and
// nothing else. It is no document: no loop runs, nothing is touched, changed or saved.
#include <fmt/format.h>

#include "app/window/workstation.h"
#include "engine/formats/formats.h"

namespace fettle::app {
namespace {

constexpr std::int64_t kCoarseSamples = std::int64_t{1} << 20;
// Reading the rest takes all cores and, page by page, the lock under which the driver takes its memory: the
// picture that is there already would wait for it. Longer than this it is not waited for in turn.
constexpr std::chrono::milliseconds kShownFirst{500};

}  // namespace

// The work of opening. Only where nothing is open: what is worked on stays until the next scan is there.
Background<Document>::Work Workstation::openingWork(const std::string& path, Recovery recovery) {
  const bool coarse_first = !touch_ && recovery == Recovery::kLeave && !isSessionPath(path);
  coarse_slot_ = std::make_shared<CoarseSlot>();
  return [path, recovery, coarse_first, slot = coarse_slot_,
          reading = options_.reading](engine::JobControl& job) {
    const auto import = importOptions(reading);
    if (coarse_first && import) {
      // What is wrong with the file, reading the whole of it tells.
      auto coarse = engine::importPreview(path, *import, kCoarseSamples, job);
      if (coarse && *coarse) {
        slot->put(**std::move(coarse));
        slot->waitShown(kShownFirst, job);
      }
    }
    return openDocument(path, reading, recovery, kHistoryBytes, job);
  };
}

void Workstation::takeCoarse() {
  if (!coarse_slot_) return;
  auto coarse = coarse_slot_->take();
  if (!coarse) return;
  if (touch_) {
    coarse_slot_->shown();
    return;
  }
  coarse_ = std::move(coarse);
  stale_ = true;
}

// It must not stay where the scan could not be read.
void Workstation::dropCoarse() {
  if (!coarse_) return;
  coarse_.reset();
  coarse_slot_->shown();
  if (touch_) return;
  window_->forgetPicture();
  shown_ = {};
  refinement_ = {};
  figures_ = {};
  drag_ = Drag::kNone;
  stale_ = true;
}

bool Workstation::coarseIsShown() const {
  return coarse_ && !touch_ && !shown_.versions.empty();
}

std::string Workstation::coarseText() const {
  if (coarse_->overview)
    return fmt::format(
        "coarse picture, the file's own overview, 1 in {} x {}: touch and tools wait for all "
        "of {} x {} samples",
        coarse_->step_columns, coarse_->step_rows, coarse_->width, coarse_->height);
  return fmt::format("coarse picture, 1 sample in {} x {}: touch and tools wait for all of {} x {}",
                     coarse_->step_columns, coarse_->step_rows, coarse_->width, coarse_->height);
}

void Workstation::drawCoarse() {
  followArea();
  render::Shown shown;
  shown.versions.push_back(coarse_->field);
  if (shown.versions != shown_.versions) {
    if (const auto status = picture_->update(shown); !status) {
      if (window_->usable()) status_text_ = status.error().line();
      dropCoarse();
      return;
    }
    shown_ = std::move(shown);
    stale_ = true;
  }
  const render::Sharpness sharpness = seeMotion();
  if (!stale_ && figures_.upload.pending_tiles == 0) return;
  stale_ = false;
  (void)submit(frameInput(sharpness));
}

}  // namespace fettle::app
