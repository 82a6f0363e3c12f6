#pragma once

#include "render/target.h"

namespace fettle::render {

/// Reads a finished picture (after PictureTarget::end) back. Throws vk::SystemError.
[[nodiscard]] Image capture(Context& context, const PictureTarget& target);

}  // namespace fettle::render
