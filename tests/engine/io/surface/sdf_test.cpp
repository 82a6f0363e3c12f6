// Surface data files (ISO 25178-71), made byte by byte, and written by Fettle.

#include <cmath>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tests/engine/io/io_support.h"
#include "tests/engine/io/surface/instrument_files.h"
#include "tests/support/temp_folder.h"

namespace fettle::engine {
namespace {

class Sdf : public testing::Test {
 protected:
  Result<Imported> read(const std::string& bytes, const ImportOptions& options = {}) {
    writeBytes(folder_.file("a.sdf"), bytes);
    return load(folder_.file("a.sdf"), options);
  }
  // 3 x 2 samples of 10, 20, hole, 40, 50, 60 nm from the top, 1 um and 2 um apart.
  void expectSixCounts(const std::string& bytes, double count, bool hole = true) {
    const auto scan = read(bytes);
    ASSERT_TRUE(scan) << scan.error().line();
    EXPECT_EQ(scan->format, "SDF");
    const Grid& grid = scan->field.grid();
    ASSERT_EQ(grid.width, 3);
    ASSERT_EQ(grid.height, 2);
    EXPECT_EQ(grid.spacing_x, 1.0);
    EXPECT_EQ(grid.spacing_y, 2.0);
    EXPECT_EQ(grid.lateral_unit.name, "um");
    EXPECT_EQ(grid.height_unit.name, "um");
    EXPECT_EQ(grid.height_per_count, count);
    EXPECT_EQ(stored(scan->field, 0, 0), 0.01F);
    EXPECT_EQ(stored(scan->field, 1, 2), 0.06F);
    EXPECT_EQ(std::isnan(stored(scan->field, 0, 2)), hole);
    EXPECT_TRUE(scan->warnings.empty()) << scan->warnings.front();
  }
  std::string refused(const std::string& bytes) {
    const auto scan = read(bytes);
    EXPECT_FALSE(scan);
    if (scan) return {};
    EXPECT_EQ(scan.error().kind, ErrorKind::kInput) << scan.error().line();
    return scan.error().what;
  }

  tests::TempFolder folder_;
};

TEST_F(Sdf, EveryTypeAndBothVersionsGiveTheSameSurface) {
  for (const char* version : {"bISO-1.0", "bISO-2.0", "bBCR-1.0"}) {
    expectSixCounts(binarySdf<std::uint8_t>(0, 3, {1, 2, 3, 4, 5, 6}, version), 0.01, false);
    expectSixCounts(binarySdf<std::uint16_t>(1, 3, {1, 2, 65535, 4, 5, 6}, version), 0.01);
    expectSixCounts(binarySdf<std::uint32_t>(2, 3, {1, 2, 4294967295U, 4, 5, 6}, version), 0.01);
    expectSixCounts(binarySdf<float>(3, 3, {1, 2, kNan, 4, 5, 6}, version), 0.0);
    expectSixCounts(binarySdf<float>(3, 3, {1, 2, std::numeric_limits<float>::lowest(), 4, 5, 6}, version),
                    0.0);
    expectSixCounts(binarySdf<std::int8_t>(4, 3, {1, 2, 3, 4, 5, 6}, version), 0.01, false);
    expectSixCounts(binarySdf<std::int16_t>(5, 3, {1, 2, -32768, 4, 5, 6}, version), 0.01);
    expectSixCounts(
        binarySdf<std::int32_t>(6, 3, {1, 2, std::numeric_limits<std::int32_t>::min(), 4, 5, 6}, version),
        0.01);
    expectSixCounts(
        binarySdf<double>(7, 3, {1, 2, std::numeric_limits<double>::quiet_NaN(), 4, 5, 6}, version), 0.0);
    expectSixCounts(binarySdf<double>(7, 3, {1, 2, std::numeric_limits<double>::lowest(), 4, 5, 6}, version),
                    0.0);
  }
  for (const char* version : {"aISO-1.0", "aISO-2.0", "aBCR-1.0"}) {
    expectSixCounts(textSdf(version, 7, "1 2 BAD\r\n4 5 6\r\n"), 0.0);
    expectSixCounts(textSdf(version, 5, " 1\n2\nbad\n4\n5\n6\n"), 0.01);
  }
}

TEST_F(Sdf, TheHeaderOfOlympusIsEightBytesLonger) {
  std::string bytes = binarySdf<std::int16_t>(5, 3, {1, 2, -32768, 4, 5, 6});
  bytes.insert(81, std::string("\5\0\0\0\1\0\0\0", 8));
  expectSixCounts(bytes, 0.01);
}

TEST_F(Sdf, WhatWasWrittenIsReadBackInTheUnitOfHeights) {
  Grid grid = gridOf(5, 4);
  grid.spacing_x = 0.3;
  grid.spacing_y = 0.07;
  std::vector<float> z;
  for (int i = 0; i < 20; ++i) z.push_back(i == 7 ? kNan : 1.1F * static_cast<float>(i) - 3.0F);
  for (const LengthUnit& unit :
       {LengthUnit{"nm", 1e-6}, {"um", 1e-3}, {"mm", 1.0}, {"m", 1000.0}, {"in", 25.4}})
    for (const bool ascii : {false, true}) {
      grid.lateral_unit = grid.height_unit = unit;
      const Version field = makeField(grid, z);
      ExportOptions options;
      options.ascii = ascii;
      const auto written = save(field, folder_.file("w.sdf"), options);
      ASSERT_TRUE(written);
      EXPECT_TRUE(written->warnings.empty());
      const std::string bytes = readBytes(folder_.file("w.sdf"));
      EXPECT_TRUE(bytes.starts_with(ascii ? "aISO-1.0\r\n" : "bISO-1.0")) << bytes.substr(0, 12);
      EXPECT_TRUE(ascii || bytes.size() == 81 + 20 * 8);
      FETTLE_LOAD(back, folder_.file("w.sdf"));
      EXPECT_EQ(back.field.grid(), grid) << unit.name;
      EXPECT_EQ(contentHash(back.field), contentHash(field));
    }
}

TEST_F(Sdf, ALongSideIsWrittenInVersionTwo) {
  const Version field = makeField(gridOf(70000, 1), std::vector<float>(70000, 2.5F));
  for (const bool ascii : {false, true}) {
    ExportOptions options;
    options.ascii = ascii;
    const auto written = save(field, folder_.file("l.sdf"), options);
    ASSERT_TRUE(written);
    EXPECT_TRUE(warned(written->warnings, "version 2.0"));
    FETTLE_LOAD(back, folder_.file("l.sdf"));
    EXPECT_EQ(contentHash(back.field), contentHash(field));
  }
}

TEST_F(Sdf, OneProfileMayHaveNoDistanceToTheNext) {
  std::string bytes = binarySdf<std::int16_t>(5, 3, {1, 2, 3});
  put<double>(bytes, 8 + 10 + 24 + 4 + 8, 0.0);
  const auto scan = read(bytes);
  ASSERT_TRUE(scan) << scan.error().line();
  EXPECT_EQ(scan->field.grid().spacing_y, 1.0);
}

TEST_F(Sdf, LyingHeadersAndCutFilesAreRefused) {
  const std::string whole = binarySdf<std::int32_t>(6, 3, {1, 2, 3, 4, 5, 6});
  for (std::size_t size = 8; size < whole.size(); ++size)
    EXPECT_NE(refused(whole.substr(0, size)).find(size < 81 ? "header" : "ends before"), std::string::npos)
        << size;
  const auto lying = [&](std::size_t at, auto value) {
    std::string bytes = whole;
    put(bytes, at, value);
    return bytes;
  };
  constexpr std::size_t kCounts = 42, kScales = 46, kKinds = 78;
  EXPECT_NE(refused(lying(kCounts, std::uint16_t{0})).find("0 points"), std::string::npos);
  refused(lying(kCounts, std::uint16_t{60000}));
  for (const double scale :
       {0.0, -1.0, std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()})
    EXPECT_NE(refused(lying(kScales, scale)).find("scales"), std::string::npos);
  EXPECT_NE(refused(lying(kScales + 16, 0.0)).find("scales"), std::string::npos);
  EXPECT_NE(refused(lying(kKinds, std::uint8_t{1})).find("compressed"), std::string::npos);
  EXPECT_NE(refused(lying(kKinds + 1, std::uint8_t{8})).find("type 8"), std::string::npos);
  // 2^62 samples in 85 bytes.
  std::string huge = binarySdf<float>(3, 3, {1, 2, 3, 4, 5, 6}, "bISO-2.0");
  put<std::uint32_t>(huge, 42, 0x7FFFFFFFU);
  put<std::uint32_t>(huge, 46, 0x7FFFFFFFU);
  refused(huge);

  const std::string text = textSdf("aISO-1.0", 7, "1 2 3\r\n4 5 6\r\n");
  const std::size_t star = text.find('*');
  for (std::size_t size = 8; size < star; size += 7) refused(text.substr(0, size));
  refused(text.substr(0, star + 8));  // inside the data
  EXPECT_NE(refused(textSdf("aISO-1.0", 7, "1 2 3 4 5 ")).find("inside profile 2"), std::string::npos);
  EXPECT_NE(refused(textSdf("aISO-1.0", 7, "1 2 3 4 5x 6")).find("5x"), std::string::npos);
  EXPECT_NE(refused(textSdf("aISO-1.0", 7, "1 2 3 4 5,5 6")).find("5,5"), std::string::npos);
  EXPECT_NE(refused(textSdf("aISO-1.0", 9, "1 2 3 4 5 6")).find("type 9"), std::string::npos);
  EXPECT_NE(refused("aISO-1.0\nNumPoints = 3\n*\n1 2 3\n*\n").find("lacks"), std::string::npos);
  EXPECT_NE(refused("aISO-1.0\nNumPoints = three\n*\n1 2 3\n*\n").find("three"), std::string::npos);
}

TEST_F(Sdf, HolesAloneOpenWithAWarning) {
  const auto scan = read(textSdf("aISO-1.0", 7, "BAD BAD BAD BAD BAD BAD "));
  ASSERT_TRUE(scan) << scan.error().line();
  EXPECT_TRUE(std::isnan(stored(scan->field, 1, 2)));
  EXPECT_TRUE(warned(scan->warnings, "height"));
}

TEST_F(Sdf, MoreThanTheHeaderStatesAndAMissingEndAreWarnedOf) {
  const auto more = read(textSdf("aISO-1.0", 7, "1 2 3 4 5 6 7\r\n"));
  ASSERT_TRUE(more);
  EXPECT_TRUE(warned(more->warnings, "more numbers"));
  std::string cut = textSdf("aISO-1.0", 7, "1 2 3 4 5 61.25\r\n");
  cut.resize(cut.find("61.25") + 2);
  const auto ended = read(cut);
  ASSERT_TRUE(ended);
  EXPECT_TRUE(warned(ended->warnings, "cut short"));
  // What the user states counts.
  ImportOptions options;
  options.no_data = 4.0;
  const auto holed = read(textSdf("aISO-1.0", 7, "1 2 3 4 5 6 "), options);
  ASSERT_TRUE(holed);
  EXPECT_TRUE(std::isnan(stored(holed->field, 1, 0)));
}

TEST_F(Sdf, DigitsThatAFloatLosesBesideTheRangeAreWarnedOf) {
  const auto offset = read(binarySdf<double>(7, 3, {5e8 + 1, 5e8 + 3, 5e8 + 7, 5e8 + 8, 5e8 + 9, 5e8 + 12}));
  ASSERT_TRUE(offset) << offset.error().line();
  EXPECT_TRUE(warned(offset->warnings, "more digits than a float holds"));
}

TEST_F(Sdf, OnlySdfIsAskedForText) {
  ExportOptions options;
  options.ascii = true;
  const auto written = save(makeField(gridOf(2, 2), {1, 2, 3, 4}), folder_.file("a.tif"), options);
  ASSERT_FALSE(written);
  EXPECT_NE(written.error().remedy.find("--ascii"), std::string::npos);
}

}  // namespace
}  // namespace fettle::engine
