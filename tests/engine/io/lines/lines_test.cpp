#include "engine/io/lines/lines.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string_view>

#include <gtest/gtest.h>

#include "tests/engine/io/io_support.h"
#include "tests/support/temp_folder.h"

namespace fettle::engine {
namespace {

using tests::TempFolder;

constexpr const char* kHeader =
    "line,closed,x,y,located,kind,deviation,step,step_deviation,slope_change,slope_deviation\n";

constexpr const char* kUtm32 =
    R"(PROJCS["UTM 32N",GEOGCS["WGS 84",DATUM["WGS_1984",SPHEROID["WGS 84",6378137,298.257223563]],PRIMEM["Greenwich",0],UNIT["degree",0.0174532925199433]],PROJECTION["Transverse_Mercator"],PARAMETER["latitude_of_origin",0],PARAMETER["central_meridian",9],PARAMETER["scale_factor",0.9996],PARAMETER["false_easting",500000],PARAMETER["false_northing",0],UNIT["metre",1],AUTHORITY["EPSG","32632"]])";

Version fieldOf(const Grid& grid) {
  return makeField(grid, std::vector<float>(static_cast<std::size_t>(grid.samples()), 0.0F));
}

Grid fineGrid() {
  Grid grid = gridOf(200, 120);
  grid.spacing_x = grid.spacing_y = 0.0371;
  grid.height_unit = {"um", 1e-3};
  return grid;
}

double toStep(double v) {
  return std::nearbyint(v * 0x1p20) * 0x1p-20;
}

// An open line with two runs that were not located, one of a single point away from the others, and a closed one of creases.
std::vector<EdgeLine> sampleLines() {
  std::vector<EdgeLine> lines(2);
  lines[0].id = 7;
  for (int i = 0; i < 60; ++i) {
    EdgePoint p;
    p.position = {toStep(10.0 + 1.1 * i + 0.01 * std::sin(i)),
                  toStep((i == 12 ? 26.0 : 30.0) + 5.0 * std::sin(0.1 * i))};
    p.located = i != 12 && i < 50;
    if (p.located) {
      p.deviation = 0.1 + 0.001 * i / 3.0;
      p.step = 20.0 / (i + 7.0);
      p.step_deviation = 1.0 / (i + 3.0);
      p.slope_change = -0.3 / (i + 11.0);
      p.slope_deviation = 0.01 / (i + 1.0);
    }
    lines[0].points.push_back(p);
  }
  lines[1].id = 9;
  lines[1].closed = true;
  for (int i = 0; i < 80; ++i) {
    const double angle = 2.0 * 3.14159265358979 * i / 80.0;
    EdgePoint p;
    p.position = {toStep(120.0 + 12.0 * std::cos(angle)), toStep(60.0 + 12.0 * std::sin(angle))};
    p.located = true;
    p.kind = LineKind::kCrease;
    p.deviation = 0.25;
    p.step = 1.5;
    lines[1].points.push_back(p);
  }
  return lines;
}

std::vector<glm::dvec2> positionsOf(const std::vector<EdgeLine>& lines) {
  std::vector<glm::dvec2> all;
  for (const EdgeLine& line : lines)
    for (const EdgePoint& p : line.points) all.push_back(p.position);
  return all;
}

void expectRefusedLines(const std::string& path, const std::string& part,
                        const Version& field = fieldOf(fineGrid())) {
  const auto lines = importLines(path, field);
  ASSERT_FALSE(lines) << path;
  EXPECT_EQ(lines.error().kind, ErrorKind::kInput);
  EXPECT_EQ(lines.error().where, path);
  EXPECT_NE(lines.error().line().find(part), std::string::npos) << lines.error().line();
}

class LineFormats : public ::testing::TestWithParam<const char*> {
 protected:
  [[nodiscard]] std::vector<EdgeLine> thereAndBack(const std::vector<EdgeLine>& lines,
                                                   const Grid& grid) const {
    const std::string path = folder.file(std::string("lines") + GetParam());
    const Status written = exportLines(path, lines, grid);
    EXPECT_TRUE(written) << written.error().line();
    auto read = importLines(path, fieldOf(grid));
    EXPECT_TRUE(read) << read.error().line();
    return read.value_or(std::vector<EdgeLine>());
  }
  [[nodiscard]] bool is(const char* extension) const { return GetParam() == std::string(extension); }

  TempFolder folder;
};

TEST_P(LineFormats, PositionsComeBack) {
  Grid far = fineGrid();
  far.origin_x = 4312.5;
  far.origin_y = -977.25;
  Grid metres = fineGrid();
  metres.lateral_unit = {"m", 1000.0};
  metres.spacing_x = metres.spacing_y = 0.00025;
  for (const Grid& grid : {fineGrid(), far, metres}) {
    const std::vector<EdgeLine> lines = sampleLines();
    const auto before = positionsOf(lines), after = positionsOf(thereAndBack(lines, grid));
    ASSERT_EQ(after.size(), before.size());
    for (std::size_t i = 0; i < before.size(); ++i) {
      EXPECT_NEAR(before[i].x * grid.spacingXMm(), after[i].x * grid.spacingXMm(), 1e-6);
      EXPECT_NEAR(before[i].y * grid.spacingYMm(), after[i].y * grid.spacingYMm(), 1e-6);
    }
  }
}

TEST_P(LineFormats, WhatTheFormatHoldsComesBack) {
  const std::vector<EdgeLine> lines = sampleLines();
  const std::vector<EdgeLine> back = thereAndBack(lines, fineGrid());
  std::size_t located = 0;
  for (const EdgeLine& line : back)
    for (const EdgePoint& p : line.points) located += p.located ? 1 : 0;
  EXPECT_EQ(located, 49U + 80U);
  EXPECT_TRUE(back.back().closed);
  EXPECT_FALSE(back.front().closed);
  if (is(".dxf")) return;  // neither numbers of lines nor kinds
  ASSERT_EQ(back.size(), 2U);
  EXPECT_EQ(back[0].id, 7);
  EXPECT_EQ(back[1].id, 9);
  for (const EdgePoint& p : back[1].points) {
    EXPECT_EQ(p.kind, LineKind::kCrease);
    EXPECT_NEAR(p.deviation, 0.25, 1e-12);
    EXPECT_NEAR(p.step, 1.5, 1e-12);
  }
  EXPECT_FALSE(back[0].points[12].located);
  EXPECT_EQ(back[0].points[12].deviation, 0.0);
}

// Formats of lines hold one kind for a run of points; that of most of them.
TEST_P(LineFormats, ALineOfBothKindsIsOfTheKindOfMostOfItsPoints) {
  if (is(".dxf") || is(".csv")) return;  // no kinds; the kind of each point
  for (const std::size_t creases : {0U, 1U, 39U, 41U, 80U}) {
    std::vector<EdgeLine> lines{sampleLines()[1]};
    for (std::size_t i = 0; i < lines[0].points.size(); ++i)
      lines[0].points[i].kind = i < creases ? LineKind::kCrease : LineKind::kStep;
    const std::vector<EdgeLine> back = thereAndBack(lines, fineGrid());
    ASSERT_EQ(back.size(), 1U);
    for (const EdgePoint& p : back[0].points)
      EXPECT_EQ(p.kind, creases > 40 ? LineKind::kCrease : LineKind::kStep) << creases;
  }
}

TEST_P(LineFormats, CoordinateSystemsArePlaces) {
  Grid grid = fineGrid();
  grid.lateral_unit = {"m", 1000.0};
  grid.spacing_x = grid.spacing_y = 0.5;
  grid.origin_x = 412345.5;
  grid.origin_y = 5311234.25;
  grid.crs_wkt = kUtm32;
  const std::vector<EdgeLine> lines = sampleLines();
  const auto before = positionsOf(lines), after = positionsOf(thereAndBack(lines, grid));
  ASSERT_EQ(after.size(), before.size());
  // The file has metres from far away: 5e-9 m is what DXF's 15 digits leave.
  for (std::size_t i = 0; i < before.size(); ++i)
    EXPECT_LT(std::hypot(before[i].x - after[i].x, before[i].y - after[i].y), 2e-6);
  if (!is(".geojson")) return;
  EXPECT_NE(readBytes(folder.file("lines.geojson")).find("5311249."), std::string::npos);
}

TEST_P(LineFormats, OfAnotherCoordinateSystemAreRefused) {
  if (is(".csv") || is(".dxf")) return;  // they have none
  const std::string path = folder.file(std::string("lines") + GetParam());
  Grid grid = fineGrid();
  grid.lateral_unit = {"m", 1000.0};
  grid.crs_wkt = kUtm32;
  ASSERT_TRUE(exportLines(path, sampleLines(), grid));
  EXPECT_TRUE(importLines(path, fieldOf(grid)));
  const auto set = [&](const char* old, const char* now) {
    grid.crs_wkt.replace(grid.crs_wkt.find(old), std::string_view(old).size(), now);
  };
  set("UTM 32N", "UTM 33N");
  set("\"central_meridian\",9", "\"central_meridian\",15");
  set("32632", "32633");
  const auto lines = importLines(path, fieldOf(grid));
  ASSERT_FALSE(lines);
  EXPECT_NE(lines.error().what.find("the scan is in UTM 33N"), std::string::npos) << lines.error().what;
  grid.crs_wkt.clear();
  EXPECT_TRUE(importLines(path, fieldOf(grid)));
}

TEST_P(LineFormats, AreRecognisedByTheirFirstBytes) {
  const std::string path = folder.file(std::string("lines") + GetParam());
  ASSERT_TRUE(exportLines(path, sampleLines(), fineGrid()));
  const std::string bytes = readBytes(path);
  EXPECT_EQ(lineExtensionOf(bytes.substr(0, 64)), is(".json") ? ".geojson" : GetParam());
  for (std::size_t length = 0; length < 64; ++length) (void)lineExtensionOf(bytes.substr(0, length));
  EXPECT_EQ(lineExtensionOf("\x89PNG"), "");
}

// What other programs style and select lines by.
TEST(LineFiles, OfGeoJsonSayOfEachRunWhatItIs) {
  const TempFolder folder;
  const std::string path = folder.file("lines.geojson");
  ASSERT_TRUE(exportLines(path, sampleLines(), fineGrid()));
  const std::string text = readBytes(path);
  const auto times = [&](std::string_view part) {
    int n = 0;
    for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++n;
    return n;
  };
  const int runs = times("\"Feature\"");
  EXPECT_GE(runs, 4);
  EXPECT_EQ(times("\"line\": 7") + times("\"line\": 9"), runs);
  EXPECT_EQ(times("\"closed\": 1"), 1);
  EXPECT_EQ(times("\"closed\": 0"), runs - 1);
  EXPECT_EQ(times("\"located\": 1") + times("\"located\": 0"), runs);
  EXPECT_EQ(times("\"kind\": \"crease\""), 1);
  EXPECT_EQ(times("\"kind\": \"step\""), runs - 1);
  EXPECT_EQ(times("\"deviation\": "), runs);
  EXPECT_EQ(times("\"step\": "), runs);
}

TEST(LineFiles, OfASpreadsheetHaveSemicolons) {
  const TempFolder folder;
  const std::string path = folder.file("lines.csv");
  ASSERT_TRUE(exportLines(path, sampleLines(), fineGrid()));
  std::string text = readBytes(path);
  const auto before = importLines(path, fieldOf(fineGrid()));
  ASSERT_TRUE(before);
  std::ranges::replace(text, ',', ';');
  writeBytes(path, text);
  const auto after = importLines(path, fieldOf(fineGrid()));
  ASSERT_TRUE(after) << after.error().line();
  EXPECT_EQ(positionsOf(*after), positionsOf(*before));
  // A decimal comma is refused with its line.
  const std::size_t point = text.find('.');
  text[point] = ',';
  writeBytes(path, text);
  const auto comma = importLines(path, fieldOf(fineGrid()));
  ASSERT_FALSE(comma);
  EXPECT_NE(comma.error().what.find("line 2: x = "), std::string::npos) << comma.error().what;
}

TEST_P(LineFormats, FilesCutAnywhereAreRefusedOrHaveLines) {
  const std::string path = folder.file(std::string("lines") + GetParam());
  ASSERT_TRUE(exportLines(path, sampleLines(), fineGrid()));
  const std::string whole = readBytes(path);
  const std::size_t total = positionsOf(sampleLines()).size();
  const Version field = fieldOf(fineGrid());
  for (std::size_t length = 0; length < whole.size(); length += 1 + whole.size() / 97) {
    writeBytes(path, whole.substr(0, length));
    const auto lines = importLines(path, field);
    if (lines) {
      EXPECT_LE(positionsOf(*lines).size(), total) << length;
    } else {
      EXPECT_EQ(lines.error().kind, ErrorKind::kInput) << length;
    }
  }
}

TEST_P(LineFormats, DamagedBytesNeverCrash) {
  const std::string path = folder.file(std::string("lines") + GetParam());
  ASSERT_TRUE(exportLines(path, sampleLines(), fineGrid()));
  const std::string whole = readBytes(path);
  const Version field = fieldOf(fineGrid());
  for (std::size_t i = 0; i < 120; ++i) {
    std::string damaged = whole;
    for (std::size_t k = 0; k < 3; ++k)
      damaged[(i * 7919 + k * 104729) % damaged.size()] = static_cast<char>("9e-,]\n\x80\0"[(i + k) % 8]);
    writeBytes(path, damaged);
    const auto lines = importLines(path, field);
    EXPECT_TRUE(lines || lines.error().kind == ErrorKind::kInput);
  }
}

TEST_P(LineFormats, NothingIsWrittenToAPlaceThatIsNone) {
  const std::string path = folder.file(std::string("none/lines") + GetParam());
  const Status written = exportLines(path, sampleLines(), fineGrid());
  ASSERT_FALSE(written);
  EXPECT_EQ(written.error().kind, ErrorKind::kInput);
}

INSTANTIATE_TEST_SUITE_P(Extensions, LineFormats,
                         ::testing::Values(".csv", ".geojson", ".json", ".gpkg", ".dxf"),
                         [](const auto& format) { return std::string(format.param).substr(1); });

TEST(LineCsv, EveryValueIsBitIdentical) {
  const TempFolder folder;
  const std::string path = folder.file("lines.csv");
  Grid grid = fineGrid();
  grid.spacing_y = 0.0519;
  std::vector<EdgeLine> lines = sampleLines();
  lines.push_back(lines[0]);  // with the same number, next to each other
  lines.push_back(lines[0]);
  ASSERT_TRUE(exportLines(path, lines, grid));
  const auto back = importLines(path, fieldOf(grid));
  ASSERT_TRUE(back) << back.error().line();
  ASSERT_EQ(back->size(), lines.size());
  for (std::size_t l = 0; l < lines.size(); ++l) {
    EXPECT_EQ((*back)[l].id, lines[l].id);
    EXPECT_EQ((*back)[l].closed, lines[l].closed);
    ASSERT_EQ((*back)[l].points.size(), lines[l].points.size());
    for (std::size_t i = 0; i < lines[l].points.size(); ++i) {
      const EdgePoint &a = lines[l].points[i], &b = (*back)[l].points[i];
      EXPECT_EQ(a.position, b.position);
      EXPECT_EQ(a.located, b.located);
      EXPECT_EQ(a.kind, b.kind);
      EXPECT_EQ(a.deviation, b.deviation);
      EXPECT_EQ(a.step, b.step);
      EXPECT_EQ(a.step_deviation, b.step_deviation);
      EXPECT_EQ(a.slope_change, b.slope_change);
      EXPECT_EQ(a.slope_deviation, b.slope_deviation);
    }
  }
}

TEST(LineCsv, WhatIsNoLineIsRefused) {
  const TempFolder folder;
  const std::string path = folder.file("lines.csv");
  const auto refused = [&](const std::string& rows, const std::string& part) {
    writeBytes(path, kHeader + rows);
    expectRefusedLines(path, part);
  };
  refused("", "no line");
  refused("1,0,1,1,1,step,0,0,0,0\n", "columns");
  refused("1,0,1,1,1,step,0,0,0,0,0,0\n", "columns");
  refused("1,0,1,1,1,step,0,0,0,0,0", "cut short");
  refused("1,0,nan,1,1,step,0,0,0,0,0\n", "line 2: a number is not finite");
  refused("1,0,1,inf,1,step,0,0,0,0,0\n", "not finite");
  refused("1,0,1,1,1,step,nan,0,0,0,0\n", "not finite");
  refused("1,0,1e300,1,1,step,0,0,0,0,0\n", "outside the scan");
  refused("1,0,1e9999,1,1,step,0,0,0,0,0\n", "x = ");
  refused("1,0,1,1,1,step,-1,0,0,0,0\n", "below 0");
  refused("1,0,1,1,1,wall,0,0,0,0,0\n", "kind = \"wall\"");
  refused("1,2,1,1,1,step,0,0,0,0,0\n", "closed");
  refused("99999999999999999999,0,1,1,1,step,0,0,0,0,0\n", "line = ");
  writeBytes(path, "t,x,y,z,tool\n0,1,2,3,mark\n");
  expectRefusedLines(path, "header");
  refused("1,0,-2.5,1,1,step,0,0,0,0,0\n1,0,-2,1,1,step,0,0,0,0,0\n", "no point lies in the scan");
}

TEST(LineCsv, AMarkOfUtf8IsPassedOver) {
  const TempFolder folder;
  const std::string path = folder.file("lines.csv");
  writeBytes(path,
             "\xEF\xBB\xBF" + std::string(kHeader) + "1,0,1,1,1,step,0,0,0,0,0\n1,0,2,1,1,step,0,0,0,0,0\n");
  const auto lines = importLines(path, fieldOf(gridOf(8, 8)));
  ASSERT_TRUE(lines) << lines.error().line();
  EXPECT_EQ(lines->size(), 1U);
}

TEST(LineCsv, TooManyPointsAreRefusedBeforeTheyAreInserted) {
  const TempFolder folder;
  const std::string path = folder.file("lines.csv");
  Grid grid = gridOf(2, 2);
  std::string rows = kHeader;
  for (int i = 0; i < 3000; ++i)
    rows += i % 2 == 0 ? "1,0,-1000,0,1,step,0,0,0,0,0\n" : "1,0,1000,0,1,step,0,0,0,0,0\n";
  writeBytes(path, rows);
  expectRefusedLines(path, "more than", fieldOf(grid));
}

constexpr const char* kForeign =
    R"({"type":"FeatureCollection","features":[{"type":"Feature","properties":{"name":"wall"},"geometry":{"type":"%s","coordinates":%s}}]})";

std::string foreign(const char* type, const char* coordinates) {
  std::string text = kForeign;
  text.replace(text.find("%s"), 2, type);
  return text.replace(text.find("%s"), 2, coordinates);
}

TEST(LineImport, LinesOfOtherProgramsGetPointsInBetween) {
  const TempFolder folder;
  const std::string path = folder.file("lines.geojson");
  const Version field = fieldOf(gridOf(100, 100));
  writeBytes(path, foreign("LineString", "[[10,10],[50,40.5],[51,40.5]]"));
  const auto lines = importLines(path, field);
  ASSERT_TRUE(lines) << lines.error().line();
  ASSERT_EQ(lines->size(), 1U);
  const EdgeLine& line = lines->front();
  EXPECT_FALSE(line.closed);
  EXPECT_EQ(line.points.front().position, glm::dvec2(10, 10));
  EXPECT_EQ(line.points.back().position, glm::dvec2(51, 40.5));
  for (std::size_t i = 0; i < line.points.size(); ++i) {
    const EdgePoint& p = line.points[i];
    EXPECT_TRUE(p.located);
    EXPECT_EQ(p.kind, LineKind::kStep);
    EXPECT_EQ(p.deviation, 0.0);
    EXPECT_EQ(p.position.x, toStep(p.position.x));
    if (i > 0) {
      const glm::dvec2 d = p.position - line.points[i - 1].position;
      EXPECT_LE(std::hypot(d.x, d.y), 1.0 + 1e-5);
      EXPECT_GT(std::hypot(d.x, d.y), 0.5);
    }
  }
  // Rings, and several lines in one feature.
  writeBytes(path, foreign("MultiLineString", "[[[10,10],[20,10],[20,20],[10,10]],[[1,1],[2,2]]]"));
  const auto several = importLines(path, field);
  ASSERT_TRUE(several) << several.error().line();
  ASSERT_EQ(several->size(), 2U);
  EXPECT_TRUE((*several)[0].closed);
  EXPECT_FALSE((*several)[1].closed);
  const EdgeLine& ring = (*several)[0];
  const glm::dvec2 gap = ring.points.back().position - ring.points.front().position;
  EXPECT_LE(std::hypot(gap.x, gap.y), 1.0 + 1e-5);
  EXPECT_GT(std::hypot(gap.x, gap.y), 0.0);
}

TEST(LineImport, WhatIsNoLineIsRefused) {
  const TempFolder folder;
  const std::string path = folder.file("lines.geojson");
  writeBytes(path, foreign("Point", "[1,1]"));
  expectRefusedLines(path, "feature 1 is no line: Point");
  writeBytes(path, foreign("Polygon", "[[[1,1],[2,1],[2,2],[1,1]]]"));
  expectRefusedLines(path, "Polygon");
  writeBytes(path, R"({"type":"FeatureCollection","features":[]})");
  expectRefusedLines(path, "no line");
  writeBytes(path, foreign("LineString", "[[1,1],[412345,5311234]]"));
  expectRefusedLines(path, "outside the scan");
  writeBytes(path, foreign("LineString", "[[1,1],[1e400,2]]"));
  expectRefusedLines(path, "");
  writeBytes(path, "not a file of lines");
  expectRefusedLines(path, "cannot be opened");
  writeBytes(path, "");
  expectRefusedLines(path, "empty");
  expectRefusedLines(folder.file("missing.gpkg"), "cannot be read");
  expectRefusedLines(folder.file("lines.shp"), ".geojson");
  const Status written = exportLines(folder.file("lines.shp"), sampleLines(), fineGrid());
  ASSERT_FALSE(written);
  EXPECT_NE(written.error().line().find(".shp is not a format of lines"), std::string::npos);
}

TEST(LineImport, BlocksOfADxfAreNotFollowed) {
  const TempFolder folder;
  const std::string path = folder.file("lines.dxf");
  std::string text =
      "0\nSECTION\n2\nHEADER\n0\nENDSEC\n0\nSECTION\n2\nBLOCKS\n0\nBLOCK\n2\nb0\n0\nLINE\n8\n0\n10\n1\n20\n1"
      "\n11\n2\n21\n2\n0\nENDBLK\n";
  for (int i = 1; i < 40; ++i) {
    const std::string insert = "0\nINSERT\n2\nb" + std::to_string(i - 1) + "\n10\n0\n20\n0\n";
    text += "0\nBLOCK\n2\nb" + std::to_string(i) + "\n" + insert + insert + "0\nENDBLK\n";
  }
  text += "0\nENDSEC\n0\nSECTION\n2\nENTITIES\n0\nINSERT\n2\nb39\n10\n0\n20\n0\n0\nENDSEC\n0\nEOF\n";
  writeBytes(path, text);
  expectRefusedLines(path, "no line: Point");
}

TEST(Lines, ACancelledJobEndsTheReading) {
  const TempFolder folder;
  const Version field = fieldOf(gridOf(8, 8));
  const std::vector<EdgeLine> lines{{0, false, {{.position = {1.0, 1.0}}, {.position = {2.0, 1.0}}}}};
  for (const std::string_view extension : kLineExtensions) {
    const std::string path = folder.file("lines" + std::string(extension));
    ASSERT_TRUE(exportLines(path, lines, field.grid())) << extension;
    JobControl job;
    EXPECT_TRUE(importLines(path, field, &job)) << extension;
    job.cancel();
    const auto read = importLines(path, field, &job);
    ASSERT_FALSE(read) << extension;
    EXPECT_EQ(read.error().kind, ErrorKind::kCancelled) << extension;
  }
}

}  // namespace
}  // namespace fettle::engine
