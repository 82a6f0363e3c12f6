#pragma once

#include <string>

#include "render/plan/picture.h"

namespace fettle::app {

/// Where the camera stands at the start.
[[nodiscard]] render::View startView();

/// A camera as a note of a session, and back; the start's where the note does not say.
[[nodiscard]] std::string viewText(const render::View& view);
[[nodiscard]] render::View viewOf(const std::string& text);

}  // namespace fettle::app
