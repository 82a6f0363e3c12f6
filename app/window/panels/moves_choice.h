#pragma once

#include <optional>

#include "app/work/align_moves.h"

namespace fettle::app {

/// A list of kNamedMoves, and of `none` where that is a choice; true when another was chosen. Draws. Threading: main.
[[nodiscard]] bool chooseMoves(const char* id, std::optional<engine::AlignMoves>& moves,
                               const char* none = nullptr);

}  // namespace fettle::app
