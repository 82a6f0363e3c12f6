// Deviation from a nominal where it is known in closed form, and in the hard cases.

#include "engine/nominal/nominal_deviation.h"

#include <cmath>
#include <functional>
#include <limits>

#include <gtest/gtest.h>
#include <tbb/task_arena.h>

#include "engine/field/builder.h"
#include "engine/nominal/nominal_surface.h"
#include "tests/engine/nominal/meshes.h"

namespace fettle::engine {
namespace {

constexpr double kHole = std::numeric_limits<double>::quiet_NaN();

Grid partGrid(std::int32_t width, std::int32_t height, double sx, double sy) {
  Grid grid;
  grid.width = width;
  grid.height = height;
  grid.spacing_x = sx;
  grid.spacing_y = sy;
  return grid;
}

Version partOf(const Grid& grid, const std::function<double(double, double)>& z_mm) {
  std::vector<float> heights;
  for (int r = 0; r < grid.height; ++r)
    for (int c = 0; c < grid.width; ++c)
      heights.push_back(
          static_cast<float>(z_mm(c * grid.spacingXMm(), r * grid.spacingYMm()) / grid.height_unit.mm));
  return makeField(grid, heights);
}

NominalDeviation deviationOf(const Version& part, const NominalMesh& mesh,
                             const NominalOptions& options = {}) {
  JobControl job;
  const auto placed = placedAsStored(mesh, part.grid());
  EXPECT_TRUE(placed);
  auto found = deviationFromNominal(part, mesh, placed->motion, options, job);
  EXPECT_TRUE(found) << found.error().line();
  return *std::move(found);
}

double slope(double x, double y) {
  return 0.5 * x - 0.25 * y;
}

TEST(NominalDeviation, IsThatOfAPlaneInClosedForm) {
  // 0.2 above a plane along z, whose normal is (-0.5, 0.25, 1): 0.2 / sqrt(1.3125) across it. Spacing 1:4, heights in um,
  // 5e6 mm from zero.
  Grid grid = partGrid(81, 21, 0.125, 0.5);
  grid.height_unit = {"um", 1e-3};
  grid.origin_x = 5e6;
  grid.origin_y = -5e6;
  const NominalMesh mesh = meshOf(surfaceOver(12, 12, 7, 5, slope, 5e6 - 1.0, -5e6 - 1.0));
  const Version part = partOf(grid, [](double x, double y) {
    // The mesh begins 1 mm lower left of the part. One hole.
    return x == 1.0 && y == 1.0 ? kHole : slope(x + 1.0, y + 1.0) + 0.2;
  });
  for (const NominalDistance distance : {NominalDistance::kVertical, NominalDistance::kShortest}) {
    const double expected = distance == NominalDistance::kVertical ? 200.0 : 200.0 / std::sqrt(1.3125);
    NominalOptions options;
    options.distance = distance;
    options.tolerance = 190.0;
    const NominalDeviation found = deviationOf(part, mesh, options);
    EXPECT_EQ(found.samples, grid.samples() - 1);
    EXPECT_EQ(found.unmeasured, 1);
    EXPECT_EQ(found.no_nominal, 0);
    // Heights to 6000 um as float round to 2.4e-4 um, places at 5e6 mm to 1e-9 mm.
    for (const double figure : {found.mean, found.rms, found.min, found.max, found.max_abs, found.p99})
      EXPECT_NEAR(figure, expected, 5e-4);
    EXPECT_EQ(found.above, distance == NominalDistance::kVertical ? found.samples : 0);
    EXPECT_EQ(found.within, distance == NominalDistance::kVertical ? 0 : found.samples);
    EXPECT_EQ(found.below, 0);
    EXPECT_EQ(found.face_down, 0);
    EXPECT_FALSE(found.turned);
    EXPECT_EQ(found.field.grid().height_unit.name, "um");
    EXPECT_TRUE(std::isnan(found.field.reader().heightAt(8, 2)));
  }
  // Wound the other way round the same, and said.
  NominalOptions options;
  options.distance = NominalDistance::kShortest;
  const NominalDeviation turned = deviationOf(
      part, meshOf(turnedRound(surfaceOver(12, 12, 7, 5, slope, 5e6 - 1.0, -5e6 - 1.0))), options);
  EXPECT_TRUE(turned.turned);
  EXPECT_EQ(turned.face_down, 0);
  EXPECT_NEAR(turned.mean, 200.0 / std::sqrt(1.3125), 5e-4);
}

TEST(NominalDeviation, OfASphereIsThatOfTheSphere) {
  const NominalMesh mesh = meshOf(sphereOf({5, 5, 0}, 4.0, 200));
  // A part 0.05 mm larger than nominal, seen from above to 60 degrees.
  const Grid grid = partGrid(71, 71, 0.1, 0.1);
  const Version part = partOf(grid, [](double x, double y) {
    const double square = 4.05 * 4.05 - (x - 3.5) * (x - 3.5) - (y - 3.5) * (y - 3.5);
    return square > 4.0 ? std::sqrt(square) : kHole;
  });
  JobControl job;
  RigidMotion motion;
  motion.shift = {-0.5, -0.5, 0.0};  // the mesh begins at (1, 1): its middle at (4, 4) of its own
  NominalOptions options;
  options.distance = NominalDistance::kShortest;
  const auto found = deviationFromNominal(part, mesh, motion, options, job);
  ASSERT_TRUE(found);
  EXPECT_GT(found->samples, 3000);
  EXPECT_EQ(found->no_nominal, 0);
  // Flat triangles lie 4 (1 - cos(pi / 400)) inside along each of two directions.
  const double flat = 2.0 * 4.0 * (1.0 - std::cos(std::numbers::pi / 400.0));
  EXPECT_GE(found->min, 0.05 - 1e-6);
  EXPECT_LE(found->max, 0.05 + flat + 1e-6);
  // Along z it is up to twice as much at 60 degrees.
  const auto vertical = deviationFromNominal(part, mesh, motion, {}, job);
  ASSERT_TRUE(vertical);
  EXPECT_GT(vertical->max, 0.09);
}

TEST(PlacedNominal, IsWhereTheFilesPlaceBothWhateverTheUnitOfThePartIs) {
  // A part of 10 x 5 mm at (300, -200) mm, stated in micrometres; the mesh is in millimetres.
  Grid grid = partGrid(101, 51, 100.0, 100.0);
  grid.lateral_unit = {"um", 1e-3};
  grid.origin_x = 300'000.0;
  grid.origin_y = -200'000.0;
  const NominalMesh mesh = meshOf(surfaceOver(12, 12, 5, 5, slope, 299.0, -202.5));
  const auto placed = placedAsStored(mesh, grid);
  ASSERT_TRUE(placed);
  EXPECT_EQ(placed->place, NominalPlace::kWorld);
  EXPECT_NEAR(placed->motion.shift.x, -1.0, 1e-9);
  EXPECT_NEAR(placed->motion.shift.y, -2.5, 1e-9);
}

TEST(NominalHeights, AreSeenToComeTileByTile) {
  const NominalMesh mesh = meshOf(surfaceOver(5, 5, 5, 5, [](double, double) { return 1.0; }));
  JobControl job;
  const auto heights = nominalHeights(NominalSurface(mesh, {}, 0.0), partGrid(130, 70, 0.03, 0.05), job);
  ASSERT_TRUE(heights);
  EXPECT_STREQ(job.stage(), "sampling the nominal");
  EXPECT_EQ(job.total(), 6U);
  EXPECT_EQ(job.done(), job.total());
}

TEST(NominalDeviation, CountsWhatHasNoNominal) {
  // The nominal covers the lower left quarter; a ring with nothing in its middle.
  Triangles triangles = surfaceOver(5, 5, 5, 5, [](double, double) { return 1.0; });
  triangles.erase(triangles.begin() + 24, triangles.begin() + 26);  // the cell 2 .. 3 of both
  const NominalMesh mesh = meshOf(triangles);
  const Grid grid = partGrid(101, 101, 0.1, 0.1);
  for (const NominalDistance distance : {NominalDistance::kVertical, NominalDistance::kShortest}) {
    NominalOptions options;
    options.distance = distance;
    const NominalDeviation found =
        deviationOf(partOf(grid, [](double, double) { return 3.0; }), mesh, options);
    // 51 x 51 samples on it, borders too, less 9 x 9 in the gap.
    EXPECT_EQ(found.samples, 51 * 51 - 81);
    EXPECT_EQ(found.no_nominal, 101 * 101 - found.samples);
    EXPECT_EQ(found.min, 2.0);
    EXPECT_EQ(found.max, 2.0);
  }
}

TEST(NominalDeviation, BordersOfAMeshInFloatsHaveTheirSamples) {
  // 250 spacings of 1/2.2 mm: as floats the last corners lie up to 4e-6 mm inside of the part's samples.
  Triangles triangles = surfaceOver(250 / 2.2, 3 / 2.2, 250, 3, [](double, double) { return 1.0; });
  for (auto& triangle : triangles)
    for (auto& corner : triangle)
      for (int axis = 0; axis < 3; ++axis)
        corner[axis] = static_cast<double>(static_cast<float>(corner[axis]));
  const NominalDeviation found = deviationOf(
      partOf(partGrid(251, 4, 1 / 2.2, 1 / 2.2), [](double, double) { return 3.0; }), meshOf(triangles));
  EXPECT_EQ(found.no_nominal, 0);
  EXPECT_EQ(found.samples, 251 * 4);
}

TEST(NominalDeviation, MeetsTheHardCases) {
  const NominalMesh flat = meshOf(surfaceOver(10, 10, 1, 1, [](double, double) { return 0.0; }));
  const Grid grid = partGrid(33, 17, 0.3, 0.5);
  // All holes: counted, no figure.
  const NominalDeviation holes = deviationOf(partOf(grid, [](double, double) { return kHole; }), flat);
  EXPECT_EQ(holes.samples, 0);
  EXPECT_EQ(holes.unmeasured, grid.samples());
  EXPECT_TRUE(std::isnan(holes.rms));
  // One row, one sample.
  for (const auto& [w, h] : {std::pair{20, 1}, {1, 20}, {1, 1}}) {
    const NominalDeviation row =
        deviationOf(partOf(partGrid(w, h, 0.5, 0.5), [](double x, double) { return x; }), flat);
    EXPECT_EQ(row.samples, std::int64_t{w} * h);
    EXPECT_EQ(row.max, 0.5 * (w - 1));
  }
  // Flat on flat, spikes of 1e6, denormals.
  const NominalDeviation spikes = deviationOf(
      partOf(grid, [](double x, double y) { return x == 0.0 && y == 0.0 ? 1e6
                                                   : x == 0.3           ? 1e-40
                                                                        : 0.0; }),
      flat);
  EXPECT_EQ(spikes.max, 1e6);
  EXPECT_EQ(spikes.min, 0.0);
  EXPECT_EQ(spikes.samples, grid.samples());
  NominalOptions shortest;
  shortest.distance = NominalDistance::kShortest;
  EXPECT_EQ(
      deviationOf(partOf(grid, [](double x, double y) { return x + y == 0.0 ? -1e6 : 0.0; }), flat, shortest)
          .min,
      -1e6);
  // A tolerance below 0, a part and a nominal apart.
  JobControl job;
  NominalOptions below;
  below.tolerance = -1.0;
  EXPECT_FALSE(deviationFromNominal(partOf(grid, slope), flat, {}, below, job));
  Grid far = grid;
  far.origin_x = 30.0;
  const auto placed = placedAsStored(flat, far);
  ASSERT_TRUE(placed);
  EXPECT_EQ(placed->place, NominalPlace::kFromCorner);
  EXPECT_FALSE(placedAsStored(meshOf(surfaceOver(
                                  10, 10, 1, 1, [](double, double) { return 0.0; }, 50.0, 0.0)),
                              grid));
}

TEST(NominalDeviation, IsTheSameForAnyNumberOfThreadsAndHonoursTheSign) {
  const auto waves = [](double x, double y) { return std::sin(3.0 * x) * std::cos(2.0 * y); };
  const Grid grid = partGrid(301, 201, 0.03, 0.05);
  const Version part =
      partOf(grid, [&](double x, double y) { return waves(x, y) + 0.1 * std::sin(9.0 * x); });
  std::vector<std::uint64_t> hashes;
  std::vector<double> means;
  for (const int threads : {1, 2, 7}) {
    tbb::task_arena arena(threads);
    arena.execute([&] {
      const NominalMesh mesh = meshOf(surfaceOver(9, 10, 90, 80, waves));
      NominalOptions options;
      options.distance = NominalDistance::kShortest;
      const NominalDeviation found = deviationOf(part, mesh, options);
      hashes.push_back(contentHash(found.field));
      means.push_back(found.mean);
    });
  }
  for (const std::uint64_t hash : hashes) EXPECT_EQ(hash, hashes[0]);
  for (const double mean : means) EXPECT_EQ(mean, means[0]);
}

}  // namespace
}  // namespace fettle::engine
