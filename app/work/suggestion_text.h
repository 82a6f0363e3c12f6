#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

#include "engine/suggest/filter_suggestion.h"
#include "render/plan/number_text.h"

namespace fettle::app {

/// A candidate in the words of the window: "Total variation 31 x 31, range 1.5 noises".
[[nodiscard]] std::string candidateName(const engine::FilterCandidate& candidate);

/// In which words a suggestion is given: those of the command line or those of the window.
struct SuggestionWords {
  render::ShownUnit unit;                                             ///< of errors
  std::function<std::string(const engine::FilterCandidate&)> method;  ///< a filter with its numbers
};

/// "0.42 s", "3 min".
[[nodiscard]] std::string filterTimeText(double seconds);

/// "7.1 um on flats and 12 um near edges": what a filter is expected to leave of the error, to three digits.
[[nodiscard]] std::string leftText(const engine::FilterCandidate& candidate, const render::ShownUnit& unit);

/// The reason for the choice, from the figures; where no filter helps, that.
[[nodiscard]] std::string reasonText(const engine::FilterSuggestion& found,
                                     const engine::SuggestionRequest& asked, const SuggestionWords& words);

/// A filter that is worth being read.
struct ListedFilter {
  std::size_t candidate = 0;  ///< in FilterSuggestion::candidates
  std::string why;            ///< what it is listed for, "the least error on flats"
};

/// The suggested filter, and after it those that are the best at something: the least error, the least on flats, the least
/// near edges, the least computing; what would leave the larger error than the unchanged scan has is not listed. Each once, with all that it is listed
/// for, those of less error first.
[[nodiscard]] std::vector<ListedFilter> listedFilters(const engine::FilterSuggestion& found,
                                                      const engine::SuggestionRequest& asked,
                                                      const render::ShownUnit& unit);

}  // namespace fettle::app
