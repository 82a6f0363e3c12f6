#pragma once

#include <vector>

#include <imgui.h>

#include "render/plan/camera.h"
#include "render/plan/places.h"

namespace fettle::render {

/// Where the panels look different from the frame before. Triangles are compared one by one: as many as before in their order,
/// else those between what is the same at the beginning and at the end of a panel.
///
/// Threading: main thread.
class PanelDamage {
 public:
  /// Adds to `places` [px, of a window with one pixel per unit of ImGui] all pixels that the panels drew before or draw now in
  /// another way, and keeps what they draw now. False: all of them, as nothing is known of before.
  [[nodiscard]] bool next(const ImDrawData& panels, Places& places);
  /// Whether something is known of the frame before.
  [[nodiscard]] bool known() const noexcept { return known_; }
  /// The next frame is the first one.
  void forget() noexcept { known_ = false; }

 private:
  struct Panel {
    std::vector<ImDrawCmd> commands;
    std::vector<ImDrawVert> corners;
    std::vector<ImDrawIdx> order;

    [[nodiscard]] bool same(const ImDrawList& now) const noexcept;
    void keep(const ImDrawList& now);
  };
  static void compare(const Panel& before, const ImDrawList& now, Places& places);

  bool known_ = false;
  std::vector<Panel> panels_;
};

/// The commands of a panel cut to these places, which are disjoint: what they draw outside is as it was.
[[nodiscard]] ImVector<ImDrawCmd> cutTo(const ImVector<ImDrawCmd>& commands,
                                        const std::vector<Rectangle>& places);

}  // namespace fettle::render
