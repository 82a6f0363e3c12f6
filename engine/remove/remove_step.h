#pragma once

#include <string_view>

namespace fettle::engine {

/// What the name of a step that removed samples begins with, in lists of steps and in the sessions that store them.
inline constexpr std::string_view kRemoveStep = "Remove";

}  // namespace fettle::engine
