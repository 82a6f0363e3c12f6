#include "app/xr/headset_view.h"

#include <utility>

#include "app/thread_left.h"
#include "haptic/devices/virtual/controller_stylus.h"

namespace fettle::app {
namespace {

// With time for what is destroyed then.
constexpr auto kLongestEnd = HeadsetFrames::kLongestEnd + std::chrono::seconds(1);

void runHeadset(const HeadsetViewOptions& options, const std::shared_ptr<HeadsetExchange>& exchange) {
  auto frames = HeadsetFrames::create(options, exchange);
  if (frames) {
    exchange->noteStart({}, (*frames)->name());
    (*frames)->run();
  } else {
    exchange->noteStart(tl::unexpected(frames.error()), "");
    exchange->noteEnd({}, {});
  }
}

}  // namespace

engine::Result<std::unique_ptr<HeadsetView>> HeadsetView::start(Options options) {
  auto exchange = std::make_shared<HeadsetExchange>(std::move(options.wake));
  std::unique_ptr<HeadsetView> view(
      new HeadsetView(exchange, std::thread(&runHeadset, options.frames, exchange)));
  const std::optional<engine::Status> started = exchange->waitForStart(options.starts_within);
  if (!started)
    return engine::failure("the headset's runtime does not answer", "OpenXR",
                           "restart it, or leave out --xr");
  if (!*started) return tl::unexpected(started->error());
  return view;
}

HeadsetView::~HeadsetView() {
  static_cast<void>(finish());
}

bool HeadsetView::stands() const {
  return !exchange_->state().over &&
         HeadsetExchange::Clock::now() - exchange_->lastFrame() > haptic::kFramesStayAway;
}

std::vector<ScreenInput> HeadsetView::takeInput() {
  using Kind = ScreenInput::Kind;
  std::vector<ScreenInput> input;
  for (const ScreenInput& one : exchange_->takeInput()) {
    // What was let go of here is let go of by the thread, too, when its frames come again.
    if ((one.kind == Kind::kUp && !held_) || (one.kind == Kind::kLeave && !over_)) continue;
    last_ = one;
    if (one.kind == Kind::kDown || one.kind == Kind::kUp) held_ = one.kind == Kind::kDown;
    over_ = one.kind != Kind::kLeave;
    input.push_back(one);
  }
  if ((held_ || over_) && stands()) {
    if (std::exchange(held_, false)) input.push_back({Kind::kUp, last_.x, last_.y});
    if (std::exchange(over_, false)) input.push_back({Kind::kLeave, last_.x, last_.y});
  }
  return input;
}

bool HeadsetView::finish() {
  if (!thread_.joinable()) return true;
  exchange_->stop();
  if (exchange_->waitForEnd(kLongestEnd)) {
    thread_.join();
    return true;
  }
  exchange_->leave();
  thread_.detach();
  noteThreadLeft();
  return false;
}

}  // namespace fettle::app
