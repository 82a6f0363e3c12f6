#include "engine/nominal/nominal_surface.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include <tbb/parallel_for.h>

#include "engine/compare/tile_sums.h"
#include "engine/field/builder.h"

namespace fettle::engine {

namespace {

// Twice the area of the triangle from p to q to a place, as seen from above: above 0 on the left of the side. The same
// number but for its sign from q to p, so that no place is on the outer side of both triangles of a side.
double sideOf(const glm::dvec3& p, const glm::dvec3& q, double x, double y) noexcept {
  const bool forward = p.x < q.x || (p.x == q.x && p.y < q.y);
  const glm::dvec3 &from = forward ? p : q, &to = forward ? q : p;
  const double area = (to.x - from.x) * (y - from.y) - (to.y - from.y) * (x - from.x);
  return forward ? area : -area;
}

// The height of a triangle over a place; NaN beside it.
double heightOver(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c, double x, double y,
                  double slack, bool& up) noexcept {
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  const double area = (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
  if (area == 0.0) return kNone;
  const double turn = area > 0.0 ? 1.0 : -1.0;
  const double of_c = turn * sideOf(a, b, x, y), of_a = turn * sideOf(b, c, x, y),
               of_b = turn * sideOf(c, a, x, y);
  const auto beside = [slack](double by, const glm::dvec3& p, const glm::dvec3& q) {
    return by < 0.0 && by < -slack * (std::abs(q.x - p.x) + std::abs(q.y - p.y));
  };
  if (beside(of_c, a, b) || beside(of_a, b, c) || beside(of_b, c, a)) return kNone;
  up = area > 0.0;
  const double z = a.z + (of_b * (b.z - a.z) + of_c * (c.z - a.z)) / std::abs(area);
  return std::clamp(z, std::min({a.z, b.z, c.z}), std::max({a.z, b.z, c.z}));
}

}  // namespace

NominalSurface::NominalSurface(const NominalMesh& mesh, const RigidMotion& motion, double slack)
    : mesh_(mesh), slack_(slack) {
  corners_.resize(mesh.corners().size());
  tbb::parallel_for(std::size_t{0}, corners_.size(),
                    [&](std::size_t i) { corners_[i] = motion.moved(mesh.corners()[i]); });
  nodes_ = mesh.tree().around([&](std::uint32_t i) {
    const TriangleIndices& t = mesh.triangles()[i];
    const glm::dvec3 &a = corners_[t[0]], &b = corners_[t[1]], &c = corners_[t[2]];
    return joinedBox(joinedBox({a, a}, {b, b}), {c, c});
  });
}

NominalSurface::Top NominalSurface::topAt(double x, double y) const noexcept {
  Top top;
  double highest = -std::numeric_limits<double>::infinity();
  std::array<std::uint32_t, TriangleTree::kMostDepth + 1>
      stack;  // NOLINT(cppcoreguidelines-pro-type-member-init)
  std::size_t waiting = 0;
  stack[waiting++] = 0;
  while (waiting > 0) {
    const std::uint32_t place = stack[--waiting];
    const TriangleTree::Node& node = nodes_[place];
    const Box& box = node.box;
    if (!(x >= box.low.x - slack_ && x <= box.high.x + slack_ && y >= box.low.y - slack_ &&
          y <= box.high.y + slack_ && box.high.z > highest))
      continue;
    if (node.leaf()) {
      for (std::uint32_t i = node.first; i < node.first + node.count; ++i) {
        const TriangleIndices& t = mesh_.triangles()[i];
        bool up = true;
        const double z = heightOver(corners_[t[0]], corners_[t[1]], corners_[t[2]], x, y, slack_, up);
        if (!(z > highest)) continue;
        highest = z;
        top = {z, up};
      }
      continue;
    }
    std::uint32_t lower = place + 1, upper = node.second();
    if (nodes_[lower].box.high.z > nodes_[upper].box.high.z) std::swap(lower, upper);
    stack[waiting++] = lower;
    stack[waiting++] = upper;
  }
  return top;
}

double slackOn(const Grid& grid) noexcept {
  const double world = std::max(std::abs(grid.origin_x), std::abs(grid.origin_y)) * grid.lateral_unit.mm;
  return std::max(1e-9 * std::min(grid.spacingXMm(), grid.spacingYMm()),
                  4.0 * std::numeric_limits<double>::epsilon() * world);
}

double slackOn(const Grid& grid, const NominalMesh& mesh) noexcept {
  constexpr double kDigits = 5e-7;
  const glm::dvec3 &low = mesh.box().low, &high = mesh.box().high, &corner = mesh.corner();
  double most = 0.0;
  for (const int axis : {0, 1})
    for (const double end : {low[axis], high[axis]}) most = std::max(most, std::abs(end + corner[axis]));
  return std::max(slackOn(grid),
                  std::min(kDigits * most, 0.01 * std::min(grid.spacingXMm(), grid.spacingYMm())));
}

Result<Version> nominalHeights(const NominalSurface& surface, const Grid& grid, JobControl& job) {
  Grid onto = grid;
  onto.height_per_count = 0.0;
  Result<FieldBuilder> builder = FieldBuilder::create(onto, "the nominal's heights");
  if (!builder) return tl::unexpected(builder.error());
  const TileRange tiles = allTiles(onto);
  const double sx = onto.spacingXMm(), sy = onto.spacingYMm(), unit = onto.height_unit.mm;
  job.begin("sampling the nominal", static_cast<std::uint64_t>(tiles.tiles()));
  tbb::parallel_for(std::int64_t{0}, tiles.tiles(), [&](std::int64_t i) {
    if (job.cancelled()) return;
    const auto column = static_cast<std::int32_t>(i % tiles.columns) * kTileSide,
               row = static_cast<std::int32_t>(i / tiles.columns) * kTileSide;
    const std::int32_t columns = std::min(kTileSide, onto.width - column),
                       rows = std::min(kTileSide, onto.height - row);
    float out[kTileSamples];
    for (std::int32_t r = 0; r < rows; ++r)
      for (std::int32_t c = 0; c < columns; ++c)
        out[r * kTileSide + c] =
            static_cast<float>(surface.topAt((column + c) * sx, (row + r) * sy).z / unit);
    builder->writeHeights(column, row, columns, rows, out, kTileSide);
    job.advance();
  });
  if (job.cancelled()) return cancelled();
  return std::move(*builder).build();
}

}  // namespace fettle::engine
