#pragma once

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

  engine::FieldForm form_;  // over the field of the last frame
};

}  // namespace fettle::app
