#pragma once

#include <string>

#include "render/plan/picture.h"

namespace fettle::app {

/// The view at the start.
[[nodiscard]] render::View startView();

/// A camera as a note of a session, and back; the start's where the note has none.
[[nodiscard]] std::string viewText(const render::View& view);
[[nodiscard]] render::View viewOf(const std::string& text);

}  // namespace fettle::app
