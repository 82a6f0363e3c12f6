#include "app/files/scan_thumbnail.h"

#include <cmath>
#include <fstream>
#include <limits>
#include <thread>

#include <gtest/gtest.h>

#include "app/files/thumbnail_shelf.h"
#include "engine/field/builder.h"
#include "engine/formats/formats.h"
#include "tests/support/temp_folder.h"

namespace fettle::app {
namespace {

engine::Version fieldOf(std::int32_t width, std::int32_t height, const auto& z, double spacing_y = 1.0) {
  engine::Grid grid;
  grid.width = width;
  grid.height = height;
  grid.spacing_y = spacing_y;
  auto builder = engine::FieldBuilder::create(grid, "test");
  std::vector<float> row(static_cast<std::size_t>(width));
  for (std::int32_t r = 0; r < height; ++r) {
    for (std::int32_t c = 0; c < width; ++c) row[static_cast<std::size_t>(c)] = static_cast<float>(z(c, r));
    builder->writeHeights(0, r, width, 1, row.data(), width);
  }
  return std::move(*builder).build();
}

constexpr double kHole = std::numeric_limits<double>::quiet_NaN();

TEST(ScanThumbnail, is_the_mean_of_its_samples_with_the_highest_row_on_top) {
  const ScanThumbnail picture = thumbnailOf(fieldOf(64, 32, [](int, int r) { return r; }), 16);
  ASSERT_EQ(picture.width, 16);
  ASSERT_EQ(picture.height, 8);
  for (int y = 0; y < 8; ++y)
    for (int x = 0; x < 16; ++x)
      EXPECT_FLOAT_EQ(picture.heights[static_cast<std::size_t>(16 * y + x)],
                      4.0F * static_cast<float>(7 - y) + 1.5F);
}

TEST(ScanThumbnail, has_the_proportions_of_the_scan_in_millimetres_and_at_least_a_line) {
  const ScanThumbnail square = thumbnailOf(fieldOf(
                                               40, 10, [](int c, int) { return c; }, 4.0),
                                           20);
  EXPECT_EQ(square.width, 20);
  EXPECT_EQ(square.height, 10) << "no more pixels than rows";
  const ScanThumbnail line = thumbnailOf(fieldOf(4000, 1, [](int c, int) { return c; }), 20);
  EXPECT_EQ(line.width, 20);
  EXPECT_EQ(line.height, 1);
  const ScanThumbnail one = thumbnailOf(fieldOf(1, 1, [](int, int) { return 1.0; }), 20);
  EXPECT_EQ(one.colours.size(), 1U);
}

TEST(ScanThumbnail, leaves_holes_out_and_stands_fields_without_heights_spikes_and_denormals) {
  const ScanThumbnail holed = thumbnailOf(fieldOf(8, 8, [](int c, int) { return c < 4 ? kHole : 2.0; }), 8);
  EXPECT_EQ(holed.colours[0], 0U);
  EXPECT_NE(holed.colours[7], 0U);
  EXPECT_TRUE(std::isnan(holed.heights[0]));
  EXPECT_FLOAT_EQ(holed.heights[7], 2.0F);
  const ScanThumbnail nothing = thumbnailOf(fieldOf(8, 8, [](int, int) { return kHole; }), 8);
  EXPECT_EQ(std::count(nothing.colours.begin(), nothing.colours.end(), 0U), 64);
  for (const double high : {1e6, 3e38, 1e-42}) {
    const ScanThumbnail spike =
        thumbnailOf(fieldOf(8, 8, [&](int c, int r) { return c == 4 && r == 4 ? high : 0.0; }), 8);
    for (const std::uint32_t colour : spike.colours) EXPECT_EQ(colour >> 24, 0xFFU) << high;
  }
}

TEST(ScanThumbnail, is_lit_from_the_upper_left) {
  // A roof with its ridge from the lower left to the upper right: samples (c, r) and (r, c) are as high as each other.
  const ScanThumbnail roof = thumbnailOf(fieldOf(32, 32, [](int c, int r) { return -std::abs(c - r); }), 32);
  const auto brightness = [&](int c, int r) {
    const std::uint32_t colour = roof.colours[static_cast<std::size_t>(32 * (31 - r) + c)];
    return (colour & 0xFFU) + ((colour >> 8) & 0xFFU) + ((colour >> 16) & 0xFFU);
  };
  for (int i = 8; i < 28; ++i) EXPECT_GT(brightness(4, i), brightness(i, 4)) << i;
}

TEST(ScanThumbnail, of_a_file_says_what_was_guessed_and_which_number_may_be_a_hole) {
  const tests::TempFolder folder;
  const std::string path = folder.file("scan.asc");
  std::ofstream file(path);
  file << "ncols 64\nnrows 64\nxllcenter 0\nyllcenter 0\ncellsize 1\n";
  for (int r = 0; r < 64; ++r) {
    for (int c = 0; c < 64; ++c) file << (c < 8 ? 9999.0 : 0.01 * ((7 * c + 13 * r) % 29)) << " ";
    file << "\n";
  }
  file.close();
  engine::JobControl job;
  const auto picture = readThumbnail(path, {}, 32, job);
  ASSERT_TRUE(picture) << picture.error().line();
  EXPECT_TRUE(picture->whole);
  EXPECT_FALSE(picture->warnings.empty());
  ASSERT_EQ(picture->lone_values.size(), 1U);
  EXPECT_EQ(picture->lone_values[0], (engine::LoneValue{9999.0F, 9999.0F}));
  engine::ImportOptions scaled;
  scaled.z_scale = 0.5;
  const auto halved = readThumbnail(path, scaled, 32, job);
  ASSERT_TRUE(halved);
  ASSERT_EQ(halved->lone_values.size(), 1U);
  EXPECT_EQ(halved->lone_values[0].number, 9999.0F) << "as stored";
  engine::ImportOptions holes;
  holes.no_data = 9999.0;
  const auto clean = readThumbnail(path, holes, 32, job);
  ASSERT_TRUE(clean);
  EXPECT_EQ(clean->colours[0], 0U);
  EXPECT_GE(clean->low, 0.0F);
  EXPECT_FALSE(readThumbnail(folder.file("gone.tif"), {}, 32, job));
}

TEST(ThumbnailShelf, reads_one_after_the_other_and_keeps_problems_too) {
  const tests::TempFolder folder;
  engine::JobControl job;
  const engine::Version field = fieldOf(16, 16, [](int c, int) { return c; });
  for (const char* name : {"a.tif", "b.tif"})
    ASSERT_TRUE(engine::exportField(field, folder.file(name), {}, job));
  std::ofstream(folder.file("broken.tif")) << "no picture";
  ThumbnailShelf shelf;
  const auto wait = [&](const std::string& path) {
    for (;;) {
      const ThumbnailShelf::Shown shown = shelf.find(path, {});
      if (shown.picture != nullptr || shown.problem != nullptr) return shown;
      (void)shelf.poll();
      std::this_thread::yield();
    }
  };
  EXPECT_NE(wait(folder.file("a.tif")).picture, nullptr);
  EXPECT_NE(wait(folder.file("broken.tif")).problem, nullptr);
  EXPECT_NE(wait(folder.file("b.tif")).picture, nullptr);
  EXPECT_FALSE(shelf.busy());
  EXPECT_NE(shelf.find(folder.file("a.tif"), {}).picture, nullptr) << "kept";
  ScanOptions scaled;
  scaled.z_scale = 3.0;
  EXPECT_EQ(shelf.find(folder.file("a.tif"), scaled).picture, nullptr)
      << "another reading is another picture";
  shelf.forget();
  while (shelf.busy()) (void)shelf.poll();
  EXPECT_EQ(shelf.find(folder.file("b.tif"), {}).picture, nullptr);
}

}  // namespace
}  // namespace fettle::app
