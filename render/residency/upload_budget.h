#pragma once

#include <cstdint>
#include <limits>

#include "engine/base/stopwatch.h"

namespace fettle::render {

/// What a frame may spend on uploading.
struct UploadBudget {
  std::int64_t bytes = 0;
  double ms = std::numeric_limits<double>::infinity();  ///< of this thread, since it was made
  engine::Stopwatch since = {};

  [[nodiscard]] bool late() const noexcept { return since.ms() > ms; }
};

}  // namespace fettle::render
