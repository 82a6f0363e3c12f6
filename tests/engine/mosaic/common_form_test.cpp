// The form over a mosaic, of scans with a form over each.
#include "engine/mosaic/common_form.h"

#include <cstdint>
#include <memory>
#include <vector>

#include <gtest/gtest.h>

#include "engine/field/moved_form.h"
#include "tests/engine/mosaic/parts.h"

namespace fettle::engine {
namespace {

PolynomialForm bowl(std::int32_t width, std::int32_t height) {
  PolynomialForm form{2, width, height, 5.0, {0.1, -0.05, 0.2, 0.03, 0.02, 0.15}};
  return form;
}

Version levelOn(const Grid& grid) {
  return makeField(grid, std::vector<float>(static_cast<std::size_t>(grid.samples()), 5.0F));
}

FieldForm sharedForm(const NominalForm& form) {
  return std::make_shared<const NominalForm>(form);
}

// Two halves of one field with one form; the second is scanned elsewhere, turned by a quarter and lifted.
TEST(CommonForm, OfPiecesOfOneFieldIsItsForm) {
  const NominalForm whole = bowl(100, 60);
  const Grid left = gridFor(60, 60, 0.1, 0.1), right = gridFor(60, 60, 0.1, 0.1);
  const auto of_left = movedForm(whole, {}, 60, 60);
  // Columns of the right scan run along rows of the whole, from its corner at column 99: x' = y, y' = 9.9 - x.
  const auto of_right =
      movedForm(whole, {.first = {99.0, 0.0}, .per_column = {0.0, 1.0}, .per_row = {-1.0, 0.0}}, 60, 60);
  ASSERT_TRUE(of_left && of_right);
  PolynomialForm lifted = *of_right->polynomial();
  lifted.base -= 0.7;
  AdjustedPoses poses;
  RigidMotion turned;
  // (x, y) of the right scan to (9.9 - y, x): a quarter counter-clockwise.
  turned.rotation =
      glm::dmat3(glm::dvec3(0.0, 1.0, 0.0), glm::dvec3(-1.0, 0.0, 0.0), glm::dvec3(0.0, 0.0, 1.0));
  turned.shift = {9.9, 0.0, 0.7};
  poses.poses = {RigidMotion{}, turned};
  Grid grid = left;
  grid.width = 103;
  grid.height = 61;
  grid.origin_x -= 3 * grid.spacing_x;
  grid.origin_y -= grid.spacing_y;
  const std::vector<Version> scans{levelOn(left), levelOn(right)};
  const auto common = commonForm(scans, {sharedForm(*of_left), sharedForm(lifted)}, poses, grid);
  ASSERT_TRUE(common);
  EXPECT_LT(common->apart_mm, 1e-12);
  for (int r = 0; r < 60; r += 7)
    for (int c = 0; c < 100; c += 9)
      EXPECT_NEAR(common->form.heightAt(c + 3, r + 1), whole.heightAt(c, r), 1e-12);
  // Another bowl is as far off as it is.
  lifted.base += 0.25;
  const auto apart = commonForm(scans, {sharedForm(*of_left), sharedForm(lifted)}, poses, grid);
  ASSERT_TRUE(apart);
  EXPECT_NEAR(apart->apart_mm, 0.25, 1e-12);
  EXPECT_EQ(apart->farthest, 1U);
}

}  // namespace
}  // namespace fettle::engine
