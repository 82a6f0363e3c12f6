#include "engine/nominal/nominal_mesh.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <limits>
#include <new>
#include <utility>

#include <fmt/format.h>
#include <glm/geometric.hpp>

namespace fettle::engine {

namespace {

// Of a triangle: its corners 0 .. 2, its sides 3 .. 5 (from corner k to the next), its face.
constexpr int kSides = 3, kFace = 6;

struct NearestPlace {
  double square = std::numeric_limits<double>::infinity();
  glm::dvec3 place{0.0};
  int feature = kFace;
};

// The nearest place of a segment.
NearestPlace nearestOnSide(const glm::dvec3& p, const glm::dvec3& from, const glm::dvec3& to,
                           int k) noexcept {
  const glm::dvec3 along = to - from;
  const double t = glm::dot(p - from, along) / glm::dot(along, along);
  NearestPlace near;
  near.feature = !(t > 0.0) ? k : t < 1.0 ? kSides + k : (k + 1) % 3;
  near.place = near.feature == k ? from : t < 1.0 ? from + t * along : to;
  const glm::dvec3 off = p - near.place;
  near.square = glm::dot(off, off);
  return near;
}

// The nearest place of a triangle: the foot of the plane's normal where that lies in the triangle, else on a side. The
// test of the foot takes the triangle's own normal, so that slivers lose no digit (compare C. Ericson, Real-Time
// Collision Detection, 2005, section 5.1.5, whose products of four lengths cancel).
NearestPlace nearestOn(const glm::dvec3& p, const TriangleCorners& t) noexcept {
  const glm::dvec3 normal = areaNormal(t[0], t[1], t[2]);
  const double square = glm::dot(normal, normal);
  bool inside = true;
  for (std::size_t k = 0; k < 3; ++k)
    inside = inside && glm::dot(glm::cross(t[(k + 1) % 3] - t[k], p - t[k]), normal) >= 0.0;
  if (inside) {
    const double above = glm::dot(p - t[0], normal);
    return {above * above / square, p - (above / square) * normal, kFace};
  }
  NearestPlace best;
  for (int k = 0; k < 3; ++k) {
    const NearestPlace near =
        nearestOnSide(p, t[static_cast<std::size_t>(k)], t[static_cast<std::size_t>((k + 1) % 3)], k);
    if (near.square < best.square) best = near;
  }
  return best;
}

double squareTo(const Box& box, const glm::dvec3& p) noexcept {
  double square = 0.0;
  for (int k = 0; k < 3; ++k) {
    const double off = std::max({box.low[k] - p[k], p[k] - box.high[k], 0.0});
    square += off * off;
  }
  return square;
}

// Of a length of 1; 0 stays.
glm::dvec3 unitOf(const glm::dvec3& v) noexcept {
  const double length = glm::length(v);
  return length > 0.0 ? v / length : v;
}

}  // namespace

Result<NominalMesh> NominalMesh::create(std::vector<TriangleCorners> triangles, const std::string& where,
                                        JobControl& job) try {
  constexpr std::size_t kMost = std::size_t{1} << 30;
  if (triangles.size() > kMost)
    return inputError(
        fmt::format("a nominal of {} triangles is more than the 2^30 that are supported", triangles.size()),
        where, "export the mesh with a larger tolerance");
  NominalMesh mesh;
  if (!triangles.empty()) mesh.corner_ = glm::dvec3(triangles[0][0].x, triangles[0][0].y, 0.0);
  for (const TriangleCorners& t : triangles)
    for (const glm::dvec3& p : t) {
      assert(std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z));
      mesh.corner_.x = std::min(mesh.corner_.x, p.x);
      mesh.corner_.y = std::min(mesh.corner_.y, p.y);
    }
  for (TriangleCorners& t : triangles)
    for (glm::dvec3& p : t) p = p - mesh.corner_ + 0.0;  // -0 becomes 0: equal places have equal bits
  MeshTopology topology = joinedCorners(std::move(triangles));
  if (topology.triangles.empty())
    return inputError("the mesh holds no triangle that has an area", where, "is this a mesh of a surface?");
  if (job.cancelled()) return cancelled();
  mesh.corners_ = std::move(topology.corners);
  mesh.without_area_ = topology.without_area;
  std::vector<Box> boxes;
  boxes.reserve(topology.triangles.size());
  for (const TriangleIndices& t : topology.triangles) {
    const glm::dvec3 &a = mesh.corners_[t[0]], &b = mesh.corners_[t[1]], &c = mesh.corners_[t[2]];
    boxes.push_back(joinedBox(joinedBox({a, a}, {b, b}), {c, c}));
  }
  mesh.tree_ = TriangleTree(boxes, job);
  if (job.cancelled()) return cancelled();
  mesh.triangles_.reserve(boxes.size());
  for (const std::uint32_t i : mesh.tree_.order()) mesh.triangles_.push_back(topology.triangles[i]);
  mesh.neighbours_ = neighboursOf(mesh.triangles_);
  mesh.makeNormals();
  return mesh;
} catch (const std::bad_alloc&) {
  return failure("memory is exhausted", where, "export the mesh with a larger tolerance");
}

void NominalMesh::makeNormals() {
  corner_normals_.assign(corners_.size(), glm::dvec3(0.0));
  for (const TriangleIndices& t : triangles_) {
    const glm::dvec3 normal = unitOf(areaNormal(corners_[t[0]], corners_[t[1]], corners_[t[2]]));
    for (std::size_t k = 0; k < 3; ++k) {
      const glm::dvec3 u = corners_[t[(k + 1) % 3]] - corners_[t[k]],
                       v = corners_[t[(k + 2) % 3]] - corners_[t[k]];
      // Its angle there, also where it is small or nearly flat.
      corner_normals_[t[k]] += std::atan2(glm::length(glm::cross(u, v)), glm::dot(u, v)) * normal;
    }
  }
}

glm::dvec3 NominalMesh::normalAt(std::uint32_t triangle, int feature) const noexcept {
  const TriangleIndices& t = triangles_[triangle];
  if (feature < kSides) return corner_normals_[t[static_cast<std::size_t>(feature)]];
  const auto normalOf = [this](const TriangleIndices& of) {
    return unitOf(areaNormal(corners_[of[0]], corners_[of[1]], corners_[of[2]]));
  };
  const glm::dvec3 own = normalOf(t);
  if (feature == kFace) return own;
  const std::uint32_t other = neighbours_.of[triangle][static_cast<std::size_t>(feature - kSides)];
  return other == kNoTriangle ? own : own + normalOf(triangles_[other]);
}

std::optional<double> NominalMesh::distanceTo(const glm::dvec3& point, double most) const noexcept {
  struct Waiting {
    std::uint32_t node;
    double square;
  };
  std::array<Waiting, TriangleTree::kMostDepth + 1> stack;  // NOLINT(cppcoreguidelines-pro-type-member-init)
  std::size_t waiting = 0;
  const std::vector<TriangleTree::Node>& nodes = tree_.nodes();
  NearestPlace best;
  best.square = most * most;
  std::uint32_t nearest = kNoTriangle;
  stack[waiting++] = {0, squareTo(nodes[0].box, point)};
  while (waiting > 0) {
    const Waiting next = stack[--waiting];
    if (!(next.square < best.square)) continue;
    const TriangleTree::Node& node = nodes[next.node];
    if (node.leaf()) {
      for (std::uint32_t i = node.first; i < node.first + node.count; ++i) {
        const TriangleIndices& t = triangles_[i];
        const NearestPlace near = nearestOn(point, {corners_[t[0]], corners_[t[1]], corners_[t[2]]});
        if (!(near.square < best.square)) continue;
        best = near;
        nearest = i;
      }
      continue;
    }
    Waiting one{next.node + 1, squareTo(nodes[next.node + 1].box, point)},
        two{node.second(), squareTo(nodes[node.second()].box, point)};
    if (one.square < two.square) std::swap(one, two);
    stack[waiting++] = one;
    stack[waiting++] = two;
  }
  if (nearest == kNoTriangle) return std::nullopt;
  const double distance = std::sqrt(best.square);
  return glm::dot(point - best.place, normalAt(nearest, best.feature)) < 0.0 ? -distance : distance;
}

}  // namespace fettle::engine
