#include "engine/nominal/triangle_tree.h"

#include <algorithm>
#include <numeric>

namespace fettle::engine {

TriangleTree::TriangleTree(const std::vector<Box>& boxes, JobControl& job) {
  std::vector<glm::dvec3> centres;
  centres.reserve(boxes.size());
  for (const Box& box : boxes) centres.push_back(0.5 * box.low + 0.5 * box.high);
  order_.resize(boxes.size());
  std::iota(order_.begin(), order_.end(), std::uint32_t{0});
  nodes_.reserve(boxes.size() / 2 + 1);
  job.begin("sorting triangles", boxes.size());
  split(centres, 0, static_cast<std::uint32_t>(boxes.size()), job);
  nodes_ = around([&](std::uint32_t i) { return boxes[order_[i]]; });
}

void TriangleTree::split(std::vector<glm::dvec3>& centres, std::uint32_t first, std::uint32_t count,
                         JobControl& job) {
  const std::size_t place = nodes_.size();
  nodes_.push_back({{}, first, count});
  if (count <= kLeaf || job.cancelled()) {
    job.advance(count);
    return;
  }
  Box all{centres[order_[first]], centres[order_[first]]};
  for (std::uint32_t i = first; i < first + count; ++i)
    all = joinedBox(all, {centres[order_[i]], centres[order_[i]]});
  const glm::dvec3 size = all.high - all.low;
  const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
  const std::uint32_t half = count / 2;
  const auto begin = order_.begin() + first;
  // Ties by index: the order is the same with every library.
  std::nth_element(begin, begin + half, begin + count, [&](std::uint32_t a, std::uint32_t b) {
    const double at_a = centres[a][axis], at_b = centres[b][axis];
    return at_a < at_b || (at_a == at_b && a < b);
  });
  split(centres, first, half, job);
  nodes_[place].count = 0;
  nodes_[place].first = static_cast<std::uint32_t>(nodes_.size());
  split(centres, first + half, count - half, job);
}

}  // namespace fettle::engine
