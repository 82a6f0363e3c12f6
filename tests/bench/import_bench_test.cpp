// What the benchmark reads is what it claims to read: every format, and the same field.
#include "bench/import_bench.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "engine/formats/formats.h"
#include "haptic/trials/hand_stroke.h"
#include "tests/support/temp_folder.h"

namespace fettle::bench {
namespace {

TEST(ImportBench, HasARowForEveryFormatThatIsRead) {
  ImportBenchOptions options;
  options.side = 48;
  options.repeats = 2;
  engine::JobControl job;
  const auto report = benchImport(options, job);
  ASSERT_TRUE(report) << report.error().line();
  for (const engine::FormatInfo& format : engine::formats()) {
    EXPECT_TRUE(std::ranges::any_of(report->rows, [&](const ImportBenchRow& row) {
      return row.format == format.name;
    })) << format.name;
  }
  const std::uint64_t written = engine::contentHash(trials::workpiece(48, 0.05));
  for (const ImportBenchRow& row : report->rows) {
    EXPECT_EQ(row.samples, 48 * 48) << row.name;
    EXPECT_GT(row.bytes, 48 * 48) << row.name;
    EXPECT_GT(row.slowest, 0.0) << row.name;
    EXPECT_LE(row.slowest, row.median) << row.name;
    EXPECT_LE(row.median, row.fastest) << row.name;
    EXPECT_GT(row.plain, 0.0) << row.name;
    EXPECT_EQ(row.gdal > 0.0, row.format == "GTiff") << row.name;
    EXPECT_EQ(row.gdal_new > 0.0, row.format == "GTiff") << row.name;
    EXPECT_GT(row.memory, 0.0) << row.name;
    const bool in_counts = row.format == "PNG" || row.format == "LAS" || row.format == "SUR";
    EXPECT_EQ(row.hash == written, !in_counts) << row.name;
  }
}

TEST(ImportBench, FilesThatCannotBeReadAndOptionsOutOfRangeAreRefused) {
  engine::JobControl job;
  ImportBenchOptions options;
  const tests::TempFolder folder;
  options.files = {folder.file("none.tif")};
  ASSERT_FALSE(benchImport(options, job));
  for (const auto& [side, repeats] : {std::pair{15, 1}, {16385, 1}, {64, 0}, {64, 101}}) {
    ImportBenchOptions bad;
    bad.side = side;
    bad.repeats = repeats;
    const auto report = benchImport(bad, job);
    ASSERT_FALSE(report);
    EXPECT_EQ(report.error().kind, engine::ErrorKind::kInput);
  }
}

}  // namespace
}  // namespace fettle::bench
