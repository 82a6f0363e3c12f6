#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "app/work/loop_client.h"
#include "render/window/window.h"

namespace fettle::app {

/// F and Shift+F: sets the brush's radius or press depth by moving or typing; the left button or Enter
/// confirms, the right one or Esc cancels. Threading: main.
class BrushAdjustment {
 public:
  enum class Of : std::uint8_t { kNothing, kRadius, kDepth };

  /// kDepth needs a mouse; without one nothing begins.
  void begin(Of of, LoopClient& client, double cursor_x);
  /// Whether the event was used.
  bool handle(const render::InputEvent& event, LoopClient& client, std::vector<Notice>& notices);
  /// Cancels: restores the previous value.
  void leave(LoopClient& client, std::vector<Notice>& notices);

  [[nodiscard]] Of of() const noexcept { return of_; }
  [[nodiscard]] bool active() const noexcept { return of_ != Of::kNothing; }
  /// Digits so far; empty: set by moving.
  [[nodiscard]] const std::string& typed() const noexcept { return typed_; }

 private:
  void set(LoopClient& client, double value, std::vector<Notice>& notices) const;
  bool typeKey(render::Key key);
  void end();

  Of of_ = Of::kNothing;
  double from_ = 0.0;    // [samples] or [mm]
  double from_x_ = 0.0;  // of the cursor [pixels]
  double press_mm_ = 0.0;
  std::string typed_;
};

}  // namespace fettle::app
