// Walks the round-trip table of docs/formats.md: what a row says is kept comes back bit for bit, what it says
// is lost is warned of when it is written. A word in the table that this test does not know fails it, and so
// does a format that is in the program and not in the table, so that the two cannot drift apart.

#include <bit>
#include <cmath>
#include <map>
#include <random>

#include <gtest/gtest.h>

#include "engine/field/builder.h"
#include "engine/formats/formats.h"
#include "tests/engine/io/io_support.h"
#include "tests/support/markdown_table.h"
#include "tests/support/temp_folder.h"

namespace fettle::engine {
namespace {

using tests::TempFolder;

struct Row {
  std::string name, in, out, samples, holes, place, units, crs, lost;
};

std::vector<Row> table() {
  std::vector<Row> rows;
  for (const auto& c : tests::markdownTable("docs/formats.md", "| format | in | out |"))
    rows.push_back({c[0], c[1], c[2], c[3], c[4], c[5], c[6], c[7], c[8]});
  return rows;
}

// How a row of the table is written.
struct Written {
  std::string format;     // FormatInfo::name
  std::string extension;  // empty: never written
  bool mesh = false;
  bool ascii = false;
};
const std::map<std::string, Written>& rowsThatAreKnown() {
  static const std::map<std::string, Written> known{
      {"GeoTIFF `.tif`", {"GTiff", ".tif"}},
      {"x3p", {"X3P", ".x3p"}},
      {"SDF `.sdf`", {"SDF", ".sdf"}},
      {"SDF text `--ascii`", {"SDF", ".sdf", false, true}},
      {"OpenEXR `.exr`", {"EXR", ".exr"}},
      {"ESRI ASCII `.asc`", {"AAIGrid", ".asc"}},
      {"text matrix `.txt` `.csv`", {"Matrix", ""}},
      {"XYZ text", {"XYZ", ".xyz"}},
      {"PLY points", {"PLY", ".ply"}},
      {"PLY mesh `--mesh`", {"PLY", ".ply", true}},
      {"STL mesh", {"STL", ".stl", true}},
      {"16-bit PNG", {"PNG", ".png"}},
      {"session `.fettle`", {"Fettle", ".fettle"}},
      {"LAS 1.0 - 1.4", {"LAS", ""}},
      {"PCD", {"PCD", ""}},
      {"Digital Surf `.sur`", {"SUR", ""}},
      {"depth image, PNG, TIFF", {"PNG", ""}},
  };
  return known;
}

// A field that asks for everything but what the row's own words exclude.
struct Asked {
  bool holes = false;
  bool units = false;  // um across, nm up, instead of the default mm
  bool crs = false;
  bool any_float = true;
};

constexpr std::int32_t kWidth = 71, kHeight = 43;
constexpr const char* kCrs =
    "LOCAL_CS[\"Engineering\",UNIT[\"micrometre\",1e-06],AXIS[\"x\",EAST],AXIS[\"y\",NORTH]]";

Version fieldOf(const Asked& asked) {
  Grid grid = gridOf(kWidth, kHeight);
  grid.spacing_x = 0.215326741;
  grid.spacing_y = 0.5;
  grid.origin_x = -106.564972;
  grid.origin_y = 5000000.25;
  if (asked.units) {
    grid.lateral_unit = {"um", 1e-3};
    grid.height_unit = {"nm", 1e-6};
  }
  if (asked.crs) {
    grid.crs_wkt = kCrs;
    grid.lateral_unit = grid.height_unit = {"um", 1e-3};
  }
  std::mt19937 random(31);
  std::vector<float> z;
  for (std::int64_t i = 0; i < grid.samples(); ++i) {
    const float any = std::bit_cast<float>(static_cast<std::uint32_t>(random()));
    const float plain = static_cast<float>(random() % 65536) * 0.125F;
    z.push_back(asked.any_float && std::isfinite(any) ? any : plain);
  }
  // Single holes off the border, three samples apart at least: no corner is lost, and no side.
  if (asked.holes)
    for (std::size_t r = 5; r + 5 < kHeight; r += 7)
      for (std::size_t c = 5; c + 5 < kWidth; c += 9) z[r * kWidth + c] = kNan;
  return makeField(grid, z);
}

struct Trip {
  std::vector<std::string> warnings;  // of the writer
  Imported back;
  bool whole = false;
};

Trip roundTrip(const Version& field, const Written& how) {
  const TempFolder folder;
  const std::string path = folder.file("trip" + how.extension);
  ExportOptions options;
  options.mesh = how.mesh;
  options.ascii = how.ascii;
  Trip trip;
  const auto written = save(field, path, options);
  EXPECT_TRUE(written) << (written ? "" : written.error().line());
  if (!written) return trip;
  EXPECT_EQ(written->format, how.format);
  trip.warnings = written->warnings;
  auto back = load(path);
  EXPECT_TRUE(back) << (back ? "" : back.error().line());
  if (!back) return trip;
  trip.back = *std::move(back);
  EXPECT_EQ(trip.back.field.grid().width, field.grid().width);
  EXPECT_EQ(trip.back.field.grid().height, field.grid().height);
  trip.whole = trip.back.field.grid().samples() == field.grid().samples();
  return trip;
}

void checkSamples(const Row& row, const Written& how) {
  if (row.samples == "every bit" || row.samples == "every bit in equal units") {
    const Version field = fieldOf({});
    const Trip trip = roundTrip(field, how);
    ASSERT_TRUE(trip.whole);
    EXPECT_EQ(contentHash(trip.back.field), contentHash(field));
  } else if (row.samples == "to half a count, stated") {
    Asked plain;
    plain.any_float = false;
    const Version field = fieldOf(plain);
    const Trip trip = roundTrip(field, how);
    ASSERT_TRUE(trip.whole);
    EXPECT_TRUE(warned(trip.warnings, "largest error"));
    // Counts of 1 .. 65535 over the range.
    const FieldSummary summary = summarize(field);
    const double count = (summary.max - summary.min) / 65534.0;
    const auto heights = heightsOf(field);
    const auto counts = heightsOf(trip.back.field);
    for (std::size_t i = 0; i < heights.size(); ++i)
      ASSERT_NEAR(summary.min + (counts[i] - 1.0) * count, heights[i], 0.5001 * count);
  } else {
    ADD_FAILURE() << "this test does not know what samples '" << row.samples << "' are";
  }
}

// Whether sample (c, r) is the corner of a cell without a hole.
bool hasSurface(const Version& field, std::int32_t c, std::int32_t r) {
  for (const auto& [dc, dr] : {std::pair{0, 0}, {-1, 0}, {0, -1}, {-1, -1}}) {
    bool whole = true;
    for (int k = 0; k < 4; ++k) {
      const std::int32_t x = c + dc + k % 2, y = r + dr + k / 2;
      whole = whole && field.grid().contains(x, y) && !std::isnan(field.reader().heightAt(x, y));
    }
    if (whole) return true;
  }
  return false;
}

void checkHoles(const Row& row, const Written& how) {
  Asked asked;
  asked.holes = true;
  asked.any_float = how.format != "PNG";
  const Version field = fieldOf(asked);
  const Trip trip = roundTrip(field, how);
  ASSERT_TRUE(trip.whole);
  const bool neighbours = row.holes == "cells next to one";
  if (row.holes == "left out" || neighbours) {
    EXPECT_TRUE(warned(trip.warnings, "left out")) << "nothing says that holes are left out";
  } else if (row.holes != "yes") {
    ADD_FAILURE() << "this test does not know what holes '" << row.holes << "' are";
  }
  for (std::int32_t r = 0; r < kHeight; ++r)
    for (std::int32_t c = 0; c < kWidth; ++c) {
      const bool hole = std::isnan(field.reader().heightAt(c, r)) || (neighbours && !hasSurface(field, c, r));
      ASSERT_EQ(std::isnan(trip.back.field.reader().heightAt(c, r)), hole) << c << ", " << r;
    }
}

void checkPlace(const Row& row, const Written& how) {
  Asked plain;
  plain.any_float = false;
  const Version field = fieldOf(plain);
  const Trip trip = roundTrip(field, how);
  ASSERT_TRUE(trip.whole);
  const Grid& from = field.grid();
  const Grid& to = trip.back.field.grid();
  if (row.place == "every digit") {
    EXPECT_EQ(to.spacing_x, from.spacing_x);
    EXPECT_EQ(to.spacing_y, from.spacing_y);
    EXPECT_EQ(to.origin_x, from.origin_x);
    EXPECT_EQ(to.origin_y, from.origin_y);
  } else if (row.place == "to 7 digits from the corner, which its header states") {
    EXPECT_NEAR(to.spacing_x, from.spacing_x, 1e-7 * from.spacing_x);
    EXPECT_NEAR(to.spacing_y, from.spacing_y, 1e-7 * from.spacing_y);
    EXPECT_EQ(to.origin_x, from.origin_x);
    EXPECT_EQ(to.origin_y, from.origin_y);
    EXPECT_TRUE(warned(trip.warnings, "to the field's corner"));
  } else if (row.place == "spacing alone, every digit") {
    EXPECT_EQ(to.spacing_x, from.spacing_x);
    EXPECT_EQ(to.spacing_y, from.spacing_y);
    EXPECT_EQ(to.origin_x, 0.0);
    EXPECT_EQ(to.origin_y, 0.0);
    EXPECT_TRUE(warned(trip.warnings, "no origin"));
  } else if (row.place == "no") {
    EXPECT_EQ(to.spacing_x, 1.0);
    EXPECT_TRUE(warned(trip.warnings, "stores no spacing"));
  } else {
    ADD_FAILURE() << "this test does not know what spacing, origin '" << row.place << "' are";
  }
}

void checkUnits(const Row& row, const Written& how) {
  Asked asked;
  asked.units = true;
  asked.any_float = false;
  const Version field = fieldOf(asked);
  const Trip trip = roundTrip(field, how);
  ASSERT_TRUE(trip.whole);
  const Grid& to = trip.back.field.grid();
  if (row.units == "yes" || row.units == "yes, in comments") {
    if (row.units == "yes, in comments") {
      EXPECT_TRUE(
          warned(trip.warnings, "x and y are in um, z in nm: only a comment in the file states this"));
    }
    EXPECT_EQ(to.lateral_unit, field.grid().lateral_unit);
    EXPECT_EQ(to.height_unit, field.grid().height_unit);
    EXPECT_EQ(contentHash(trip.back.field), contentHash(field));
  } else if (row.units == "that of heights") {
    EXPECT_TRUE(warned(trip.warnings, "one unit"));
    EXPECT_EQ(to.height_unit, field.grid().height_unit);
    EXPECT_EQ(to.lateral_unit, field.grid().height_unit);
    EXPECT_NEAR(to.spacingXMm(), field.grid().spacingXMm(), 1e-15 * field.grid().spacingXMm());
    EXPECT_EQ(contentHash(trip.back.field), contentHash(field));
  } else if (row.units == "that of x and y, in its header") {
    EXPECT_TRUE(warned(trip.warnings, "STL has no units"));
    EXPECT_EQ(to.lateral_unit, field.grid().lateral_unit);
    EXPECT_EQ(to.height_unit, field.grid().lateral_unit);
  } else if (row.units == "no") {
    EXPECT_TRUE(warned(trip.warnings, "unit"));
    EXPECT_EQ(to.lateral_unit, LengthUnit{});
  } else {
    ADD_FAILURE() << "this test does not know what units '" << row.units << "' are";
  }
}

void checkSystem(const Row& row, const Written& how) {
  Asked asked;
  asked.crs = true;
  asked.any_float = false;
  const Version field = fieldOf(asked);
  const Trip trip = roundTrip(field, how);
  ASSERT_TRUE(trip.whole);
  const std::string& wkt = trip.back.field.grid().crs_wkt;
  if (row.crs.starts_with("yes")) {
    EXPECT_NE(wkt.find("Engineering"), std::string::npos) << wkt;
  } else if (row.crs == "no") {
    EXPECT_EQ(wkt, "");
    EXPECT_TRUE(warned(trip.warnings, "coordinate system"));
  } else {
    ADD_FAILURE() << "this test does not know what the coordinate system '" << row.crs << "' is";
  }
}

TEST(FormatTable, HoldsEveryFormatOfTheProgramAndNoOther) {
  const std::vector<Row> rows = table();
  ASSERT_GT(rows.size(), 10U) << "the table in docs/formats.md was not found";
  for (const FormatInfo& format : formats()) {
    bool read = false, written = false;
    for (const Row& row : rows) {
      const auto known = rowsThatAreKnown().find(row.name);
      if (known == rowsThatAreKnown().end() || known->second.format != format.name) continue;
      read = read || row.in != "no";
      written = written || row.out == "yes";
    }
    EXPECT_EQ(read, format.reads) << format.name;
    EXPECT_EQ(written, format.writes) << format.name;
  }
  for (const Row& row : rows) EXPECT_TRUE(rowsThatAreKnown().contains(row.name)) << row.name;
}

TEST(FormatTable, EveryRowKeepsWhatItSaysAndWarnsOfWhatItLoses) {
  int walked = 0;
  for (const Row& row : table()) {
    const auto known = rowsThatAreKnown().find(row.name);
    if (known == rowsThatAreKnown().end() || known->second.extension.empty()) continue;
    SCOPED_TRACE(row.name);
    checkSamples(row, known->second);
    checkHoles(row, known->second);
    checkPlace(row, known->second);
    checkUnits(row, known->second);
    checkSystem(row, known->second);
    ++walked;
  }
  EXPECT_EQ(walked, 12);
}

TEST(FormatTable, WhoLosesNothingKeepsAllAtOnce) {
  int walked = 0;
  for (const Row& row : table()) {
    if (!row.lost.starts_with("nothing")) continue;
    const auto known = rowsThatAreKnown().find(row.name);
    ASSERT_NE(known, rowsThatAreKnown().end()) << row.name;
    SCOPED_TRACE(row.name);
    Asked all;
    all.holes = all.crs = true;
    Version field = fieldOf(all);
    const bool marks = row.lost.find("marks included") != std::string::npos;
    if (marks) {
      std::vector<std::uint8_t> keep(kWidth * kHeight, 0);
      for (std::size_t i = 0; i < keep.size(); i += 5) keep[i] = 1;
      field = makeField(field.grid(), heightsOf(field), keep).inverted();
    }
    const Trip trip = roundTrip(field, known->second);
    ASSERT_TRUE(trip.whole);
    EXPECT_TRUE(trip.warnings.empty()) << trip.warnings.front();
    EXPECT_EQ(contentHash(trip.back.field), contentHash(field));
    Grid to = trip.back.field.grid();
    EXPECT_NE(to.crs_wkt.find("Engineering"), std::string::npos);
    to.crs_wkt = field.grid().crs_wkt;  // the same system in more words
    EXPECT_EQ(to, field.grid());
    ++walked;
  }
  EXPECT_EQ(walked, 2);  // GeoTIFF and the session
}

}  // namespace
}  // namespace fettle::engine
