#include "render/detail/kept_trees.h"

namespace fettle::render {

PatchTree KeptTrees::tree(std::size_t panel, const PatchQuestion& question, const engine::Version& version) {
  if (kept_.size() <= panel) kept_.resize(panel + 1);
  Kept& kept = kept_[panel];
  const std::uint64_t measured = question.measure->state();
  // While tiles are on their way an answer holds for a frame.
  if (question.settled) {
    kept = {};
    return PatchTree(question);
  }
  if (kept.version.empty() || !(kept.version == version) || kept.measured != measured ||
      !kept.tree.answers(question))
    kept = {version, measured, PatchTree(question)};
  return PatchTree(question, kept.tree);
}

}  // namespace fettle::render
