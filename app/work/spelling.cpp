#include "app/work/spelling.h"

#include <algorithm>

#include <fmt/format.h>

#include "engine/base/lower_case.h"

namespace fettle::app {

namespace {

// Letters wrong, missing, in excess, or swapped with their neighbour: the optimal string alignment distance.
std::size_t distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> before(b.size() + 1), above(b.size() + 1), row(b.size() + 1);
  for (std::size_t j = 0; j <= b.size(); ++j) above[j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      row[j] = std::min({above[j] + 1, row[j - 1] + 1, above[j - 1] + (a[i - 1] == b[j - 1] ? 0U : 1U)});
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1])
        row[j] = std::min(row[j], before[j - 2] + 1);
    }
    std::swap(before, above);
    std::swap(above, row);
  }
  return above[b.size()];
}

}  // namespace

std::optional<std::string> nearest(std::string_view word, const std::vector<std::string>& candidates) {
  constexpr std::size_t kLongest = 64;  // longer words are not typing errors, and cost their square
  constexpr std::size_t kPrefix = 3;
  if (word.empty() || word.size() > kLongest) return std::nullopt;
  const std::string typed = engine::lowerCase(word);
  const std::string *begun = nullptr, *near = nullptr;
  std::size_t begins = 0, least = std::max<std::size_t>(1, typed.size() / 3) + 1, equal = 0;
  for (const std::string& candidate : candidates) {
    const std::string known = engine::lowerCase(candidate);
    if (known == typed) return candidate;
    if (typed.size() >= kPrefix && known.starts_with(typed)) {
      begun = &candidate;
      ++begins;
    }
    const std::size_t wrong = distance(typed, known);
    if (wrong < least) {
      least = wrong;
      near = &candidate;
      equal = 1;
    } else if (wrong == least) {
      ++equal;
    }
  }
  if (begins == 1) return *begun;
  return near != nullptr && equal == 1 ? std::optional(*near) : std::nullopt;
}

std::string didYouMean(std::string_view word, const std::vector<std::string>& candidates) {
  const auto meant = nearest(word, candidates);
  return meant ? fmt::format("did you mean {}?", *meant) : std::string();
}

}  // namespace fettle::app
