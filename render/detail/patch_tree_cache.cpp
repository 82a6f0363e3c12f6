#include "render/detail/patch_tree_cache.h"

namespace fettle::render {

PatchTree PatchTreeCache::tree(std::size_t panel, const PatchQuery& query, const engine::Version& version) {
  if (cached_.size() <= panel) cached_.resize(panel + 1);
  Cached& cached = cached_[panel];
  const std::uint64_t measured = query.measure->state();
  // While tiles are being uploaded, a result is valid for one frame only.
  if (query.up_to_date) {
    cached = {};
    return PatchTree(query);
  }
  if (cached.version.empty() || !(cached.version == version) || cached.measured != measured ||
      !cached.tree.matches(query))
    cached = {version, measured, PatchTree(query)};
  return PatchTree(query, cached.tree);
}

}  // namespace fettle::render
