// Files of instruments, made here byte by byte as their specifications have them: .sur, .las, .pcd and the
// pictures of depth cameras.

#include <cmath>
#include <cstring>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "tests/engine/io/io_support.h"
#include "tests/engine/io/surface/instrument_files.h"
#include "tests/support/temp_folder.h"

namespace fettle::engine {
namespace {

using tests::TempFolder;

Result<Imported> loadBytes(const std::string& name, const std::string& bytes, const ImportOptions& o = {}) {
  const TempFolder folder;
  writeBytes(folder.file(name), bytes);
  return load(folder.file(name), o);
}

#define FETTLE_LOAD_BYTES(var, ...)             \
  const auto var##_ = loadBytes(__VA_ARGS__);   \
  ASSERT_TRUE(var##_) << var##_.error().line(); \
  [[maybe_unused]] const Imported& var = *var##_

std::string refused(const std::string& name, const std::string& bytes) {
  const auto scan = loadBytes(name, bytes);
  EXPECT_FALSE(scan) << name;
  if (scan) return {};
  EXPECT_EQ(scan.error().kind, ErrorKind::kInput) << scan.error().line();
  return scan.error().what;
}

TEST(Sur, SixteenAndThirtyTwoBitsPlainAndPackedGiveTheSameSurface) {
  for (const std::string& bytes : {sur<std::int16_t>(false), sur<std::int16_t>(true),
                                   sur<std::int32_t>(false), sur<std::int32_t>(true)}) {
    FETTLE_LOAD_BYTES(scan, "a.sur", bytes);
    EXPECT_EQ(scan.format, "SUR");
    const Grid& grid = scan.field.grid();
    ASSERT_EQ(grid.width, 3);
    ASSERT_EQ(grid.height, 2);
    EXPECT_EQ(grid.spacing_x, 0.25);
    EXPECT_EQ(grid.spacing_y, 0.1);
    EXPECT_EQ(grid.origin_x, 5.5);
    EXPECT_EQ(grid.origin_y, -2.0);
    EXPECT_EQ(grid.lateral_unit.name, "mm");
    EXPECT_EQ(grid.height_unit, (LengthUnit{"um", 1e-3}));
    EXPECT_EQ(grid.height_per_count, 0.01);
    EXPECT_EQ(stored(scan.field, 0, 0), static_cast<float>(-300 * 0.01 + 1.0));
    EXPECT_TRUE(std::isnan(stored(scan.field, 0, 2)));
    EXPECT_EQ(stored(scan.field, 1, 2), static_cast<float>(300 * 0.01 + 1.0));
    EXPECT_TRUE(scan.warnings.empty()) << scan.warnings.front();
  }
}

TEST(Sur, LyingHeadersAndCutFilesAreRefused) {
  const std::string whole = sur<std::int32_t>(false);
  EXPECT_NE(refused("a.sur", whole.substr(0, 300)).find("cut short"), std::string::npos);
  EXPECT_NE(refused("a.sur", whole.substr(0, whole.size() - 1)).find("ends before"), std::string::npos);
  const auto lying = [](std::string bytes, std::size_t at, auto value) {
    put(bytes, at, value);
    return bytes;
  };
  EXPECT_NE(refused("a.sur", lying(whole, 18, std::int16_t{1})).find("no surface"), std::string::npos);
  EXPECT_NE(refused("a.sur", lying(whole, 14, std::int16_t{4})).find("4 surfaces"), std::string::npos);
  EXPECT_NE(refused("a.sur", lying(whole, 98, std::int16_t{7})).find("7 bits"), std::string::npos);
  EXPECT_NE(refused("a.sur", lying(whole, 12, std::int16_t{1})).find("byte order"), std::string::npos);
  refused("a.sur", lying(whole, 108, std::int32_t{-3}));
  refused("a.sur", lying(whole, 120, std::numeric_limits<float>::quiet_NaN()));
  // 2^31 samples, agreeing with each other.
  for (const bool packed : {false, true}) {
    std::string huge = sur<std::int32_t>(packed);
    put<std::int32_t>(huge, 108, 46340);
    put<std::int32_t>(huge, 112, 46340);
    put<std::int32_t>(huge, 116, 46340 * 46340);
    refused("a.sur", huge);
  }
  const std::string packed = sur<std::int16_t>(true);
  refused("a.sur", lying(packed, 522, std::uint32_t{0xffffffffU}));  // streams
  refused("a.sur", lying(packed, 526, std::uint32_t{0xffffffffU}));  // bytes of the first
  for (std::size_t bytes = 0; bytes < packed.size(); bytes += 3) refused("a.sur", packed.substr(0, bytes));
}

TEST(Sur, HeightsThatAreNoLengthsAreNamed) {
  std::string bytes = sur<std::int32_t>(false);
  bytes.replace(212, 4, std::string("V\0\0\0", 4));
  FETTLE_LOAD_BYTES(volts, "a.sur", bytes);
  EXPECT_EQ(volts.field.grid().height_unit.name, "V");
  EXPECT_TRUE(warned(volts.warnings, "\"V\", which is not a length"));
}

const std::vector<LasPoint> kFourPoints{{0, 0, 1000}, {1, 0, -2000}, {0, 1, 3000}, {1, 1, 4001}};

TEST(Las, VersionsAndPointFormatsGiveTheSameField) {
  for (const auto& [minor, format, bytes] :
       {std::tuple{2, 0, 20}, {2, 3, 34}, {3, 1, 31}, {4, 6, 30}, {4, 8, 40}}) {
    FETTLE_LOAD_BYTES(scan, "a.las", las(minor, format, bytes, kFourPoints));
    EXPECT_EQ(scan.format, "LAS");
    EXPECT_EQ(heightsOf(scan.field), (std::vector<float>{1.0F, -2.0F, 3.0F, 4.001F}));
    EXPECT_EQ(scan.field.grid().spacing_x, 0.5);
    EXPECT_EQ(scan.field.grid().origin_y, -4000000.0);
    EXPECT_TRUE(warned(scan.warnings, "states no unit"));
  }
}

TEST(Las, TheCoordinateSystemComesAlong) {
  const std::string wkt =
      R"(PROJCS["test",GEOGCS["WGS 84",DATUM["WGS_1984",SPHEROID["WGS 84",6378137,298.257223563]],)"
      R"(PRIMEM["Greenwich",0],UNIT["degree",0.0174532925199433]],PROJECTION["Transverse_Mercator"],)"
      R"(PARAMETER["latitude_of_origin",0],PARAMETER["central_meridian",9],PARAMETER["scale_factor",0.9996],)"
      R"(PARAMETER["false_easting",500000],PARAMETER["false_northing",0],UNIT["foot",0.3048]])";
  FETTLE_LOAD_BYTES(scan, "a.las", las(4, 6, 30, kFourPoints, wkt));
  EXPECT_EQ(scan.field.grid().crs_wkt, wkt);
  EXPECT_EQ(scan.field.grid().lateral_unit.name, "ft");
  EXPECT_TRUE(scan.warnings.empty()) << scan.warnings.front();
  FETTLE_LOAD_BYTES(nonsense, "a.las", las(4, 6, 30, kFourPoints, "PROJCS[[[nothing"));
  EXPECT_TRUE(nonsense.field.grid().crs_wkt.empty());
  EXPECT_TRUE(warned(nonsense.warnings, "states no unit"));
}

// Files of version 1.2, as most are, have no WKT.
TEST(Las, KeysAloneNameTheCoordinateSystem) {
  const std::string plain = las(2, 3, 34, kFourPoints);
  const auto keyed = [&](const std::vector<std::array<std::uint16_t, 4>>& keys) {
    return withLasRecord(plain, 34735, geoKeys(keys));
  };
  FETTLE_LOAD_BYTES(utm, "a.las", keyed({{1024, 0, 1, 1}, {1025, 0, 1, 1}, {3072, 0, 1, 32633}}));
  EXPECT_NE(utm.field.grid().crs_wkt.find("UTM zone 33N"), std::string::npos) << utm.field.grid().crs_wkt;
  EXPECT_EQ(utm.field.grid().lateral_unit.name, "m");
  EXPECT_EQ(utm.field.grid().height_unit.name, "m");
  EXPECT_TRUE(utm.warnings.empty()) << utm.warnings.front();

  // Feet across, a vertical system in metres.
  FETTLE_LOAD_BYTES(feet, "b.las", keyed({{1024, 0, 1, 1}, {3072, 0, 1, 2994}, {4096, 0, 1, 5703}}));
  EXPECT_NE(feet.field.grid().crs_wkt.find("NAVD88"), std::string::npos) << feet.field.grid().crs_wkt;
  EXPECT_EQ(feet.field.grid().lateral_unit.name, "ft");
  EXPECT_EQ(feet.field.grid().height_unit.name, "m");

  // A system of its own: its parameters lie in the record of numbers, its name in that of texts.
  std::string numbers;
  for (const double n : {9.25, 0.9996, 500000.0}) append(numbers, n);
  const std::string own = withLasRecord(withLasRecord(keyed({{1024, 0, 1, 1},
                                                             {1026, 34737, 8, 0},
                                                             {2048, 0, 1, 4326},
                                                             {3072, 0, 1, 32767},
                                                             {3074, 0, 1, 32767},
                                                             {3075, 0, 1, 1},
                                                             {3076, 0, 1, 9002},
                                                             {3080, 34736, 1, 0},
                                                             {3081, 34736, 1, 0},
                                                             {3082, 34736, 1, 2},
                                                             {3092, 34736, 1, 1}}),
                                                      34736, numbers),
                                        34737, "quarry 7|");
  FETTLE_LOAD_BYTES(quarry, "c.las", own);
  EXPECT_NE(quarry.field.grid().crs_wkt.find("9.25"), std::string::npos) << quarry.field.grid().crs_wkt;
  EXPECT_EQ(quarry.field.grid().lateral_unit.name, "ft");

  FETTLE_LOAD_BYTES(degrees, "d.las", keyed({{1024, 0, 1, 2}, {2048, 0, 1, 4326}}));
  EXPECT_EQ(degrees.field.grid().lateral_unit.name, "deg");
  EXPECT_EQ(degrees.field.grid().height_unit.name, "m");

  // Of keys that name no system, or lie about where their values are, the unit is kept.
  FETTLE_LOAD_BYTES(unit, "e.las", keyed({{1024, 0, 1, 1}, {3076, 0, 1, 9003}}));
  EXPECT_EQ(unit.field.grid().lateral_unit.name, "ftUS");
  EXPECT_EQ(unit.field.grid().crs_wkt, "");
  EXPECT_TRUE(warned(unit.warnings, "only its unit is used"));
  FETTLE_LOAD_BYTES(lying, "f.las", keyed({{1024, 0, 1, 1}, {3072, 0, 1, 32767}, {3080, 34736, 9, 60000}}));
  EXPECT_EQ(lying.field.grid().crs_wkt, "");
}

// LAS 1.4 - R15, "global encoding": bit 4 says that WKT holds, else keys do.
TEST(Las, OfKeysAndWktTheOneThatTheHeaderSaysHoldsAndADifferenceIsSaid) {
  const std::string wkt =
      R"(PROJCS["WGS 84 / UTM zone 32N",GEOGCS["WGS 84",DATUM["WGS_1984",SPHEROID["WGS 84",6378137,298.257223563]],)"
      R"(PRIMEM["Greenwich",0],UNIT["degree",0.0174532925199433]],PROJECTION["Transverse_Mercator"],)"
      R"(PARAMETER["latitude_of_origin",0],PARAMETER["central_meridian",9],PARAMETER["scale_factor",0.9996],)"
      R"(PARAMETER["false_easting",500000],PARAMETER["false_northing",0],UNIT["metre",1]])";
  const auto both = [&](int minor, std::uint16_t zone, bool wkt_holds) {
    std::string bytes =
        withLasRecord(las(minor, 3, 34, kFourPoints, wkt), 34735,
                      geoKeys({{1024, 0, 1, 1}, {1025, 0, 1, 1}, {3072, 0, 1, zone}, {4096, 0, 1, 5703}}));
    put<std::uint16_t>(bytes, 6, wkt_holds ? 0x10 : 0);
    return bytes;
  };
  for (const int minor : {2, 4}) {
    FETTLE_LOAD_BYTES(keys, "a.las", both(minor, 32633, false));
    EXPECT_NE(keys.field.grid().crs_wkt.find("zone 33N"), std::string::npos) << keys.field.grid().crs_wkt;
    EXPECT_TRUE(warned(keys.warnings, "names two coordinate systems"));
    EXPECT_TRUE(warned(keys.warnings, "in GeoTIFF keys and WGS 84 / UTM zone 32N in WKT"))
        << keys.warnings.front();
  }
  FETTLE_LOAD_BYTES(text, "b.las", both(4, 32633, true));
  EXPECT_NE(text.field.grid().crs_wkt.find("zone 32N"), std::string::npos) << text.field.grid().crs_wkt;
  EXPECT_TRUE(warned(text.warnings, "names two coordinate systems"));
  // A vertical system that only one of them has is no difference.
  FETTLE_LOAD_BYTES(same, "c.las", both(2, 32632, false));
  EXPECT_TRUE(same.warnings.empty()) << same.warnings.front();
}

TEST(Las, DegreesBeyondThePolesAreDoubtedAndNotComputedWith) {
  std::string bytes =
      withLasRecord(las(2, 3, 34, kFourPoints), 34735, geoKeys({{1024, 0, 1, 2}, {2048, 0, 1, 4326}}));
  put<double>(bytes, 195, 4500100.0);
  put<double>(bytes, 203, 4500000.0);
  FETTLE_LOAD_BYTES(scan, "a.las", bytes);
  EXPECT_EQ(scan.field.grid().lateral_unit.name, "m");
  EXPECT_TRUE(warned(scan.warnings, "coordinates that are no degrees?"));
  EXPECT_TRUE(warned(scan.warnings, "latitude 4500050"));
  EXPECT_FALSE(warned(scan.warnings, "1 deg taken as"));
}

TEST(Las, PackedPointsAreRefusedByName) {
  const TempFolder folder;
  writeBytes(folder.file("a.laz"), las(2, 0x80 | 3, 34, kFourPoints));
  const auto scan = load(folder.file("a.laz"));
  ASSERT_FALSE(scan);
  EXPECT_NE(scan.error().what.find("LAZ"), std::string::npos);
  // A command to type, not a library.
  EXPECT_NE(scan.error().remedy.find("pdal translate IN.laz OUT.las"), std::string::npos);
  EXPECT_NE(scan.error().remedy.find("las2las -i"), std::string::npos);
}

TEST(Las, LyingHeadersAreRefused) {
  const std::string whole = las(4, 6, 30, kFourPoints);
  const auto lying = [&](std::size_t at, auto value) {
    std::string bytes = whole;
    put(bytes, at, value);
    return bytes;
  };
  for (std::size_t bytes = 4; bytes < whole.size(); bytes += 13) refused("a.las", whole.substr(0, bytes));
  refused("a.las", lying(247, std::uint64_t{1} << 63));
  refused("a.las", lying(247, std::uint64_t{0}));
  refused("a.las", lying(105, std::uint16_t{0}));
  refused("a.las", lying(104, std::uint8_t{11}));
  refused("a.las", lying(96, std::uint32_t{0xffffffffU}));
  refused("a.las", lying(96, std::uint32_t{0}));
  refused("a.las", lying(131, 0.0));
  refused("a.las", lying(131, std::numeric_limits<double>::infinity()));
  refused("a.las", lying(25, std::uint8_t{9}));
}

TEST(Pcd, EveryEncodingAndOrderOfFieldsGivesTheSameField) {
  std::vector<std::array<double, 3>> points;
  for (int r = 0; r < 7; ++r)
    for (int c = 0; c < 9; ++c) points.push_back({5000000.0 + 0.25 * c, -3.0 + 0.1 * r, c * 0.3 - r * r});
  for (const std::string data : {"ascii", "binary", "binary_compressed"})
    for (const int width : {63, 9}) {  // a heap of points, and rows of them
      FETTLE_LOAD_BYTES(scan, "a.pcd", pcd(data, points, width));
      EXPECT_EQ(scan.format, "PCD");
      const Grid& grid = scan.field.grid();
      ASSERT_EQ(grid.width, 9) << data << width;
      ASSERT_EQ(grid.height, 7);
      EXPECT_EQ(grid.spacing_x, 0.25);
      EXPECT_EQ(grid.spacing_y, 0.1);
      EXPECT_EQ(grid.origin_x, 5000000.0);
      EXPECT_TRUE(scan.gridding->lattice);
      for (std::size_t i = 0; i < points.size(); ++i)
        ASSERT_EQ(heightsOf(scan.field)[i], static_cast<float>(points[i][2]));
    }
}

TEST(Pcd, RowsOfACameraStayItsPixels) {
  constexpr double cx = 15.5, cy = 9.0;
  const DepthCamera camera{500.0, 510.0, cx, cy};
  std::vector<std::array<double, 3>> points;
  for (int v = 0; v < 20; ++v)
    for (int u = 0; u < 30; ++u) {
      const double z = u == 3 ? double{kNan} : 1.0 + 0.01 * ((u * 7 + v * 3) % 11);
      points.push_back({(u - cx) * z / camera.fx, (v - cy) * z / camera.fy, z});
    }
  FETTLE_LOAD_BYTES(scan, "a.pcd", pcd("binary_compressed", points, 30));
  ASSERT_EQ(scan.field.grid().width, 30);
  ASSERT_EQ(scan.field.grid().height, 20);
  EXPECT_TRUE(scan.in_perspective);
  EXPECT_TRUE(warned(scan.warnings, "perspective"));
  EXPECT_TRUE(warned(scan.warnings, "fx 500, fy 510, cx 15.5, cy 9"));
  for (int v = 0; v < 20; ++v)
    for (int u = 0; u < 30; ++u) {
      const auto z = static_cast<float>(points[static_cast<std::size_t>(v * 30 + u)][2]);
      if (std::isnan(z))
        ASSERT_TRUE(std::isnan(stored(scan.field, v, u)));
      else
        ASSERT_EQ(stored(scan.field, v, u), z);
    }
  EXPECT_NEAR(scan.field.grid().spacing_x, 1.05 / 500.0, 1e-4);
  // Asked for cells, it is gridded from above like any cloud.
  ImportOptions cells;
  cells.cell_size = 0.01;
  FETTLE_LOAD_BYTES(above, "a.pcd", pcd("binary", points, 30), cells);
  EXPECT_TRUE(above.gridding.has_value());
  EXPECT_FALSE(above.in_perspective);
  EXPECT_FALSE(warned(above.warnings, "perspective"));
}

TEST(Pcd, LyingHeadersAreRefused) {
  const std::vector<std::array<double, 3>> points{{0, 0, 1}, {1, 0, 2}};
  const auto with = [&](const std::string& data, const std::string& what, const std::string& by) {
    std::string bytes = pcd(data, points, 2);
    bytes.replace(bytes.find(what), what.size(), by);
    return bytes;
  };
  for (const std::string data : {"ascii", "binary", "binary_compressed"}) {
    refused("a.pcd", with(data, "POINTS 2", "POINTS 2147483648"));
    refused("a.pcd", with(data, "POINTS 2", "POINTS 18446744073709551615"));
    refused("a.pcd", with(data, "POINTS 2", "POINTS -2"));
    refused("a.pcd", with(data, "COUNT 1 1 1 2 1", "COUNT 1 1 1 99999999999 1"));
    refused("a.pcd", with(data, "SIZE 1 4 8 4 8", "SIZE 1 4 8 4"));
    refused("a.pcd", with(data, "SIZE 1 4 8 4 8", "SIZE 1 3 8 4 8"));
    refused("a.pcd", with(data, "label z x", "label w x"));
    refused("a.pcd", with(data, "DATA", "DATUM"));
    const std::string whole = pcd(data, points, 2);
    refused("a.pcd", whole.substr(0, whole.size() - 6));
  }
  // A packing that promises 4 GB.
  std::string bomb = with("binary_compressed", "POINTS 2", "POINTS 143165576");
  put<std::uint32_t>(bomb, bomb.find("binary_compressed\n") + 22, 4294967280U);
  refused("a.pcd", bomb);
}

TEST(DepthCamera, APictureKeepsItsDistancesAndGetsThePitchOfItsPixels) {
  const TempFolder folder;
  std::vector<float> counts;
  for (int i = 0; i < 40 * 30; ++i)
    counts.push_back(i % 17 == 0 ? kNan : 1000.0F + static_cast<float>(i % 3));
  Grid grid = gridOf(40, 30);
  grid.height_per_count = 1.0;
  for (const std::string name : {"depth.png", "depth.tif"}) {
    ASSERT_TRUE(save(makeField(grid, counts), folder.file(name)));
    ImportOptions options;
    options.depth_camera = DepthCamera{500.0, 250.0, 19.5, 10.0};
    FETTLE_LOAD(scan, folder.file(name), options);
    EXPECT_EQ(scan.field.grid().spacing_x, 1001.0 / 500.0) << name;
    EXPECT_EQ(scan.field.grid().spacing_y, 1001.0 / 250.0);
    EXPECT_DOUBLE_EQ(scan.field.grid().origin_x, -19.5 * 1001.0 / 500.0);
    EXPECT_DOUBLE_EQ(scan.field.grid().origin_y, (10.0 - 29.0) * 1001.0 / 250.0);
    EXPECT_EQ(contentHash(scan.field), contentHash(makeField(grid, counts)));
    EXPECT_TRUE(warned(scan.warnings, "perspective"));
    // Most cameras look along the middle of their picture.
    options.depth_camera = DepthCamera{500.0, 250.0};
    const auto centred = load(folder.file(name), options);
    ASSERT_TRUE(centred) << centred.error().line();
    const Grid& middle = centred->field.grid();
    EXPECT_DOUBLE_EQ(middle.origin_x, -0.5 * (middle.width - 1) * middle.spacing_x);
    EXPECT_DOUBLE_EQ(middle.origin_y, -0.5 * (middle.height - 1) * middle.spacing_y);
    options.spacing = std::pair{1.0, 1.0};
    const auto both = load(folder.file(name), options);
    ASSERT_FALSE(both);
    EXPECT_EQ(both.error().where, "--spacing");
    options.spacing.reset();
    options.depth_camera->fx = 0.0;
    EXPECT_FALSE(load(folder.file(name), options));
  }
  writeBytes(folder.file("a.xyz"), "1 2 3\n2 2 3\n");
  ImportOptions options;
  options.depth_camera = DepthCamera{500.0, 250.0, 19.5, 10.0};
  EXPECT_FALSE(load(folder.file("a.xyz"), options));
}

}  // namespace
}  // namespace fettle::engine
