#pragma once

#include <optional>
#include <string>
#include <vector>

#include "app/work/background.h"
#include "app/work/loop_client.h"
#include "engine/field/sample_rect.h"
#include "engine/transform/rearrange.h"
#include "engine/transform/resample.h"

namespace fettle::app {

/// Crops, mirrors, turns and resamples the field that is worked on, as `fettle transform` does, in this order. The result has other samples than the
/// steps that led to it, so that it is a session of its own beside the scan, which begins with the scan transformed in the same way;
/// the work before it stays as it is. Threading: main.
class TransformTool {
 public:
  /// Edited by the panel.
  struct Options {
    bool crop = false;  ///< to what is visible
    engine::Turning turning;
    double angle_deg = 0.0;   ///< after that, counter-clockwise; -180 .. 180
    bool resample = false;    ///< to the spacing below
    double spacing_mm = 0.0;  ///< in both directions
    engine::Resampling method = engine::Resampling::kCubic;

    [[nodiscard]] bool none() const noexcept {
      return !crop && turning.none() && angle_deg == 0.0 && !resample;
    }
  };
  Options options;

  /// Writes the session `path`, which must not exist; `seen`: the rectangle that is visible.
  void write(const LoopClient& client, const engine::SampleRect& seen, std::string path);
  void cancel() noexcept { working_.cancel(); }
  /// The session that was written, once. A notice says where the form over the field did not go along.
  [[nodiscard]] std::optional<std::string> poll(std::vector<Notice>& notices);

  [[nodiscard]] bool busy() const noexcept { return working_.busy(); }
  [[nodiscard]] WorkProgress progress() const { return working_.progress(); }

 private:
  struct Work {
    std::string path;
    bool form_left_out = false;  // the one that lies over the field, and has no place over the result
  };
  Background<Work> working_;
};

}  // namespace fettle::app
