#include "engine/nominal/mesh_topology.h"

#include <algorithm>
#include <numeric>
#include <tuple>

#include <tbb/parallel_sort.h>
#include <glm/geometric.hpp>

namespace fettle::engine {

namespace {

// A side of a triangle, by its corners, the lower index first.
struct Side {
  std::uint32_t low, high;
  std::uint32_t triangle;
  std::uint32_t place;  // 0 .. 2: from this corner to the next; 4 more where that goes from `high` to `low`

  [[nodiscard]] auto key() const noexcept { return std::tie(low, high, triangle, place); }
};

}  // namespace

glm::dvec3 areaNormal(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c) noexcept {
  return glm::cross(b - a, c - a);
}

MeshTopology joinedCorners(std::vector<TriangleCorners>&& triangles) {
  const std::size_t count = triangles.size() * 3;
  const auto at = [&triangles](std::uint32_t i) -> const glm::dvec3& { return triangles[i / 3][i % 3]; };
  std::vector<std::uint32_t> order(count);
  std::iota(order.begin(), order.end(), std::uint32_t{0});
  tbb::parallel_sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
    const glm::dvec3 &p = at(a), &q = at(b);
    return std::tie(p.x, p.y, p.z, a) < std::tie(q.x, q.y, q.z, b);
  });
  MeshTopology mesh;
  std::vector<std::uint32_t> joined(count);
  for (std::size_t i = 0; i < count; ++i) {
    if (i == 0 || at(order[i]) != at(order[i - 1])) mesh.corners.push_back(at(order[i]));
    joined[order[i]] = static_cast<std::uint32_t>(mesh.corners.size() - 1);
  }
  order = std::vector<std::uint32_t>();
  mesh.triangles.reserve(triangles.size());
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    const glm::dvec3 normal = areaNormal(triangles[t][0], triangles[t][1], triangles[t][2]);
    // Also of one whose area is too small for its square.
    if (!(glm::dot(normal, normal) > 0.0)) {
      ++mesh.without_area;
      continue;
    }
    mesh.triangles.push_back({joined[3 * t], joined[3 * t + 1], joined[3 * t + 2]});
  }
  triangles = std::vector<TriangleCorners>();
  return mesh;
}

Neighbours neighboursOf(const std::vector<TriangleIndices>& triangles) {
  Neighbours out;
  out.of.assign(triangles.size(), {kNoTriangle, kNoTriangle, kNoTriangle});
  std::vector<Side> sides;
  sides.reserve(triangles.size() * 3);
  for (std::size_t t = 0; t < triangles.size(); ++t)
    for (std::uint32_t k = 0; k < 3; ++k) {
      const std::uint32_t from = triangles[t][k], to = triangles[t][(k + 1) % 3];
      sides.push_back(
          {std::min(from, to), std::max(from, to), static_cast<std::uint32_t>(t), k + (from > to ? 4U : 0U)});
    }
  tbb::parallel_sort(sides.begin(), sides.end(),
                     [](const Side& a, const Side& b) { return a.key() < b.key(); });
  for (std::size_t i = 0; i < sides.size();) {
    std::size_t end = i + 1;
    while (end < sides.size() && sides[end].low == sides[i].low && sides[end].high == sides[i].high) ++end;
    if (end - i == 1) {
      ++out.open_sides;
    } else if (end - i > 2) {
      ++out.shared_by_many;
    } else {
      const Side &a = sides[i], &b = sides[i + 1];
      if (a.place / 4 == b.place / 4) ++out.turned;
      out.of[a.triangle][a.place % 4] = b.triangle;
      out.of[b.triangle][b.place % 4] = a.triangle;
    }
    i = end;
  }
  return out;
}

}  // namespace fettle::engine
