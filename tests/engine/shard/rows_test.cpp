// Rows of a file, and figures of a field by its rows, are those of the whole.
#include <cmath>
#include <string>

#include <gtest/gtest.h>

#include "engine/field/piece.h"
#include "engine/field/tile.h"
#include "engine/formats/formats.h"
#include "engine/inspect/noise.h"
#include "tests/engine/shard/shard_field.h"
#include "tests/support/temp_folder.h"

namespace fettle::engine {
namespace {

TEST(ImportRows, gives_the_samples_and_the_place_of_the_whole_import_in_every_format) {
  const tests::TempFolder folder;
  const Version field = tests::hardField(300, 500);
  JobControl job;
  ExportOptions packed;
  packed.tiff_compression = TiffCompression::kDeflate;
  ExportOptions zstd;
  zstd.tiff_compression = TiffCompression::kZstd;
  ExportOptions lzw;
  lzw.tiff_compression = TiffCompression::kLzw;
  for (const auto& [name, options] : {std::pair{"plain.tif", ExportOptions{}},
                                      {"deflate.tif", packed},
                                      {"zstd.tif", zstd},
                                      {"lzw.tif", lzw},
                                      {"scan.png", ExportOptions{}},
                                      {"scan.fettle", ExportOptions{}}}) {
    const std::string path = folder.file(name);
    ASSERT_TRUE(exportField(field, path, options, job)) << name;
    const auto whole = importField(path, {}, job);
    ASSERT_TRUE(whole) << whole.error().line();
    const auto grid = importGrid(path, {});
    ASSERT_TRUE(grid) << name;
    EXPECT_EQ(grid->has_value(), std::string(name).ends_with(".tif"));
    EXPECT_TRUE(!*grid || **grid == whole->field.grid()) << name;
    for (const RowSpan rows : {RowSpan{0, 1}, {0, 500}, {499, 1}, {60, 70}, {128, 300}}) {
      const auto part = importRows(path, {}, rows.first, rows.count, job);
      ASSERT_TRUE(part) << part.error().line();
      const Version expected = rowsOf(whole->field, rows.first, rows.count);
      EXPECT_EQ(part->field.grid(), expected.grid()) << name;
      EXPECT_EQ(contentHash(part->field), contentHash(expected)) << name << " from " << rows.first;
    }
    for (const RowSpan rows : {RowSpan{-1, 5}, {0, 501}, {500, 1}, {3, 0}})
      EXPECT_EQ(importRows(path, {}, rows.first, rows.count, job).error().kind, ErrorKind::kInput);
  }
}

TEST(NoiseByRows, is_the_noise_of_the_whole_bit_by_bit) {
  for (const auto& [width, height] : {std::pair{90, 900}, {1, 200}, {200, 1}, {130, 128}}) {
    const Version field = tests::hardField(width, height);
    JobControl job;
    const auto whole = estimateNoise(field, job);
    ASSERT_TRUE(whole);
    for (const std::int32_t rows : {64, 128, 1024}) {
      const auto parts = estimateNoiseByRows(
          field.grid(),
          [&](RowSpan span, JobControl&) -> Result<Version> { return rowsOf(field, span.first, span.count); },
          rows, job);
      ASSERT_TRUE(parts);
      EXPECT_EQ(parts->windows, whole->windows);
      EXPECT_TRUE(whole->windows == 0 || parts->sigma == whole->sigma) << height << " rows by " << rows;
    }
  }
  JobControl job;
  const auto failed = estimateNoiseByRows(
      tests::hardField(9, 9).grid(),
      [](RowSpan, JobControl&) -> Result<Version> { return failure("gone", "file"); }, 64, job);
  ASSERT_FALSE(failed);
  EXPECT_EQ(failed.error().what, "gone");
}

}  // namespace
}  // namespace fettle::engine
