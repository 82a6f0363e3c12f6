// Headers of text files of points: names of columns are used, and what is not clear is refused. And a last
// line without its end, which may lack a part of its last number.

#include <array>
#include <cmath>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "tests/engine/io/io_support.h"
#include "tests/support/temp_folder.h"

namespace fettle::engine {
namespace {

using tests::TempFolder;

Result<Imported> loadCsv(const std::string& text, const std::string& name = "a.csv") {
  const TempFolder folder;
  writeBytes(folder.file(name), text);
  return load(folder.file(name));
}

// The points (10, 20, 1), (11, 20, 2), (10, 21, 3), (11, 21, 4).
void expectFourPoints(const std::string& text) {
  SCOPED_TRACE(text);
  const auto scan = loadCsv(text);
  ASSERT_TRUE(scan) << scan.error().line();
  EXPECT_EQ(scan->field.grid().origin_x, 10.0);
  EXPECT_EQ(scan->field.grid().origin_y, 20.0);
  EXPECT_EQ(heightsOf(scan->field), (std::vector<float>{1, 2, 3, 4}));
}

// Lines of those points, {0} their number, {1} x, {2} y, {3} z.
std::string lines(const std::string& pattern) {
  std::string text;
  for (int i = 0; i < 4; ++i)
    text += fmt::format(fmt::runtime(pattern), i + 1, 10 + i % 2, 20 + i / 2, i + 1) + "\n";
  return text;
}

TEST(XyzColumns, TheNamesOfAHeaderSayWhichColumnsAreTaken) {
  for (const auto& [header, pattern] : {
           std::pair{"id,x,y,z", "{0},{1},{2},{3}"},
           {"z,x,y", "{3},{1},{2}"},
           {"x,y,z", "{1},{2},{3}"},
           {"x,y,z,intensity", "{1},{2},{3},77"},
           {"name;Y;X;Z", "P{0};{2};{1};{3}"},
           {",x,y,z", "{0},{1},{2},{3}"},
           {"\"id\",\"x\",\"y\",\"z\"", "\"a, b\",\"{1}\",\"{2}\",\"{3}\""},
           {"nr X Y Z", "{0} {1} {2} {3}"},
           {"nr,x,y,z", "{0} {1} {2} {3}"},
           {"Z\tX\tY", "{3}\t{1}\t{2}"},
           {"\tx\ty\tz", "{0}\t{1}\t{2}\t{3}"},
           {"Point name\tX Coordinate\tY Coordinate\tZ Coordinate", "P {0}\t{1}\t{2}\t{3}"},
           {"Easting, Northing, Elevation", "{1}, {2}, {3}"},
           {"Elevation,Northing,Easting", "{3},{2},{1}"},
           {"POINT_Z,POINT_X,POINT_Y", "{3},{1},{2}"},
           {"quality,height,x,y,z", "9,8,{1},{2},{3}"},
           {"A scan of four points\nid,x,y,z", "{0},{1},{2},{3}"},
           {"4\nid,x,y,z", "{0},{1},{2},{3}"},
           {"//Z X Y", "{3} {1} {2}"},
           {"# id x y z", "{0} {1} {2} {3}"},
           {"id,x,y,z,comment", "{0},{1},{2},{3},"},
       })
    expectFourPoints(std::string(header) + "\n" + lines(pattern));
}

TEST(XyzColumns, AHeaderThatDoesNotSayItIsRefused) {
  for (const auto& [header, pattern] : {
           std::pair{"a,b,c", "{1},{2},{3}"},
           {"id,u,v,w", "{0},{1},{2},{3}"},
           {"x,y,intensity", "{1},{2},{3}"},
           {"id,x,y", "{0},{1},{2}"},
           {"x,y,z,x", "{1},{2},{3},4"},
           {"id,code,x,y,z", "{0},{1},{2}"},
           {"alpha beta gamma", "{1} {2} {3}"},
       }) {
    const auto scan = loadCsv(std::string(header) + "\n" + lines(pattern));
    ASSERT_FALSE(scan) << header;
    EXPECT_EQ(scan.error().kind, ErrorKind::kInput);
    EXPECT_NE(scan.error().what.find("header"), std::string::npos) << scan.error().line();
    EXPECT_EQ(scan.error().line().find('\n'), std::string::npos);
  }
}

TEST(XyzColumns, ATitleIsNoHeader) {
  expectFourPoints("Scan of the second plate, left side\n" + lines("{1} {2} {3}"));
  expectFourPoints("plate\n" + lines("{1},{2},{3}"));
  expectFourPoints("# written by a program, z up, units: mm\n" + lines("{1} {2} {3} 255 0 0"));
}

TEST(XyzColumns, NumbersOfRowsWithoutANameAreNotTakenForX) {
  // As R writes a table: one name less than there are columns.
  const auto rows = loadCsv("x y z\n" + lines("{0} {1} {2} {3}"), "a.txt");
  ASSERT_FALSE(rows);
  EXPECT_NE(rows.error().remedy.find("name the first column"), std::string::npos) << rows.error().line();
  const auto colour = loadCsv("x y z\n" + lines("{1} {2} {3} 255"), "a.txt");
  ASSERT_TRUE(colour) << colour.error().line();
  EXPECT_EQ(heightsOf(colour->field), (std::vector<float>{1, 2, 3, 4}));
}

TEST(XyzColumns, UnitsInAHeaderAreTaken) {
  for (const char* header : {"id,x [um],y [um],z [nm]", "id,x_um,y_um,z_nm", "id,X (um),Y (um),Z (nm)",
                             "id,x,y,z\n,um,um,nm", "id,x,y,z\n,[um],[um],[nm]"}) {
    const auto scan = loadCsv(std::string(header) + "\n" + lines("{0},{1},{2},{3}"));
    ASSERT_TRUE(scan) << header << ": " << scan.error().line();
    EXPECT_EQ(scan->field.grid().lateral_unit.name, "um") << header;
    EXPECT_EQ(scan->field.grid().height_unit.name, "nm") << header;
    EXPECT_EQ(heightsOf(scan->field), (std::vector<float>{1, 2, 3, 4}));
  }
}

TEST(XyzColumns, AnEmptyFieldOfANamedColumnIsAPointLeftOut) {
  const auto scan = loadCsv("id,x,y,z\n1,0,0,5\n2,1,0,\n3,0,1,6\n4,1,1,7\n");
  ASSERT_TRUE(scan) << scan.error().line();
  EXPECT_EQ(scan->gridding->points, 3);
  EXPECT_TRUE(std::isnan(scan->field.reader().heightAt(1, 0)));
  const auto damaged = loadCsv("id,x,y,z\n1,0,0,5\n2,1,0\n");
  ASSERT_FALSE(damaged);
  EXPECT_NE(damaged.error().line().find("line 3"), std::string::npos);
}

TEST(CutText, ALastLineWithoutItsEndIsWarnedOf) {
  const TempFolder folder;
  const std::string ply =
      "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
      "end_header\n";
  const std::string pcd =
      "# .PCD v0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH 4\nHEIGHT 1\nPOINTS 4\nDATA "
      "ascii\n";
  for (const auto& [name, head] : {std::pair{"a.xyz", std::string()}, {"a.ply", ply}, {"a.pcd", pcd}}) {
    SCOPED_TRACE(name);
    const std::string whole = head + "0 0 100.25\n1 0 100.25\n0 1 100.25\n1 1 100.25\n";
    writeBytes(folder.file(name), whole);
    FETTLE_LOAD(sound, folder.file(name));
    EXPECT_FALSE(warned(sound.warnings, "cut short"));
    // Every cut inside the last number that leaves one reads as another height.
    for (std::size_t gone = 1; gone <= 6; ++gone) {
      writeBytes(folder.file(name), whole.substr(0, whole.size() - gone));
      FETTLE_LOAD(cut, folder.file(name));
      EXPECT_TRUE(
          warned(cut.warnings, "the last line has no end: the file may be cut short inside its last number"))
          << gone;
    }
  }
}

}  // namespace
}  // namespace fettle::engine
