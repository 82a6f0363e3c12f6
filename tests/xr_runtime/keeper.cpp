#include "tests/xr_runtime/keeper.h"

#include <utility>

namespace fettle::tests::xr {

namespace {

constexpr std::array<const char*, 2> kEyes{"left", "right"};

bool sees(const XrCompositionLayerQuad& quad, std::size_t eye) {
  return quad.eyeVisibility == XR_EYE_VISIBILITY_BOTH ||
         quad.eyeVisibility == (eye == 0 ? XR_EYE_VISIBILITY_LEFT : XR_EYE_VISIBILITY_RIGHT);
}

void write(const KeptFrame& frame) {
  const std::string begin = runtime().keep + "/frame" + std::to_string(frame.number) + ".";
  const auto file = [&](const Pixels& pixels, const std::string& name) {
    if (!pixels.rgba.empty()) (void)keepPicture(pixels, begin + name + ".png");
  };
  for (std::size_t i = 0; i < frame.quads.size(); ++i)
    file(frame.quads[i].picture, "quad" + std::to_string(i));
  for (std::size_t i = 0; i < frame.eyes.size(); ++i) {
    const KeptFrame::Eye& eye = frame.eyes[i];
    file(eye.own, kEyes[i]);
    if (frame.quads.empty()) continue;
    Pixels seen = eye.own;
    for (const KeptFrame::Quad& quad : frame.quads)
      if (quad.placed && sees(quad.layer, i))
        composeQuad(quad.layer, quad.pose, quad.picture, eye.pose, eye.fov, seen);
    file(seen, std::string(kEyes[i]) + ".seen");
  }
  const std::lock_guard lock(runtime().mutex);
  runtime().say("frame " + std::to_string(frame.number) + frame.layers);
}

}  // namespace

void Keeper::keep(KeptFrame frame) {
  const std::lock_guard lock(mutex_);
  waiting_.push_back(std::move(frame));
  if (!thread_.joinable()) thread_ = std::thread(&Keeper::run, this);
  changed_.notify_all();
}

void Keeper::finish() {
  std::unique_lock lock(mutex_);
  if (!thread_.joinable()) return;
  ends_ = true;
  changed_.notify_all();
  lock.unlock();
  thread_.join();
  ends_ = false;
}

void Keeper::run() {
  std::unique_lock lock(mutex_);
  while (true) {
    changed_.wait(lock, [this] { return ends_ || !waiting_.empty(); });
    if (waiting_.empty()) return;
    const KeptFrame frame = std::move(waiting_.front());
    waiting_.pop_front();
    lock.unlock();
    std::this_thread::sleep_for(std::chrono::duration<double>(frame.takes_s));
    write(frame);
    lock.lock();
  }
}

Keeper& keeper() {
  static Keeper the_keeper;
  return the_keeper;
}

}  // namespace fettle::tests::xr
