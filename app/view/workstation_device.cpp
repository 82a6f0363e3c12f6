// A graphics device that is lost - its driver restarted, it hung, it was unplugged, its memory ran out -
// takes the picture with it and nothing else: field, history, marks and camera live with touch, which goes on
// meanwhile.
#include <array>
#include <filesystem>
#include <thread>

#include <fmt/format.h>

#include "app/terminal.h"
#include "app/view/workstation.h"
#include "engine/io/export.h"
#include "engine/io/marks.h"

namespace fettle::app {
namespace {

using Clock = std::chrono::steady_clock;
using namespace std::chrono_literals;

// Before each try to come back: a driver that restarts takes a second or two.
constexpr std::array<std::chrono::milliseconds, 6> kPauses{0ms, 100ms, 300ms, 1000ms, 2000ms, 3000ms};
constexpr auto kStands = 10s;  // a picture that long after a loss has come back for good
constexpr auto kStep = 5ms;    // between two looks at touch while there is nothing to draw with

}  // namespace

engine::Status Workstation::makePicture() {
  auto picture = render::LivePicture::create(window_->context(), render::Window::pictureFormat());
  if (!picture) return tl::unexpected(picture.error());
  picture_ = std::move(*picture);
  // Whatever was shown is uploaded to it again.
  shown_ = {};
  figures_ = {};
  stale_ = true;
  return {};
}

void Workstation::losePicture(const engine::Error& why) {
  ++device_losses_;
  picture_.reset();
  drag_ = Drag::kNone;
  dragging_split_ = false;
  const auto now = Clock::now();
  if (now - renewed_at_ > kStands) renewals_ = 0;
  if (window_->displayLost() || static_cast<std::size_t>(renewals_) >= kPauses.size()) {
    engine::Error end = why;
    end.remedy = keepWork() + end.remedy;
    end_ = tl::unexpected(std::move(end));
    return;
  }
  renew_at_ = now + kPauses.at(static_cast<std::size_t>(renewals_++));
}

void Workstation::renewPicture() {
  if (window_->displayLost()) {
    losePicture(
        engine::failure("the connection to the display was lost", "window", "open the window again").value());
    return;
  }
  if (Clock::now() < renew_at_) {
    std::this_thread::sleep_for(kStep);
    return;
  }
  const std::string before = window_->device();
  renewed_at_ = Clock::now();
  engine::Status done = window_->renew();
  if (done) done = makePicture();
  if (!done) {
    losePicture(done.error());
    return;
  }
  notices_.push_back({before == window_->device()
                          ? std::string("the graphics device was lost and has come back")
                          : fmt::format("the graphics device was lost; {} draws now", window_->device()),
                      "the field, its marks and its steps were not touched"});
}

// Nobody can be asked any more. What to read about it, as the beginning of a remedy; empty when all was
// saved.
std::string Workstation::keepWork() {
  if (!unsaved()) return {};
  namespace fs = std::filesystem;
  const fs::path scan(path_);
  const std::string stem = (scan.parent_path() / (scan.stem().string() + "_rescued")).string();
  std::error_code error;
  std::string path = stem + ".tif";
  for (int n = 2; fs::exists(path, error); ++n) path = fmt::format("{}_{}.tif", stem, n);
  engine::JobControl job;
  const engine::Version field = touch_->upright();
  auto kept = engine::exportField(field, path, {}, job);
  if (!kept) return fmt::format("what was not saved is gone ({}); ", kept.error().line());
  if (field.reader().root().marked_children != 0) {
    const std::string marks = fs::path(path).replace_extension().string() + "_marks.png";
    if (const auto written = engine::exportMarks(field, marks); !written)
      return fmt::format("the field was kept in {}, its marks are gone ({}); ", path, written.error().line());
  }
  return fmt::format("what was not saved was kept in {}; ", path);
}

}  // namespace fettle::app
