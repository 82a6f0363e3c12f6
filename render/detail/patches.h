#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "render/config.h"
#include "render/detail/detail.h"
#include "render/plan/placing.h"
#include "shaders/layout.h"

namespace fettle::render {

/// What choosing patches looks at. `measure` belongs to the state that `reader` reads.
struct PatchQuestion {
  const DetailMeasure* measure = nullptr;
  engine::FieldReader reader;
  /// Whether what is drawn over these samples, last ones included, is what `reader` reads; empty: everywhere.
  std::function<bool(glm::ivec2 first, glm::ivec2 last)> settled;
  Placing placing;
  Camera camera;
  std::optional<Camera> other_eye;  ///< of a picture for two eyes: what holds, holds for both
  /// Where a part of the picture alone is drawn: what that part of each eye's picture sees. How finely a
  /// patch is drawn does not depend on it while the budget lasts.
  std::vector<Camera> parts;
  double mm_per_unit = 1.0;            ///< scene mm, exaggeration included, a height unit; > 0
  double reference = 0.0;              ///< height at scene z 0 [height_unit]
  double lowest = 0.0, highest = 0.0;  ///< heights that are drawn; others are cut to these [height_unit]
  double floor_z = 0.0;                ///< of the plate below; rim walls reach down to it [scene mm]
  double error_px = 1.0;
  std::int64_t vertex_budget = kFrameVertices;
  /// Step between the samples that colours come from [samples], a power of two: a fragment is left out when a
  /// corner of its cell among those is a hole.
  std::int32_t shade_step = 1;
};

/// The surface of one panel: leaves of a quadtree over the field.
struct PatchChoice {
  std::vector<gpu::Patch> patches;  ///< first sample; level; level
  /// So many of them, the first ones, have no hole in them or near enough to show; near ones first in either
  /// part.
  std::size_t whole = 0;
  /// Where a patch meets one of a higher level: first sample of the edge; level | the other's level << 8;
  /// side (0 low y, 1 high x, 2 high y, 3 low x, as seen from the finer patch).
  std::vector<gpu::Patch> seams;
  std::vector<gpu::Patch> walls;  ///< along the rim, as shaders/wall.vert has it
  double bound_px = 0.0;          ///< the largest screen error of a patch
  bool within_budget = true;      ///< false when refining stopped before bound_px <= error_px
  [[nodiscard]] std::int64_t vertices() const noexcept;
  [[nodiscard]] std::int64_t triangles() const noexcept;  ///< without those of area zero
};

/// A patch that is drawn, or was chosen to be.
struct PatchLeaf {
  int level = 0;
  glm::ivec2 patch{0};  ///< in patches of its level
  bool holed = false;   ///< may hold a hole (level 0 keeps no record of that)
};

/// Refines the patch of the largest screen error, until all are within error_px or the budget is spent.
/// Leaves out what is outside the plot (or the part of it that is drawn) or has no height, by the min/max pyramid.
///
/// Screen error of a patch: the smaller of two bounds, each valid for every point of the fine surface over it
/// and for every point drawn:
///   - straight up or down: the deviation (detail.h), as long as it can look anywhere in the patch's box;
///   - sideways within its cell to a drawn point of the same height, and up or down by the excess.
/// Where the deviation is not known (yet), and no hole is near, it is no more than the range of the patch's
/// heights in the min/max pyramid, since all vertices are samples: the same holds for the excess.
/// Where heights of the patch are cut, the first is replaced by the range of what is left of them, since
/// cutting and interpolating do not commute. So bound_px is the Hausdorff distance on the screen between the
/// two, at most. The third part is Camera::movesAtMost, which bounds what a step can look like.
class PatchTree {
 public:
  PatchTree() = default;
  explicit PatchTree(const PatchQuestion& question);
  /// What was chosen for an equal question (answers()), as it was before prune() unless that was called.
  PatchTree(const PatchQuestion& question, const PatchTree& chosen);
  /// Whether the question is equal to this tree's, but for the field, its measure and whether it is settled.
  [[nodiscard]] bool answers(const PatchQuestion& question) const;
  /// What was chosen, near ones first.
  [[nodiscard]] std::vector<PatchLeaf> leaves() const;
  /// What can be seen of them: as patches of at most 2^log2_side samples a side, those outside the plot left
  /// out.
  [[nodiscard]] std::vector<PatchLeaf> parts(int log2_side) const;
  /// Draws a coarser patch in the place of those of which one is not `drawable`: bound_px grows to what is
  /// drawn then. The coarsest patch is drawn in any case. Whether there was one to be replaced.
  bool prune(const std::function<bool(const PatchLeaf&)>& drawable);
  [[nodiscard]] PatchChoice list() const;

 private:
  struct Node {
    int level = 0;
    std::int32_t x = 0, y = 0;  // in patches of its level
    double error_px = 0.0;
    double depth = 0.0;
    std::array<std::int32_t, 4> children{-1, -1, -1, -1};  // -1: nothing to draw there
    bool leaf = true;
    bool holed = false;
  };
  [[nodiscard]] const Node& node(std::int32_t i) const noexcept {
    return nodes_[static_cast<std::size_t>(i)];
  }
  [[nodiscard]] Node& node(std::int32_t i) noexcept { return nodes_[static_cast<std::size_t>(i)]; }
  void refine();
  std::int32_t add(int level, std::int32_t x, std::int32_t y);
  [[nodiscard]] DetailMeasure::Error errorOf(int level, glm::ivec2 patch, glm::ivec2 first, glm::ivec2 last,
                                             const engine::HeightBounds& raw) const;
  [[nodiscard]] bool mayShowHole(const Node& n) const;
  [[nodiscard]] std::array<bool, 4> wallsSeen(const Camera& camera) const;
  [[nodiscard]] bool misses(const Box& box) const noexcept;
  [[nodiscard]] double movesAtMost(const glm::dvec3& step, const Box& box) const noexcept;
  [[nodiscard]] int levelAt(int level, std::int32_t x, std::int32_t y) const;
  [[nodiscard]] std::vector<std::int32_t> sorted() const;
  void split(const PatchLeaf& leaf, double low_z, double high_z, int lowest_level,
             std::vector<PatchLeaf>& out) const;
  bool pruneBelow(std::int32_t at, const std::function<bool(const PatchLeaf&)>& drawable, bool& replaced);
  void drop(std::int32_t at);

  PatchQuestion q_{};
  std::vector<Node> nodes_;
  bool within_budget_ = true;
};

/// Bounds on the heights of a rectangle of virtual samples, last ones included, from squares of the pyramid a
/// quarter as large or so. Empty where there are only holes.
[[nodiscard]] engine::HeightBounds heightsWithin(const engine::FieldReader& reader, glm::ivec2 first,
                                                 glm::ivec2 last);

/// Whether a sample of that rectangle is a hole. Cost: of the tree's nodes that hold any.
[[nodiscard]] bool holeWithin(const engine::FieldReader& reader, glm::ivec2 first, glm::ivec2 last);

[[nodiscard]] PatchChoice choosePatches(const PatchQuestion& question);

}  // namespace fettle::render
