#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "engine/field/version.h"
#include "render/detail/patches.h"

namespace fettle::render {

/// The patches that panels were chosen last: where nothing changed that choosing looks at, they are taken
/// from there. So of several panels at rest, each of a million vertices, an edit chooses those of its own
/// panel alone.
///
/// Threading: one thread at a time.
class KeptTrees {
 public:
  /// The tree of a panel for `question`, which asks about `version`: as PatchTree(question).
  [[nodiscard]] PatchTree tree(std::size_t panel, const PatchQuestion& question,
                               const engine::Version& version);
  /// Keeps nothing of panels from this one up, so that no version lives longer than it is shown.
  void keepOnly(std::size_t panels) {
    if (kept_.size() > panels) kept_.resize(panels);
  }

 private:
  struct Kept {
    engine::Version version;     // empty: nothing is kept
    std::uint64_t measured = 0;  // DetailMeasure::state() then
    PatchTree tree;
  };
  std::vector<Kept> kept_;  // by panel
};

}  // namespace fettle::render
