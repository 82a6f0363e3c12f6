#pragma once

#include <optional>
#include <string>

#include "render/plan/picture.h"

namespace fettle::app {

/// The view at the start.
[[nodiscard]] render::View startView();

/// A camera as a note of a session, and back; nothing where the note has none that a picture can show.
[[nodiscard]] std::string viewText(const render::View& view);
[[nodiscard]] std::optional<render::View> parseView(const std::string& text);
/// The same; the start's where there is none.
[[nodiscard]] render::View viewOf(const std::string& text);

}  // namespace fettle::app
