#include "render/detail/patch_tree_cache.h"

namespace fettle::render {

PatchTree PatchTreeCache::tree(std::size_t panel, const PatchQuery& query, const engine::Version& version) {
  if (cached_.size() <= panel) cached_.resize(panel + 1);
  Cached& cached = cached_[panel];
  // While tiles are being uploaded, a result is valid for one frame only.
  if (query.up_to_date) {
    cached = {};
    return PatchTree(query);
  }
  if (!holds(cached, query, version)) {
    const DetailMeasure& measure = *query.measure;
    cached = {version, measure.state(), measure.invalidated(), measure.unknown(), PatchTree(query)};
  }
  return PatchTree(query, cached.tree);
}

bool PatchTreeCache::holds(const Cached& cached, const PatchQuery& query, const engine::Version& version) {
  constexpr std::size_t kMany = 512;  // tiles
  if (cached.version.empty() || !(cached.version == version) || !cached.tree.matches(query)) return false;
  const DetailMeasure& measure = *query.measure;
  if (cached.measured == measure.state()) return true;
  return cached.invalidated == measure.invalidated() && measure.unknown() >= kMany &&
         8 * measure.unknown() > 7 * cached.unknown;
}

}  // namespace fettle::render
