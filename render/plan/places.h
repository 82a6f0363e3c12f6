#pragma once

#include <cstddef>
#include <vector>

#include "render/plan/camera.h"

namespace fettle::render {

/// Few rectangles that cover all that were added, no two of which overlap: near ones become one.
class Places {
 public:
  static constexpr std::size_t kMost = 8;

  void add(const Rectangle& place);
  /// Disjoint, at most kMost, in no order.
  [[nodiscard]] std::vector<Rectangle> take();

 private:
  std::vector<Rectangle> places_;
};

}  // namespace fettle::render
