#include "app/window/headset_room.h"

#include <utility>

#include "app/terminal.h"
#include "app/texts/texts.h"
#include "app/work/device_loop.h"
#include "engine/base/stopwatch.h"

namespace fettle::app {
namespace {

constexpr std::int64_t kAgain_ns = 25'000'000;  // between two frames of the window in the room
constexpr const char* kStands = textOf("the headset makes no frames");

}  // namespace

engine::Status HeadsetRoom::start(render::HeadsetOptions options, RoomScale scale,
                                  LoopClientOptions& client) {
  client.controllers = controllers_ = controllersBeside(client.device);
  auto started = HeadsetView::start({{options, scale, client.controllers}, &render::Window::wake});
  if (!started) return tl::unexpected(started.error());
  headset_ = *std::move(started);
  return {};
}

void HeadsetRoom::takeInput(render::Window& window) {
  if (!headset_) return;
  using render::InputKind;
  static constexpr std::pair<ScreenInput::Kind, InputKind> kKinds[] = {
      {ScreenInput::Kind::kMove, InputKind::kMove},   {ScreenInput::Kind::kDown, InputKind::kButtonDown},
      {ScreenInput::Kind::kUp, InputKind::kButtonUp}, {ScreenInput::Kind::kWheel, InputKind::kWheel},
      {ScreenInput::Kind::kLeave, InputKind::kLeave},
  };
  for (const ScreenInput& input : headset_->takeInput()) {
    render::InputEvent event;
    for (const auto& [done, kind] : kKinds)
      if (done == input.kind) event.kind = kind;
    event.button = render::MouseButton::kLeft;
    event.x = input.x * window.width();
    event.y = input.y * window.height();
    event.wheel = input.wheel;
    window.point(event);
  }
}

void HeadsetRoom::follow(Parts& parts, const DrawOptions& options, std::uint64_t document) {
  if (!headset_) return;
  const HeadsetState state = headset_->state();
  note(state);
  noteStanding(parts.feedback);
  if (controllers_) controllers_->asked.store(parts.feedback.questions.pending(), std::memory_order_relaxed);
  if (!state.over) {
    if (!parts.document.isOpen()) return;
    HeadsetPicture picture = headsetPicture(parts, options);
    picture.field = document;
    picture.tip = tipLookOf(parts);
    if (controllers_) picture.reader = controllers_->reader.load(std::memory_order_relaxed);
    headset_->show(std::move(picture));
    return;
  }
  // The window goes on without it, and nothing that was done is lost. The last of its input ends what hands held there.
  takeInput(parts.window);
  parts.feedback.notices.push_back(
      state.error ? Notice{state.error->what,
                           tr("the window continues; start fettle view --xr again for the headset")}
                  : Notice{tr("the headset's session was ended"), tr("the window continues")});
  headset_.reset();
  parts.picture.requestRedraw();
}

void HeadsetRoom::showFrame(render::Window& window) {
  const std::int64_t now = engine::steadyNs();
  if (!headset_ || now - shown_ns_ < kAgain_ns) return;
  shown_ns_ = now;
  // A lost device is reported by the next frame.
  if (auto frame = window.capture()) headset_->showWindow(*std::move(frame));
}

void HeadsetRoom::finish() {
  if (!headset_) return;
  if (!headset_->finish())
    warn("the headset's runtime did not answer: its session was left as it was; restart the runtime");
  note(headset_->state());
  headset_.reset();
}

// Said when it begins, and no longer than it lasts.
void HeadsetRoom::noteStanding(Feedback& feedback) {
  if (std::exchange(said_standing_, figures_.stands) == figures_.stands) return;
  if (figures_.stands)
    feedback.notices.push_back(
        {kStands, tr("the window continues; if it stays so, restart the headset's runtime")});
  else
    std::erase_if(feedback.notices, [](const Notice& notice) { return notice.what == kStands; });
}

void HeadsetRoom::note(const HeadsetState& state) {
  figures_ = {.name = state.headset,
              .frames = state.frames,
              .over = state.over,
              .stands = headset_->stands(),
              .true_size = state.scale == RoomScale::kTrue,
              .metres_per_mm = state.metres_per_mm,
              .tip = state.tip,
              .points = state.points,
              .validation = state.validation};
}

}  // namespace fettle::app
