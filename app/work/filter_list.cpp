#include "app/work/filter_list.h"

#include <algorithm>
#include <array>
#include <cstddef>

#include "app/texts/texts.h"
#include "engine/filter/catalogue.h"

namespace fettle::app {
namespace {

enum Purpose : std::size_t { kSpikes, kSmoothing, kKeepingEdges, kScales, kPurposes };

Purpose purposeOf(const engine::Filter& filter) {
  if (filter.kind == engine::FilterKind::kOutliers) return kSpikes;
  if (engine::separatesScales(filter)) return kScales;
  return engine::keepsEdges(filter) ? kKeepingEdges : kSmoothing;
}

std::array<FilterGroup, kPurposes> grouped() {
  std::array<FilterGroup, kPurposes> groups{{{textOf("spikes, lines, holes"), {}},
                                             {textOf("noise, edges get round"), {}},
                                             {textOf("noise, edges stay"), {}},
                                             {textOf("waves by their length (ISO 16610)"), {}}}};
  for (const engine::Filter& filter : engine::filters())
    groups[purposeOf(filter)].filters.push_back(filter.kind);
  return groups;
}

}  // namespace

std::span<const FilterGroup> filterGroups() {
  static const std::array<FilterGroup, kPurposes> groups = grouped();
  return groups;
}

engine::FilterKind filterAfter(engine::FilterKind kind) {
  std::vector<engine::FilterKind> all;
  for (const FilterGroup& group : filterGroups())
    all.insert(all.end(), group.filters.begin(), group.filters.end());
  const auto now = std::ranges::find(all, kind);
  return now == all.end() || now + 1 == all.end() ? all.front() : *(now + 1);
}

}  // namespace fettle::app
