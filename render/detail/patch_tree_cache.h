#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "engine/field/version.h"
#include "render/detail/patches.h"

namespace fettle::render {

/// Cache of the last patch tree of each panel, reused while none of its inputs changed. With several panels
/// of a million vertices each and a camera at rest, an edit chooses the patches of its own panel only.
///
/// While many tiles are unknown, some of which each frame measures, a tree takes 15 to 30 ms and gains little: one is reused until an
/// eighth of them has become known. What it draws is as fine as what the field required then, and its bound holds.
///
/// Threading: one thread at a time.
class PatchTreeCache {
 public:
  /// The tree of a panel for `query`, which is about `version`: as PatchTree(query), or as it was before the last tiles became known.
  [[nodiscard]] PatchTree tree(std::size_t panel, const PatchQuery& query, const engine::Version& version);
  /// Drops the trees from this panel on, so that no version is held longer than it is shown.
  void keepOnly(std::size_t panels) {
    if (cached_.size() > panels) cached_.resize(panels);
  }

 private:
  struct Cached {
    engine::Version version;  // empty: nothing is cached
    // Of DetailMeasure, then.
    std::uint64_t measured = 0, invalidated = 0;
    std::size_t unknown = 0;
    PatchTree tree;
  };
  [[nodiscard]] static bool holds(const Cached& cached, const PatchQuery& query,
                                  const engine::Version& version);
  std::vector<Cached> cached_;  // by panel
};

}  // namespace fettle::render
