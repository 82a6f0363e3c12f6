#pragma once

#include <functional>
#include <string>
#include <string_view>

namespace fettle::app {

/// A text broken into lines of at most `width` where there are spaces, but not between a number and its unit ("12 µm"), nor
/// around the x of "5 x 5". A word wider than that has a line of its own. Lines of the text stay. `measure`: the width of a
/// part of a line.
[[nodiscard]] std::string brokenText(std::string_view text, float width,
                                     const std::function<float(std::string_view)>& measure);

}  // namespace fettle::app
