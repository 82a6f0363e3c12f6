#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include <glm/vec3.hpp>

#include "engine/base/job.h"

namespace fettle::engine {

/// The least and the greatest coordinates of something.
struct Box {
  glm::dvec3 low{0.0}, high{0.0};
};

/// Boxes around triangles in a binary tree, so that a search visits few of them: halves by the middle of the triangles'
/// centres along the longest side of theirs (J. Goldsmith and J. Salmon, Automatic creation of object hierarchies for ray
/// tracing, 1987, without its cost function). For n triangles depth log2(n / 4) + 1, some n / 2 nodes of 56 bytes,
/// n log n steps to build.
class TriangleTree {
 public:
  static constexpr std::uint32_t kLeaf = 4;  ///< most triangles of a leaf
  static constexpr std::size_t kMostDepth =
      32;  ///< of any tree of 2^32 triangles: what a search needs as stack

  struct Node {
    Box box;
    std::uint32_t first = 0;  ///< leaf: its first triangle, in the order of order()
    std::uint32_t count =
        0;  ///< leaf: its triangles; 0 for an inner node, whose first child is the next node ..
    [[nodiscard]] bool leaf() const noexcept { return count > 0; }
    [[nodiscard]] std::uint32_t second() const noexcept { return first; }  ///< .. and this the second
  };

  TriangleTree() = default;
  /// Of the boxes of triangles, at least one. Stops early when the job is cancelled. Throws std::bad_alloc.
  TriangleTree(const std::vector<Box>& boxes, JobControl& job);

  /// Parents before their children.
  [[nodiscard]] const std::vector<Node>& nodes() const noexcept { return nodes_; }
  /// The triangles in the order of the leaves, as indices into the boxes.
  [[nodiscard]] const std::vector<std::uint32_t>& order() const noexcept { return order_; }
  /// The same tree around moved triangles: boxOf(i) is the box of the i-th of order().
  [[nodiscard]] std::vector<Node> around(const auto& boxOf) const;

 private:
  void split(std::vector<glm::dvec3>& centres, std::uint32_t first, std::uint32_t count, JobControl& job);

  std::vector<Node> nodes_;
  std::vector<std::uint32_t> order_;
};

[[nodiscard]] inline Box joinedBox(const Box& a, const Box& b) noexcept {
  return {glm::dvec3(a.low.x < b.low.x ? a.low.x : b.low.x, a.low.y < b.low.y ? a.low.y : b.low.y,
                     a.low.z < b.low.z ? a.low.z : b.low.z),
          glm::dvec3(a.high.x > b.high.x ? a.high.x : b.high.x, a.high.y > b.high.y ? a.high.y : b.high.y,
                     a.high.z > b.high.z ? a.high.z : b.high.z)};
}

std::vector<TriangleTree::Node> TriangleTree::around(const auto& boxOf) const {
  std::vector<Node> nodes = nodes_;
  for (std::size_t i = nodes.size(); i-- > 0;) {
    Node& node = nodes[i];
    if (!node.leaf()) {
      node.box = joinedBox(nodes[i + 1].box, nodes[node.second()].box);
      continue;
    }
    node.box = boxOf(node.first);
    for (std::uint32_t k = 1; k < node.count; ++k) node.box = joinedBox(node.box, boxOf(node.first + k));
  }
  return nodes;
}

}  // namespace fettle::engine
