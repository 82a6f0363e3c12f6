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

/// Input of the choice of patches. `measure` belongs to the state that `reader` reads.
struct PatchQuery {
  const DetailMeasure* measure = nullptr;
  engine::FieldReader reader;
  /// Whether the device holds, over these samples (last ones included), what `reader` reads; empty:
  /// everywhere.
  std::function<bool(glm::ivec2 first, glm::ivec2 last)> up_to_date;
  Placing placing;
  Camera camera;
  std::optional<Camera> other_eye;  ///< of a picture for two eyes: bounds hold for both
  /// Where only a part of the picture is drawn: cameras of that part for each eye. How finely a patch is
  /// drawn does not depend on it while the budget lasts.
  std::vector<Camera> parts;
  double mm_per_unit = 1.0;            ///< scene mm per height unit, exaggeration included; > 0
  double reference = 0.0;              ///< height at scene z 0 [height_unit]
  double lowest = 0.0, highest = 0.0;  ///< heights that are drawn; others are cut to these [height_unit]
  double floor_z = 0.0;                ///< of the plate below; rim walls reach down to it [scene mm]
  double error_px = 1.0;
  std::int64_t vertex_budget = kFrameVertices;
  /// Step between the samples that colours come from [samples], a power of two: a fragment is left out when a
  /// corner of its cell among those samples is a hole.
  std::int32_t shade_step = 1;
  /// How far around a sample a colour may depend on it [such steps].
  std::int32_t shade_reach = 3;
};

/// The surface of one panel: leaves of a quadtree over the field.
struct PatchChoice {
  std::vector<gpu::Patch> patches;  ///< first sample; level; level
  /// The first `whole` of them show no hole; within both groups, near ones come first.
  std::size_t whole = 0;
  /// Where a patch meets one of a higher level: first sample of the edge; level | the other's level << 8;
  /// side (0 low y, 1 high x, 2 high y, 3 low x, as seen from the finer patch).
  std::vector<gpu::Patch> seams;
  std::vector<gpu::Patch> walls;  ///< along the rim, as read by shaders/wall.vert
  double bound_px = 0.0;          ///< the largest screen error of a patch
  bool within_budget = true;      ///< false when refining stopped before bound_px <= error_px
  [[nodiscard]] std::int64_t vertices() const noexcept;
  [[nodiscard]] std::int64_t triangles() const noexcept;  ///< without those of area zero
};

/// A patch that is drawn, or was chosen for drawing.
struct PatchLeaf {
  int level = 0;
  glm::ivec2 patch{0};  ///< in patches of its level
  bool holed = false;   ///< may hold a hole (unknown at level 0)
};

/// Refines the patch of the largest screen error until all are within error_px or the budget is spent. Leaves
/// out what is outside the plot (or its drawn part) or has no height, by the min/max pyramid.
///
/// Screen error of a patch: the smaller of two bounds, each valid for every point of the fine surface over it
/// and for every point drawn:
///   - straight up or down: the deviation (detail.h), at the largest scale anywhere in the patch's box;
///   - sideways within its cell to a drawn point of the same height, and up or down by the excess.
/// Where the deviation is not known (yet) and no hole is near, the range of the patch's heights in the
/// min/max pyramid is an upper limit, since all vertices are samples: the same holds for the excess.
/// Where heights of the patch are clipped, the first bound is replaced by the range of the clipped heights,
/// since clipping and interpolating do not commute. So bound_px is an upper limit of the Hausdorff distance
/// on the screen between the two surfaces. Camera::movesAtMost bounds the size of a step on the screen.
class PatchTree {
 public:
  PatchTree() = default;
  explicit PatchTree(const PatchQuery& query);
  /// What was chosen for an equal query (matches()), as it was before prune() unless that was called.
  PatchTree(const PatchQuery& query, const PatchTree& chosen);
  /// Whether the query equals this tree's, except for the field, its measure and whether it is up to date.
  [[nodiscard]] bool matches(const PatchQuery& query) const;
  /// What was chosen, near ones first.
  [[nodiscard]] std::vector<PatchLeaf> leaves() const;
  /// The visible ones: as patches of at most 2^log2_side samples per side, without those outside the plot.
  [[nodiscard]] std::vector<PatchLeaf> parts(int log2_side) const;
  /// Replaces patches of which one is not `drawable` by a coarser one: bound_px grows accordingly. The
  /// coarsest patch is drawn in any case. Returns whether any was replaced.
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

  PatchQuery q_{};
  std::vector<Node> nodes_;
  bool within_budget_ = true;
};

/// Bounds on the heights of a rectangle of virtual samples, last ones included, from pyramid squares of about
/// a quarter of its size. Empty where there are only holes.
[[nodiscard]] engine::HeightBounds heightsWithin(const engine::FieldReader& reader, glm::ivec2 first,
                                                 glm::ivec2 last);

/// Whether a sample of that rectangle is a hole. Cost: proportional to the tree's nodes with holes.
[[nodiscard]] bool holeWithin(const engine::FieldReader& reader, glm::ivec2 first, glm::ivec2 last);

[[nodiscard]] PatchChoice choosePatches(const PatchQuery& query);

}  // namespace fettle::render
