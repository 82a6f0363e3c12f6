#include "app/xr/headset_exchange.h"

#include <utility>

namespace fettle::app {

void HeadsetExchange::show(HeadsetPicture picture) {
  const std::lock_guard lock(mutex_);
  next_ = std::move(picture);
}

void HeadsetExchange::showWindow(render::Image frame) {
  const std::lock_guard lock(mutex_);
  next_window_ = std::move(frame);
}

void HeadsetExchange::stop() {
  const std::lock_guard lock(mutex_);
  stopped_ = true;
}

void HeadsetExchange::leave() {
  const std::lock_guard lock(mutex_);
  wake_ = nullptr;
}

std::vector<ScreenInput> HeadsetExchange::takeInput() {
  const std::lock_guard lock(mutex_);
  return std::exchange(input_, {});
}

HeadsetState HeadsetExchange::state() const {
  const std::lock_guard lock(mutex_);
  return state_;
}

HeadsetExchange::Clock::time_point HeadsetExchange::lastFrame() const {
  const std::lock_guard lock(mutex_);
  return last_frame_;
}

std::optional<engine::Status> HeadsetExchange::waitForStart(Clock::duration longest) {
  std::unique_lock lock(mutex_);
  changed_.wait_for(lock, longest, [this] { return started_.has_value(); });
  return started_;
}

bool HeadsetExchange::waitForEnd(Clock::duration longest) {
  std::unique_lock lock(mutex_);
  return changed_.wait_for(lock, longest, [this] { return ended_; });
}

void HeadsetExchange::noteStart(engine::Status started, std::string name) {
  const std::lock_guard lock(mutex_);
  started_ = std::move(started);
  state_.headset = std::move(name);
  last_frame_ = Clock::now();
  changed_.notify_all();
}

void HeadsetExchange::noteFrame(Clock::time_point now) {
  const std::lock_guard lock(mutex_);
  last_frame_ = now;
}

void HeadsetExchange::note(const HeadsetState& state) {
  const std::lock_guard lock(mutex_);
  state_ = state;
}

void HeadsetExchange::give(const std::vector<ScreenInput>& input) {
  const std::lock_guard lock(mutex_);
  for (const ScreenInput& one : input) appendInput(one, input_);
  if (wake_) wake_();
}

void HeadsetExchange::noteEnd(engine::Status status, std::vector<std::string> validation) {
  const std::lock_guard lock(mutex_);
  ended_ = state_.over = true;
  state_.tip.reset();
  state_.points = false;
  state_.validation = std::move(validation);
  if (!status) state_.error = status.error();
  changed_.notify_all();
}

std::optional<HeadsetPicture> HeadsetExchange::takePicture() {
  const std::lock_guard lock(mutex_);
  return std::exchange(next_, std::nullopt);
}

std::optional<render::Image> HeadsetExchange::takeWindow() {
  const std::lock_guard lock(mutex_);
  return std::exchange(next_window_, std::nullopt);
}

bool HeadsetExchange::stopped() const {
  const std::lock_guard lock(mutex_);
  return stopped_;
}

}  // namespace fettle::app
