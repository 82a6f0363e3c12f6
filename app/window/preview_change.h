#pragma once

#include <algorithm>

#include "render/live/live_picture.h"

namespace fettle::app {

/// Whether what is previewed beside the field differs between two pictures. One that comes or goes counts: it lays out the whole
/// picture anew. False where one of them is empty.
[[nodiscard]] inline bool previewsDiffer(const render::Shown& a, const render::Shown& b) {
  return !a.versions.empty() && !b.versions.empty() &&
         !std::equal(a.versions.begin() + 1, a.versions.end(), b.versions.begin() + 1, b.versions.end());
}

/// Whether nothing else differs between them than what is previewed, of previews that are shown in both.
[[nodiscard]] inline bool onlyPreviewsDiffer(const render::Shown& a, const render::Shown& b) {
  return a.versions.size() == b.versions.size() && !a.versions.empty() && a.versions[0] == b.versions[0] &&
         a.original == b.original && a.marks == b.marks && a.accepted == b.accepted &&
         a.difference == b.difference;
}

}  // namespace fettle::app
