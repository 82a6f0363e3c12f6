#pragma once

#include <string_view>

#include "app/window/actions.h"

namespace fettle::app {

/// When one reaches for an action and what comes of it, for the tips of its buttons: one sentence or two. Empty where its name
/// says it all.
[[nodiscard]] std::string_view tipOf(Action action) noexcept;

}  // namespace fettle::app
