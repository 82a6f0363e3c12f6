#include <algorithm>
#include <bit>
#include <charconv>
#include <cmath>
#include <random>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "engine/io/points/lattice.h"
#include "tests/engine/io/io_support.h"
#include "tests/support/temp_folder.h"

namespace fettle::engine {
namespace {

using tests::TempFolder;

Result<Imported> loadText(const std::string& text, const std::string& name = "a.xyz",
                          const ImportOptions& o = {}) {
  const TempFolder folder;
  writeBytes(folder.file(name), text);
  return load(folder.file(name), o);
}

#define FETTLE_LOAD_TEXT(var, ...)              \
  const auto var##_ = loadText(__VA_ARGS__);    \
  ASSERT_TRUE(var##_) << var##_.error().line(); \
  [[maybe_unused]] const Imported& var = *var##_

TEST(Xyz, SeparatorsHeadersCommentsAndLineEndsAreUnderstood) {
  for (const char* text :
       {"0 0 1\n1 0 2\n0 1 3\n1 1 4\n", "0,0,1\r\n1,0,2\r\n0,1,3\r\n1,1,4",
        "x,y,z\n0,0,1,255\n1,0,2,255\n0,1,3,1\n1,1,4,1\n", "0;0;1\n1;0;2\n0;1;3\n1;1;4\n",
        "\t0\t0 \t1\n 1\t0\t2\n0\t1\t3\n1\t1\t4\n",
        "# a comment\n// another\n4\nX Y Z\n\n0, 0, 1\n1 , 0 , 2\n# in between\n0,1,3\n\n1,1,4\n",
        "\xef\xbb\xbf"
        "0 0 +1\n1e0 0.0E+0 2.0\n0 1 .3e1\n+1 1 4.\n"}) {
    FETTLE_LOAD_TEXT(scan, text);
    EXPECT_EQ(heightsOf(scan.field), (std::vector<float>{1, 2, 3, 4})) << text;
    EXPECT_TRUE(scan.gridding->lattice);
  }
}

TEST(Xyz, AFieldLeftEmptyIsAPointLeftOut) {
  FETTLE_LOAD_TEXT(scan, "0,0,1\n1,0,\n0,1,,255\n1,1,4\n,1,2\n");
  EXPECT_EQ(scan.gridding->points, 2);
  EXPECT_TRUE(warned(scan.warnings, "3 points"));
}

TEST(Xyz, DigitsThatAFloatLosesBesideTheRangeAreWarnedOf) {
  FETTLE_LOAD_TEXT(offset, "0 0 5000.0001\n1 0 5000.0003\n0 1 5000.0007\n1 1 5000.0012\n");
  EXPECT_TRUE(warned(offset.warnings, "more digits than a float holds"));
  FETTLE_LOAD_TEXT(plain, "0 0 0.1\n1 0 0.3\n0 1 0.7\n1 1 1.2\n");
  EXPECT_FALSE(warned(plain.warnings, "more digits than a float holds"));
}

TEST(Xyz, TheUnitOfACommentIsTaken) {
  FETTLE_LOAD_TEXT(scan, "# x y z, units: um\n0 0 1\n1 0 2\n");
  EXPECT_EQ(scan.field.grid().lateral_unit, (LengthUnit{"um", 1e-3}));
  EXPECT_EQ(scan.field.grid().height_unit, (LengthUnit{"um", 1e-3}));
}

TEST(Xyz, PointsWithoutAUnitSayWhatWasTaken) {
  const std::string line = "the file states no unit, mm is assumed: give it with --unit";
  const std::string ply =
      "ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\nproperty float y\nproperty float z\n";
  const std::string points = "0 0 1\n1 0 2\n";
  ImportOptions metres;
  metres.unit = lengthUnitFromName("m");
  FETTLE_LOAD_TEXT(bare, points);
  EXPECT_TRUE(warned(bare.warnings, line));
  FETTLE_LOAD_TEXT(bare_ply, ply + "end_header\n" + points, "a.ply");
  EXPECT_TRUE(warned(bare_ply.warnings, line));
  FETTLE_LOAD_TEXT(stated, "# units m\n" + points);
  EXPECT_FALSE(warned(stated.warnings, "unit"));
  FETTLE_LOAD_TEXT(stated_ply, ply + "comment units m\nend_header\n" + points, "a.ply");
  EXPECT_FALSE(warned(stated_ply.warnings, "unit"));
  FETTLE_LOAD_TEXT(asked, points, "a.xyz", metres);
  EXPECT_FALSE(warned(asked.warnings, "unit"));
}

TEST(Xyz, NumbersPastTheRangeOfAFloatAreHoles) {
  FETTLE_LOAD_TEXT(scan, "0 0 1e39\n1 0 2\n2 0 1e-60\n3 0 1e999\n");
  EXPECT_TRUE(std::isnan(scan.field.reader().heightAt(0, 0)));
  EXPECT_EQ(scan.field.reader().heightAt(2, 0), 0.0F);
  EXPECT_EQ(scan.gridding->points, 3);  // 1e999 is infinite as a double
}

RC_GTEST_PROP(Xyz, AnyOrderAndWhiteSpaceGiveTheSameField, ()) {
  const int w = *rc::gen::inRange(1, 12);
  const int h = *rc::gen::inRange(1, 12);
  const double sx = *rc::gen::element(1.0, 0.024, 0.215326741, 2.5e-6, 1000.0 / 3.0);
  const double sy = *rc::gen::element(1.0, 0.5, 0.314582114);
  const double ox = *rc::gen::element(0.0, -106.564972, 5000000.125);
  std::vector<float> z;
  std::vector<std::string> lines;
  for (int r = 0; r < h; ++r)
    for (int c = 0; c < w; ++c) {
      z.push_back(std::bit_cast<float>(*rc::gen::inRange<std::uint32_t>(0x30000000U, 0x4b000000U)));
      const std::string gap = *rc::gen::element<std::string>(" ", "\t", "   ", " \t ", ",", " , ", ";");
      const std::string second = gap.find(',') != std::string::npos ? "," : gap == ";" ? ";" : gap;
      (void)second;
      lines.push_back(fmt::format("{}{}", *rc::gen::element<std::string>("", " ", "\t"),
                                  fmt::format("{} {} {}", ox + c * sx, r * sy, z.back())) +
                      *rc::gen::element<std::string>("", " ", " 7 8") +
                      *rc::gen::element<std::string>("\n", "\r\n", "\n\n"));
    }
  const std::uint32_t seed = *rc::gen::arbitrary<std::uint32_t>();
  std::shuffle(lines.begin(), lines.end(), std::mt19937(seed));
  // One separator a file, of any kind, with any space around it.
  const std::string separator = *rc::gen::element<std::string>(" ", "\t", "  ", ",", ", ", ";", " ; ");
  std::string text;
  for (const std::string& line : lines)
    for (const char character : line) {
      const bool between =
          character == ' ' && !text.empty() && std::isdigit(static_cast<unsigned char>(text.back())) != 0;
      text += between ? separator : std::string(1, character);
    }
  const auto scan = loadText(text);
  RC_ASSERT(scan.has_value());
  RC_ASSERT(scan->gridding->lattice);
  RC_ASSERT(scan->field.grid().width == w);
  RC_ASSERT(scan->field.grid().height == h);
  RC_ASSERT(heightsOf(scan->field) == z);
}

template <class T>
void append(std::string& bytes, T value, bool big) {
  auto raw = std::bit_cast<std::array<char, sizeof(T)>>(value);
  if (big) std::reverse(raw.begin(), raw.end());
  bytes.append(raw.data(), raw.size());
}

RC_GTEST_PROP(Ply, AnyEncodingAndOrderOfPropertiesGiveTheSameField, ()) {
  const int w = *rc::gen::inRange(1, 9);
  const int h = *rc::gen::inRange(1, 9);
  const std::string encoding =
      *rc::gen::element<std::string>("ascii", "binary_little_endian", "binary_big_endian");
  const bool big = encoding == "binary_big_endian";
  std::vector<std::string> names{"x", "y", "z", "red", "quality", "label"};
  const std::uint32_t seed = *rc::gen::arbitrary<std::uint32_t>();
  std::shuffle(names.begin(), names.end(), std::mt19937(seed));
  const bool list = *rc::gen::arbitrary<bool>();
  const bool before = *rc::gen::arbitrary<bool>();
  const std::string end = encoding == "ascii" && *rc::gen::arbitrary<bool>() ? "\r\n" : "\n";

  std::string text = "ply" + end + "format " + encoding + " 1.0" + end + "comment units m" + end;
  if (before)
    text += "element camera 2" + end + "property list uchar short k" + end + "property int8 j" + end;
  text += fmt::format("element vertex {}{}", w * h, end);
  for (const std::string& name : names)
    text += "property " +
            std::string(name == "x" || name == "y" ? "double"
                        : name == "z"              ? "float32"
                        : name == "red"            ? "uchar"
                        : name == "label"          ? "int"
                                                   : "float") +
            " " + name + end;
  if (list) text += "property list uint8 int32 near" + end;
  text += "element tristrips 1" + end + "property list uchar int vertex_indices" + end + "end_header" + end;
  const auto put = [&](auto value) {
    if (encoding == "ascii")
      text += fmt::format("{} ", value);
    else
      append(text, value, big);
  };
  const auto putByte = [&](int value) {
    if (encoding == "ascii")
      text += fmt::format("{} ", value);
    else
      text += static_cast<char>(value);
  };
  const auto endLine = [&] {
    if (encoding == "ascii") text += end;
  };
  if (before)
    for (int i = 0; i < 2; ++i) {
      putByte(2 - i);
      for (int k = 0; k < 2 - i; ++k) put(std::int16_t{300});
      putByte(-1);
      endLine();
    }
  std::vector<float> z;
  for (int r = 0; r < h; ++r)
    for (int c = 0; c < w; ++c) {
      z.push_back(static_cast<float>(r * 31 + c) * 0.37F);
      for (const std::string& name : names) {
        if (name == "x") put(100.0 + c * 0.25);
        if (name == "y") put(-7.0 + r * 0.5);
        if (name == "z") put(z.back());
        if (name == "red") putByte(200);
        if (name == "quality") put(0.5F);
        if (name == "label") put(std::int32_t{-5});
      }
      if (list) {
        putByte(c % 3);
        for (int k = 0; k < c % 3; ++k) put(std::int32_t{k});
      }
      endLine();
    }
  putByte(3);
  for (int k = 0; k < 3; ++k) put(std::int32_t{k});
  endLine();
  const auto scan = loadText(text, "a.ply");
  RC_ASSERT(scan.has_value());
  RC_ASSERT(scan->field.grid().width == w);
  RC_ASSERT(scan->field.grid().height == h);
  RC_ASSERT(heightsOf(scan->field) == z);
  RC_ASSERT(scan->field.grid().lateral_unit.name == "m");
}

TEST(Lattice, SpacingIsFoundThroughGapsRoundingAndFloats) {
  std::mt19937 random(3);
  for (const double spacing : {0.024, 0.2020202, 1.0, 1.0 / 3.0, 2.58e-6, 1234.5})
    for (const double origin : {0.0, -47.1717172, 500000.25}) {
      std::vector<double> exact, floats, rounded;
      for (int k = 0; k < 900; ++k) {
        if (k > 0 && k < 899 && random() % 3 == 0) continue;
        exact.push_back(origin + k * spacing);
        rounded.push_back(origin + std::nearbyint(k * spacing / (spacing / 30.0)) * (spacing / 30.0) +
                          (k % 2) * spacing / 25.0);
        if (origin < 1000.0) floats.push_back(static_cast<double>(static_cast<float>(origin + k * spacing)));
      }
      const auto e = findAxisLattice(exact);
      ASSERT_TRUE(e);
      EXPECT_EQ(e->count, 900);
      // Values are off by half an ulp each; over 899 steps that is the spacing's own error.
      EXPECT_NEAR(e->spacing, spacing, 0x1p-52 * (std::abs(origin) + 900 * spacing) / 100.0);
      const auto r = findAxisLattice(rounded);
      ASSERT_TRUE(r);
      EXPECT_EQ(r->count, 900);
      EXPECT_NEAR(r->spacing, spacing, spacing * 1e-3);
      // A float must be able to distinguish two columns: 2.58e-6 at -47 it cannot.
      if (!floats.empty() && spacing > 1e-4) {
        const auto f = findAxisLattice(floats);
        ASSERT_TRUE(f) << spacing << ' ' << origin;
        EXPECT_EQ(f->count, 900);
        EXPECT_NEAR(f->spacing, spacing, 1e-6 * (spacing + std::abs(origin) / 900));
      }
    }
}

TEST(Lattice, RandomValuesAreNone) {
  std::mt19937 random(9);
  std::uniform_real_distribution<double> uniform(0.0, 100.0);
  for (int round = 0; round < 50; ++round) {
    std::vector<double> values;
    for (int i = 0; i < 200; ++i) values.push_back(uniform(random));
    EXPECT_FALSE(findAxisLattice(values));
  }
}

TEST(Gridding, RulesDecideWhatACellTakes) {
  const std::string text = "0 0 1\n0.1 0 5\n0 0.1 2\n-0.1 0 9\n2 0 3\n2.1 0 4\n";
  for (const auto& [rule, first, second] : {std::tuple{CellRule::kMedian, 3.5F, 3.5F},
                                            {CellRule::kMean, 4.25F, 3.5F},
                                            {CellRule::kHighest, 9.0F, 4.0F}}) {
    ImportOptions options;
    options.cell_size = 1.0;
    options.cell_rule = rule;
    FETTLE_LOAD_TEXT(scan, text, "a.xyz", options);
    ASSERT_EQ(scan.field.grid().width, 3);
    ASSERT_EQ(scan.field.grid().height, 1);
    EXPECT_EQ(scan.field.reader().heightAt(0, 0), first);
    EXPECT_TRUE(std::isnan(scan.field.reader().heightAt(1, 0)));
    EXPECT_EQ(scan.field.reader().heightAt(2, 0), second);
    EXPECT_EQ(scan.gridding->points, 6);
    EXPECT_EQ(scan.gridding->cells, 3);
    EXPECT_EQ(scan.gridding->empty_cells, 1);
    EXPECT_EQ(scan.gridding->multiple_cells, 2);
    EXPECT_FALSE(scan.gridding->lattice);
    EXPECT_EQ(scan.field.grid().spacing_x, 1.0);
    EXPECT_EQ(scan.field.grid().origin_x, -0.1);
  }
}

TEST(Gridding, IrregularPointsGetAboutOneACell) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> x(0.0, 300.0);
  std::uniform_real_distribution<double> y(0.0, 100.0);
  std::string text;
  for (int i = 0; i < 30000; ++i) text += fmt::format("{} {} {}\n", x(random), y(random), i % 7);
  FETTLE_LOAD_TEXT(scan, text);
  EXPECT_FALSE(scan.gridding->lattice);
  // 30000 points on 30000 square units: cells of 1, of which 1/e stay empty.
  EXPECT_NEAR(scan.field.grid().spacing_x, 1.0, 0.11);
  EXPECT_NEAR(static_cast<double>(scan.gridding->empty_cells) / static_cast<double>(scan.gridding->cells),
              0.368, 0.08);
  EXPECT_TRUE(warned(scan.warnings, "--cell-size"));
}

TEST(Gridding, AStrayPointIsRefusedWithARemedy) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> uniform(0.0, 10.0);
  std::string text;
  for (int i = 0; i < 20000; ++i) text += fmt::format("{} {} 1\n", uniform(random), uniform(random));
  for (const char* stray : {"1e9 1e9 1\n", "1e300 0 1\n", "-1e308 1e308 1\n"}) {
    const auto scan = loadText(text + stray);
    ASSERT_FALSE(scan);
    EXPECT_EQ(scan.error().kind, ErrorKind::kInput);
    EXPECT_NE(scan.error().line().find(scan.error().what.find("range") == std::string::npos ? "--cell-size"
                                                                                            : "stray"),
              std::string::npos)
        << scan.error().line();
  }
  ImportOptions options;
  options.cell_size = 1e8;
  EXPECT_TRUE(loadText(text + "1e9 1e9 1\n", "a.xyz", options));
  options.cell_size = 1e-6;
  const auto fine = loadText(text, "a.xyz", options);
  ASSERT_FALSE(fine);
  EXPECT_NE(fine.error().remedy.find("--cell-size"), std::string::npos);
}

TEST(Gridding, CloudsWithoutAreaBecomeRowsColumnsOrOneCell) {
  FETTLE_LOAD_TEXT(one, "5 6 7\n");
  EXPECT_EQ(one.field.grid().samples(), 1);
  EXPECT_EQ(one.field.grid().origin_x, 5.0);
  EXPECT_EQ(one.field.grid().origin_y, 6.0);
  FETTLE_LOAD_TEXT(same, "5 6 7\n5 6 8\n5 6 10\n");
  EXPECT_EQ(same.field.reader().heightAt(0, 0), 8.0F);
  EXPECT_EQ(same.gridding->multiple_cells, 1);
  FETTLE_LOAD_TEXT(row, "0 6 7\n0.5 6 8\n1.5 6 10\n");
  EXPECT_EQ(row.field.grid().width, 4);
  EXPECT_EQ(row.field.grid().height, 1);
  EXPECT_EQ(row.field.grid().spacing_y, 0.5);
  std::mt19937 random(1);
  std::uniform_real_distribution<double> uniform(0.0, 10.0);
  std::string line, diagonal;
  for (int i = 0; i < 500; ++i) {
    const double t = uniform(random);
    line += fmt::format("3 {} 1\n", t);
    diagonal += fmt::format("{} {} 1\n", t, t);
  }
  FETTLE_LOAD_TEXT(column, line);
  EXPECT_EQ(column.field.grid().width, 1);
  EXPECT_GT(column.field.grid().height, 100);
  FETTLE_LOAD_TEXT(slanted, diagonal);
  EXPECT_LT(slanted.field.grid().samples(), 1000000);
}

TEST(Gridding, CoarseRoundingOfIrregularPointsIsNoLattice) {
  // Coordinates of a survey, rounded to 0.01: a lattice of 0.01 fits them all and means nothing.
  std::mt19937 random(1);
  std::string text;
  for (int i = 0; i < 5000; ++i)
    text += fmt::format("{:.2f} {:.2f} 1\n", static_cast<double>(random() % 10000) * 0.01,
                        static_cast<double>(random() % 10000) * 0.01);
  FETTLE_LOAD_TEXT(scan, text);
  EXPECT_FALSE(scan.gridding->lattice);
  EXPECT_GT(scan.field.grid().spacing_x, 0.5);
}

TEST(Gridding, HeightsAreScaledAndNoDataPointsLeftOut) {
  ImportOptions options;
  options.z_scale = 0.1;
  options.no_data = -1.0;
  FETTLE_LOAD_TEXT(scan, "0 0 10\n1 0 -1\n2 0 30\n", "a.xyz", options);
  EXPECT_EQ(scan.gridding->points, 2);
  EXPECT_EQ(scan.field.reader().heightAt(0, 0), 1.0F);
  EXPECT_EQ(scan.field.grid().width, 2);
}

}  // namespace
}  // namespace fettle::engine
