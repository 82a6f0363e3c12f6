// A graphics device that is lost - its driver restarted, it hung, it was unplugged, its memory ran out -
// takes the picture with it and nothing else: field, history, marks and camera live with touch, which goes on
// meanwhile.
#include <array>
#include <filesystem>
#include <thread>

#include <fmt/format.h>

#include "app/terminal.h"
#include "app/window/workstation.h"
#include "engine/formats/formats.h"

namespace fettle::app {
namespace {

using Clock = std::chrono::steady_clock;
using namespace std::chrono_literals;

// Before each try to come back: a driver that restarts takes a second or two.
constexpr std::array<std::chrono::milliseconds, 6> kPauses{0ms, 100ms, 300ms, 800ms, 1500ms, 2500ms};
constexpr std::uint64_t kStands =
    3;                       // frames shown after a loss: it has come back, and the next loss is another
constexpr auto kStep = 5ms;  // between two looks at touch while there is nothing to draw with

}  // namespace

engine::Status Workstation::makePicture() {
  auto picture = render::LivePicture::create(window_->context(), render::Window::pictureFormat());
  if (!picture) return tl::unexpected(picture.error());
  picture_ = std::move(*picture);
  // Whatever was shown is uploaded to it again.
  shown_ = {};
  refinement_ = {};
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
  if (frames_ >= renewed_frame_ + kStands) renewals_ = 0;
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
  renewed_frame_ = frames_;
  engine::Status done = window_->renew();
  if (done) done = makePicture();
  if (!done) {
    losePicture(done.error());
    return;
  }
  std::erase_if(notices_, [](const Notice& n) { return n.what.starts_with("the graphics device was lost"); });
  notices_.push_back({before == window_->device()
                          ? std::string("the graphics device was lost and has come back")
                          : fmt::format("the graphics device was lost; {} draws now", window_->device()),
                      "the field, its marks and its steps were not touched"});
}

// Nobody can be asked any more. What to read about the work, as the beginning of a remedy; empty when there
// is nothing to say. Of no use afterwards: the document is closed.
std::string Workstation::keepWork() {
  if (!touch_) return {};
  const bool had_unsaved = unsaved();
  const std::string session = keeper_->named() ? keeper_->path() : std::string();
  filters_.cancel(*touch_);
  touch_->finish();  // a stroke that runs is a step yet
  const engine::Version field = touch_->upright();
  const auto closed = keeper_->close(SessionKeeper::Afterwards::kKeep);
  touch_.reset();
  keeper_.reset();
  if (closed && !session.empty()) return fmt::format("everything is kept in {}; ", session);
  if (closed)
    return had_unsaved ? fmt::format("what was not saved is kept for when {} is opened again; ", path_) : "";

  // The session cannot be written where it is: the field, at least, goes beside the scan or to where programs
  // may write.
  namespace fs = std::filesystem;
  std::string why = closed.error().line();
  for (const fs::path& folder :
       {fs::path(path_).parent_path(), fs::path(settingsFolder()), fs::path("/tmp")}) {
    const std::string stem = (folder / (fs::path(path_).stem().string() + "_rescued")).string();
    std::error_code error;
    std::string path = stem + ".fettle";
    for (int n = 2; fs::exists(path, error); ++n) path = fmt::format("{}_{}.fettle", stem, n);
    engine::JobControl job;
    if (engine::exportField(field, path, {}, job))
      return fmt::format("{}; the field with its marks is kept in {}; ", why, path);
  }
  return fmt::format("{}; what was not saved is gone; ", why);
}

}  // namespace fettle::app
