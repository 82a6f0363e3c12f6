#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "app/work/loop_client.h"
#include "render/plan/number_text.h"
#include "render/window/window.h"

namespace fettle::app {

/// F and Shift+F: sets the brush's radius or press depth by moving or typing; the left button or Enter
/// confirms, the right one or Esc cancels. A depth is typed in the unit in which heights are shown, or in one that is typed
/// behind it. Threading: main.
class BrushAdjustment {
 public:
  enum class Of : std::uint8_t { kNothing, kRadius, kDepth };

  /// kDepth needs a mouse; without one nothing begins. `height`: in which heights are shown.
  void begin(Of of, LoopClient& client, const render::ShownUnit& height, double cursor_x);
  /// Whether the event was used.
  bool handle(const render::InputEvent& event, LoopClient& client, std::vector<Notice>& notices);
  /// Cancels: restores the previous value.
  void leave(LoopClient& client, std::vector<Notice>& notices);

  [[nodiscard]] Of of() const noexcept { return of_; }
  [[nodiscard]] bool active() const noexcept { return of_ != Of::kNothing; }
  /// What is typed so far; empty: set by moving.
  [[nodiscard]] const std::string& typed() const noexcept { return typed_; }
  /// Whether that is a number, in a known unit if there is one; nothing is set meanwhile, and Enter waits.
  [[nodiscard]] bool understood() const { return typed_.empty() || valueTyped().has_value(); }
  /// [mm], as shown.
  [[nodiscard]] const render::ShownUnit& depthUnit() const noexcept { return depth_; }

 private:
  void set(LoopClient& client, double value, std::vector<Notice>& notices) const;
  bool typeKey(const render::InputEvent& event);
  [[nodiscard]] std::optional<double> valueTyped() const;  // [samples] or [mm]
  void end();

  Of of_ = Of::kNothing;
  double from_ = 0.0;    // [samples] or [mm]
  double from_x_ = 0.0;  // of the cursor [pixels]
  double press_mm_ = 0.0;
  render::ShownUnit depth_;
  std::string typed_;
};

}  // namespace fettle::app
