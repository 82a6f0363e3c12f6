// Fields under a form at other places: what is seen of them is what is seen, moved.
#include "engine/transform/form_along.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <memory>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "engine/field/builder.h"
#include "engine/field/seen_field.h"
#include "engine/transform/rearrange.h"
#include "engine/transform/resample.h"
#include "tests/support/shape_forms.h"

namespace fettle::engine {
namespace {

// Waves of 5 um about a level of 20 mm, with holes and marks.
Version formedScan(std::int32_t width, std::int32_t height) {
  Grid grid;
  grid.width = width;
  grid.height = height;
  grid.spacing_x = 0.1;
  grid.spacing_y = 0.08;
  std::mt19937 random(5);
  std::vector<float> z;
  std::vector<std::uint8_t> marks;
  for (int r = 0; r < height; ++r)
    for (int c = 0; c < width; ++c) {
      const bool hole = random() % 23 == 0;
      z.push_back(hole ? std::numeric_limits<float>::quiet_NaN()
                       : static_cast<float>(20.0 + 0.005 * std::sin(0.3 * c) * std::cos(0.2 * r)));
      marks.push_back(random() % 9 == 0);
    }
  return makeField(grid, z, marks);
}

std::vector<NominalForm> formsOver(const Grid& grid) {
  std::mt19937 random(3);
  PolynomialForm polynomial{4, grid.width, grid.height, 19.0, {}};
  for (int k = 0; k < PolynomialForm::terms(4); ++k)
    polynomial.coefficients.push_back(static_cast<double>(random() % 1000) * 1e-3 - 0.5);
  ShapeForm sphere;
  sphere.width = grid.width;
  sphere.height = grid.height;
  sphere.spacing_x_mm = grid.spacingXMm();
  sphere.spacing_y_mm = grid.spacingYMm();
  sphere.column = 40.0;
  sphere.row = 10.0;
  sphere.base = 20.0;
  sphere.curvature = -1.0 / 60.0;
  ShapeForm cylinder = sphere;
  cylinder.shape = FormShape::kCylinder;
  cylinder.axis = glm::normalize(glm::dvec3(1.0, 0.4, 0.0));
  return {polynomial, sphere, cylinder};
}

Version seenUnderForm(const Version& field) {
  JobControl job;
  return SeenField::of(field, job)->seen();
}

// Heights and marks; heights within `bound`.
void expectSame(const Version& a, const Version& b, double bound) {
  ASSERT_EQ(a.grid().width, b.grid().width);
  ASSERT_EQ(a.grid().height, b.grid().height);
  for (int r = 0; r < a.grid().height; ++r)
    for (int c = 0; c < a.grid().width; ++c) {
      const float x = a.reader().heightAt(c, r), y = b.reader().heightAt(c, r);
      ASSERT_EQ(std::isnan(x), std::isnan(y)) << c << ' ' << r;
      if (!std::isnan(x)) {
        ASSERT_LE(std::abs(double{x} - y), bound) << c << ' ' << r;
      }
      ASSERT_EQ(a.reader().markedAt(c, r), b.reader().markedAt(c, r));
    }
}

// A form that was computed otherwise may be rounded to the float beside; what is seen is below 16 mm.
constexpr double kNeighbour = 0x1p-20;

TEST(FormAlong, WhatIsSeenOfACropOrATurnIsWhatWasSeenMoved) {
  JobControl job;
  const Version plain = formedScan(150, 100);
  for (const NominalForm& over : formsOver(plain.grid()))
    for (const bool upside_down : {false, true}) {
      const Version up = plain.withForm(std::make_shared<const NominalForm>(over));
      const Version seen = seenUnderForm(upside_down ? up.inverted() : up);
      const Version samples = upside_down ? plain.inverted() : plain;
      const SampleRect rect{70, 31, 80, 60};
      const auto piece = cropped(seen, rect, job);
      ASSERT_TRUE(piece);
      ASSERT_NE(piece->seenOf(), nullptr);
      expectSame(*piece, *cropped(seen.withSeenOf(nullptr), rect, job), kNeighbour);
      EXPECT_EQ(contentHash(*withoutLayer(*piece, job)), contentHash(*cropped(samples, rect, job)));
      for (int k = 1; k < 16; ++k) {
        const Turning turning{(k & 1) != 0, (k & 2) != 0, k / 4};
        const auto moved = turned(seen, turning, job);
        ASSERT_TRUE(moved);
        ASSERT_NE(moved->seenOf(), nullptr);
        expectSame(*moved, *turned(seen.withSeenOf(nullptr), turning, job), kNeighbour);
        EXPECT_EQ(contentHash(*withoutLayer(*moved, job)), contentHash(*turned(samples, turning, job)));
      }
    }
}

TEST(FormAlong, WhatIsSeenOfNewSamplesIsWhatWasSeenResampled) {
  JobControl job;
  const Version plain = formedScan(150, 100);
  for (const NominalForm& over : formsOver(plain.grid()))
    for (const Resampling method : {Resampling::kArea, Resampling::kLinear, Resampling::kCubic})
      for (const double angle : {0.0, 17.0, -140.0}) {
        const Version seen = seenUnderForm(plain.withForm(std::make_shared<const NominalForm>(over)));
        const ResampleOptions options{method, angle, 0.17, 0.12};
        const auto moved = resampled(seen, options, job);
        ASSERT_TRUE(moved);
        ASSERT_NE(moved->seenOf(), nullptr);
        // Samples of up to 32 mm were rounded on the way.
        expectSame(*moved, *resampled(seen.withSeenOf(nullptr), options, job), 2.0 * kNeighbour);
        // The samples, on the other hand, are those of the form at its new places.
        const auto stored = withoutLayer(*moved, job);
        ASSERT_TRUE(stored);
        for (int r = 0; r < stored->grid().height; r += 7)
          for (int c = 0; c < stored->grid().width; c += 7) {
            const float z = stored->reader().heightAt(c, r);
            if (!std::isnan(z)) {
              ASSERT_NEAR(z, double{moved->reader().heightAt(c, r)} + moved->seenOf()->form()->heightAt(c, r),
                          0x1p-19);
            }
          }
      }
}

// The sphere's own heights, seen as nothing, are nothing at any spacing: resampled without the form they are off by how it bends.
TEST(FormAlong, AFormBendsNothingBetweenSamples) {
  JobControl job;
  const Version plain = formedScan(150, 100);
  const NominalForm sphere = formsOver(plain.grid())[1];
  std::vector<float> z;
  for (int r = 0; r < 100; ++r)
    for (int c = 0; c < 150; ++c) z.push_back(static_cast<float>(sphere.heightAt(c, r)));
  const Version ball = makeField(plain.grid(), z);
  const ResampleOptions coarse{Resampling::kArea, 0.0, 1.0, 1.0};
  const auto seen =
      resampled(seenUnderForm(ball.withForm(std::make_shared<const NominalForm>(sphere))), coarse, job);
  const auto bent = resampled(ball, coarse, job);
  ASSERT_TRUE(seen && bent);
  // The mean over 1 x 1 mm of a ball of 60 mm is 2 x 1 / 24 / 60 mm below its top, where it is level.
  double most = 0.0;
  const NominalForm& at = *seen->seenOf()->form();
  for (int r = 0; r < seen->grid().height; ++r)
    for (int c = 0; c < seen->grid().width; ++c) {
      EXPECT_NEAR(seen->reader().heightAt(c, r), 0.0, 0x1p-19);
      most = std::max(most, at.heightAt(c, r) - bent->reader().heightAt(c, r));
    }
  EXPECT_NEAR(most, 2.0 / 24.0 / 60.0, 0.2 * 2.0 / 24.0 / 60.0);
}

TEST(FormAlong, AFormWithoutAPlaceIsLeftOutAndNoSampleWithIt) {
  JobControl job;
  const Version plain = formedScan(150, 100);
  NominalForm over = formsOver(plain.grid())[1];
  ShapeForm wrong = *over.shape();
  wrong.spacing_x_mm *= 2.0;  // as of a session that is read with another spacing
  const Version seen = seenUnderForm(plain.withForm(std::make_shared<const NominalForm>(NominalForm(wrong))));
  const ResampleOptions options{Resampling::kCubic, 30.0, 0.1, 0.1};
  const auto moved = resampled(seen, options, job);
  ASSERT_TRUE(moved);
  EXPECT_EQ(moved->seenOf(), nullptr);
  EXPECT_EQ(contentHash(*moved), contentHash(*resampled(plain, options, job)));
}

}  // namespace
}  // namespace fettle::engine
