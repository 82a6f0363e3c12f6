#pragma once

#include <cstdint>
#include <memory>

#include "app/window/draw_field.h"
#include "app/window/parts.h"
#include "app/window/window_state.h"
#include "app/work/loop_client.h"
#include "app/xr/headset_view.h"
#include "render/window/window.h"

namespace fettle::app {

/// The window's side of a headset (`--xr`): gives it the field and the window's frame, brings what hands do on that frame to
/// the window, and notes the headset's end, and that its frames stay away. Without a headset nothing is done.
///
/// Threading: main.
class HeadsetRoom {
 public:
  /// Also sets what the loop is to know of the controllers, in `client`. Errors: HeadsetView::start.
  [[nodiscard]] engine::Status start(render::HeadsetOptions options, RoomScale scale,
                                     LoopClientOptions& client);
  /// The window's pointer follows the hands.
  void takeInput(render::Window& window);
  /// What is to be seen. `document`: where it differs from the last one, the field is placed on the table again. At the headset's
  /// end a notice says why, and the window continues.
  void follow(Parts& parts, const DrawOptions& options, std::uint64_t document);
  /// The frame that the window has just shown.
  void showFrame(render::Window& window);
  /// Whether it goes on, and shows the window's frame also while the window itself is not seen.
  [[nodiscard]] bool on() const noexcept { return headset_ != nullptr; }
  /// Ends the session (HeadsetView::finish).
  void finish();
  [[nodiscard]] const HeadsetFigures& figures() const noexcept { return figures_; }

 private:
  void note(const HeadsetState& state);
  void noteStanding(Feedback& feedback);

  std::unique_ptr<HeadsetView> headset_;                 // null without one
  std::shared_ptr<haptic::ControllerLink> controllers_;  // null: they are no tip
  HeadsetFigures figures_;
  bool said_standing_ = false;
  std::int64_t shown_ns_ = 0;  // when the window's frame was last shown there
};

}  // namespace fettle::app
