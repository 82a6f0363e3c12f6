#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace fettle::app {

/// The candidate that a mistyped word most likely means: equal except for case, the only one that begins with
/// it (from three letters on), or the one with the fewest letters wrong, missing, in excess or swapped, one
/// in three at most. Empty where none is near, or two are equally near.
[[nodiscard]] std::optional<std::string> nearest(std::string_view word,
                                                 const std::vector<std::string>& candidates);

/// "did you mean X?"; empty where nothing is near.
[[nodiscard]] std::string didYouMean(std::string_view word, const std::vector<std::string>& candidates);

}  // namespace fettle::app
