#pragma once

#include <span>
#include <vector>

#include "engine/filter/filter.h"

namespace fettle::app {

/// Filters for one purpose.
struct FilterGroup {
  const char* heading;  ///< the purpose, in words
  std::vector<engine::FilterKind> filters;
};

/// Every filter once, by what a person has in mind, in the order in which a scan is cleaned: spikes, then noise, then scales.
/// Any thread.
[[nodiscard]] std::span<const FilterGroup> filterGroups();

/// The filter after this one in that list, the first after the last.
[[nodiscard]] engine::FilterKind filterAfter(engine::FilterKind kind);

}  // namespace fettle::app
