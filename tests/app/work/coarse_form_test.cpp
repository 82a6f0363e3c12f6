#include "app/work/coarse_form.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "engine/field/builder.h"
#include "engine/field/means.h"
#include "engine/measure/form_surface.h"

namespace fettle::app {
namespace {

// A bent ground with noise, 0.01 mm apart.
engine::Version bentField(int side) {
  engine::Grid grid;
  grid.width = grid.height = side;
  grid.spacing_x = grid.spacing_y = 0.01;
  std::vector<float> z;
  for (int r = 0; r < side; ++r)
    for (int c = 0; c < side; ++c) {
      const double x = static_cast<double>(c) / side, y = static_cast<double>(r) / side;
      const unsigned hash =
          (static_cast<unsigned>(c) * 2654435761U) ^ (static_cast<unsigned>(r) * 320717929U);
      z.push_back(static_cast<float>(3.0 * x - 2.0 * y + x * y + 0.1 * ((hash >> 9) % 1000) / 1000.0));
    }
  return engine::makeField(grid, z);
}

TEST(CoarseForm, is_near_the_form_of_all_samples_and_says_how_near) {
  const engine::Version field = bentField(2500);
  for (const engine::FormKind kind : {engine::FormKind::kPlane, engine::FormKind::kPolynomial3}) {
    engine::JobControl job;
    const engine::FormChoice choice{.kind = kind};
    const auto coarse = coarseForm(field, choice, job);
    ASSERT_TRUE(coarse) << coarse.error().line();
    EXPECT_EQ(coarse->step, 3);
    EXPECT_EQ(coarse->means.grid().width, 834);
    EXPECT_EQ(coarse->surface.grid().width, 834);
    const auto fit = engine::fitNominalForm(field, choice, job);
    ASSERT_TRUE(fit);
    const auto surface = engine::formSurface(field.grid(), fit->form, nullptr, job);
    ASSERT_TRUE(surface);
    double most = 0.0;
    for (int r = 0; r < 833; r += 7)
      for (int c = 0; c < 833; c += 7)
        most =
            std::max(most, std::abs(static_cast<double>(coarse->surface.reader().heightAt(c, r)) -
                                    static_cast<double>(surface->reader().heightAt(3 * c + 1, 3 * r + 1))));
    // The noise of a mean of 9 over a million of them, many times over.
    EXPECT_LT(most, 0.002);
    EXPECT_GT(coarse->off_rms, 0.0);
    EXPECT_LT(coarse->off_rms, 0.002);
    EXPECT_TRUE(coarseFormState(*coarse).starts_with("approximate, off by about "));
    EXPECT_TRUE(coarseFormState(*coarse).ends_with("m rms"));
  }
}

TEST(CoarseForm, is_for_large_fields_and_ends_when_cancelled) {
  engine::Grid grid;
  grid.width = grid.height = 1000;
  EXPECT_FALSE(formTakesLong(grid));
  grid.width = 10000;
  EXPECT_TRUE(formTakesLong(grid));
  engine::JobControl job;
  job.cancel();
  EXPECT_EQ(coarseForm(bentField(300), {}, job).error().kind, engine::ErrorKind::kCancelled);
}

TEST(CoarseForm, means_leave_holes_out_and_keep_the_sign) {
  engine::Grid grid;
  grid.width = 5;
  grid.height = 4;
  const float hole = std::nanf("");
  const engine::Version field =
      engine::makeField(grid, {1, 2, hole, hole, 7, 3, 6, hole, hole, 9, 0, 0, 1, 1, 2, 0, 4, 1, hole, 4},
                        {1, 1, 0, 0, 0, 0, 0, 0, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0, 0, 0});
  for (const bool inverted : {false, true}) {
    const engine::Version means = engine::meansOf(inverted ? field.inverted() : field, {0, 0, 5, 4}, 2);
    const engine::FieldReader reader = means.reader();
    const float sign = inverted ? -1.0F : 1.0F;
    EXPECT_EQ(reader.width(), 3);
    EXPECT_EQ(reader.height(), 2);
    EXPECT_EQ(reader.grid().spacing_x, 2.0);
    EXPECT_EQ(reader.sign(), sign);
    EXPECT_EQ(reader.heightAt(0, 0), sign * 3.0F);
    EXPECT_TRUE(std::isnan(reader.heightAt(1, 0)));
    EXPECT_EQ(reader.heightAt(2, 0), sign * 8.0F);
    EXPECT_EQ(reader.heightAt(0, 1), sign * 1.0F);
    EXPECT_EQ(reader.heightAt(1, 1), sign * 1.0F);
    EXPECT_TRUE(reader.markedAt(0, 0));
    EXPECT_FALSE(reader.markedAt(0, 1));
  }
}

}  // namespace
}  // namespace fettle::app
