#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "app/window/parts.h"

namespace fettle::app {

/// What the loop and the workers of the tools have finished is taken over, once per frame, and then seen. With an open
/// document only. Threading: main.
class ToolResults {
 public:
  /// The document was opened just now.
  void begin(Parts& parts);
  /// Returns the path of what was written to be opened, if anything was.
  [[nodiscard]] std::optional<std::string> take(Parts& parts);

 private:
  void followForm(Parts& parts);
  void followExtremes(Parts& parts);

  engine::FieldForm form_;  // over the field of the last frame
  std::int64_t step_ = 0;   // of the last frame
  bool stepped_ =
      false;  // a step that is none of a brush was made or taken back, and its colours are not found yet
  engine::HeightBounds extremes_;  // by which they were found
};

}  // namespace fettle::app
