// ASCII grids and PNGs as other programs write them.

#include <cmath>
#include <cstdio>
#include <filesystem>

#include <gtest/gtest.h>
#include <png.h>

#include "engine/formats/formats.h"
#include "engine/io/units.h"
#include "tests/engine/io/io_support.h"
#include "tests/support/temp_folder.h"

namespace fettle::engine {
namespace {

using tests::TempFolder;

TEST(AsciiGrid, KeysInAnyCaseOrderAndKindAreRead) {
  const TempFolder folder;
  writeBytes(
      folder.file("a.asc"),
      "NROWS 2\r\nNCOLS 3\r\nYLLCENTER 20.5\r\nXLLCENTER 10.25\r\nDX 0.5\r\nDY 2\r\nnodata_value nan\r\n"
      "1 2 nan\r\n-1e1 1.#QNAN +5 \r\n");
  FETTLE_LOAD(scan, folder.file("a.asc"));
  EXPECT_EQ(scan.field.grid().origin_x, 10.25);
  EXPECT_EQ(scan.field.grid().origin_y, 20.5);
  EXPECT_EQ(scan.field.grid().spacing_x, 0.5);
  EXPECT_EQ(scan.field.grid().spacing_y, 2.0);
  EXPECT_EQ(stored(scan.field, 0, 1), 2.0F);
  EXPECT_EQ(stored(scan.field, 1, 0), -10.0F);
  EXPECT_EQ(stored(scan.field, 1, 2), 5.0F);
  EXPECT_EQ(summarize(scan.field).no_data, 2);
}

TEST(AsciiGrid, WithoutAKeyMinus9999IsTheHole) {
  const TempFolder folder;
  writeBytes(folder.file("a.asc"), "ncols 2\nnrows 1\nxllcorner 0\nyllcorner 0\ncellsize 1\n-9999 3");
  FETTLE_LOAD(scan, folder.file("a.asc"));
  EXPECT_EQ(summarize(scan.field).no_data, 1);
  EXPECT_TRUE(warned(scan.warnings, "-9999"));
}

TEST(AsciiGrid, TheUnitTakenIsSaidUnlessItIsGiven) {
  const TempFolder folder;
  writeBytes(folder.file("a.asc"), "ncols 2\nnrows 1\nxllcorner 0\nyllcorner 0\ncellsize 1\n2 3\n");
  FETTLE_LOAD(scan, folder.file("a.asc"));
  EXPECT_EQ(scan.warnings,
            std::vector<std::string>{"the file states no unit, mm is assumed: give it with --unit"});
  ImportOptions options;
  options.unit = lengthUnitFromName("m");
  FETTLE_LOAD(metres, folder.file("a.asc"), options);
  EXPECT_TRUE(metres.warnings.empty());
}

TEST(AsciiGrid, NumbersAreRoundedOnceStraightToFloat) {
  const TempFolder folder;
  // 1 + 2^-24 + a little: as a double it lies on the middle between two floats and would round down to 1.
  writeBytes(folder.file("a.asc"),
             "ncols 2\nnrows 1\nxllcorner 0\nyllcorner 0\ncellsize 1\n1.000000059604644775390626 1e-45");
  FETTLE_LOAD(scan, folder.file("a.asc"));
  EXPECT_EQ(stored(scan.field, 0, 0), std::nextafter(1.0F, 2.0F));
  EXPECT_EQ(stored(scan.field, 0, 1), std::numeric_limits<float>::denorm_min());
}

TEST(AsciiGrid, DigitsThatAFloatLosesBesideTheRangeAreWarnedOf) {
  const TempFolder folder;
  const auto warnedOf = [&](const char* heights) {
    writeBytes(folder.file("a.asc"),
               std::string("ncols 2\nnrows 2\nxllcorner 0\nyllcorner 0\ncellsize 1\n") + heights);
    const auto scan = load(folder.file("a.asc"));
    EXPECT_TRUE(scan) << heights;
    return scan && warned(scan->warnings, "more digits than a float holds");
  };
  // Steps of floats at 5,000 are 0.0005: half of the range is lost.
  EXPECT_TRUE(warnedOf("5000.0001 5000.0003\n5000.0007 5000.0011"));
  EXPECT_TRUE(
      warnedOf("5000.0001 5000.0002\n5000.0001 5000.0002"));  // all the same as floats, a range before
  EXPECT_FALSE(warnedOf("0.1 0.3\n0.7 -9999"));
  EXPECT_FALSE(warnedOf("5000.1 5000.1\n5000.1 5000.1"));  // no range that could be lost
}

TEST(AsciiGrid, HeightsEqualToTheUsualMarkChooseAnother) {
  const TempFolder folder;
  const Version field = makeField(gridOf(3, 1), {-9999.0F, kNan, 4.0F});
  ASSERT_TRUE(save(field, folder.file("a.asc")));
  FETTLE_LOAD(again, folder.file("a.asc"));
  EXPECT_EQ(contentHash(again.field), contentHash(field));
}

constexpr const char* kTwoSamples =
    "ncols 2\nnrows 1\nxllcorner 500000\nyllcorner 5000000\ncellsize 1\nNODATA_value -9999\n2 3\n";

TEST(AsciiGrid, ThePrjBesideItNamesTheCoordinateSystem) {
  const TempFolder folder;
  writeBytes(folder.file("a.asc"), kTwoSamples);
  // As ArcGIS writes it.
  writeBytes(
      folder.file("a.prj"),
      R"(PROJCS["NAD_1983_HARN_Oregon_Statewide_Lambert_Feet_Intl",GEOGCS["GCS_North_American_1983_HARN",)"
      R"(DATUM["D_North_American_1983_HARN",SPHEROID["GRS_1980",6378137.0,298.257222101]],)"
      R"(PRIMEM["Greenwich",0.0],UNIT["Degree",0.0174532925199433]],PROJECTION["Lambert_Conformal_Conic"],)"
      R"(PARAMETER["False_Easting",1312335.958],PARAMETER["False_Northing",0.0],)"
      R"(PARAMETER["Central_Meridian",-120.5],PARAMETER["Standard_Parallel_1",43.0],)"
      R"(PARAMETER["Standard_Parallel_2",45.5],PARAMETER["Latitude_Of_Origin",41.75],UNIT["foot",0.3048]])");
  FETTLE_LOAD(feet, folder.file("a.asc"));
  EXPECT_EQ(feet.field.grid().lateral_unit.name, "ft");
  EXPECT_EQ(feet.field.grid().height_unit.name, "ft");
  EXPECT_NE(feet.field.grid().crs_wkt.find("HARN"), std::string::npos);
  EXPECT_TRUE(feet.warnings.empty()) << feet.warnings.front();

  // The key words of old, and text that is none of all that.
  writeBytes(folder.file("a.prj"),
             "Projection    UTM\r\nZone          33\r\nDatum         WGS84\r\nUnits         METERS\r\n");
  FETTLE_LOAD(old, folder.file("a.asc"));
  EXPECT_NE(old.field.grid().crs_wkt.find("UTM"), std::string::npos) << old.field.grid().crs_wkt;
  EXPECT_EQ(old.field.grid().lateral_unit.name, "m");
  writeBytes(folder.file("a.prj"), "somewhere in Oregon");
  FETTLE_LOAD(nonsense, folder.file("a.asc"));
  EXPECT_EQ(nonsense.field.grid().crs_wkt, "");
  EXPECT_TRUE(warned(nonsense.warnings, "a.prj"));
}

// The registry (PROJ's table of EPSG's) has this system twice: as a zone of six degrees and as one of three.
TEST(AsciiGrid, APrjThatEqualsTwoSystemsOfTheRegistryTakesTheNameOfNone) {
  const TempFolder folder;
  writeBytes(folder.file("a.asc"), kTwoSamples);
  const auto named = [&](const std::string& name) {
    writeBytes(
        folder.file("a.prj"),
        "PROJCS[\"" + name + "\"," +
            R"(GEOGCS["GCS_Pulkovo_1995",DATUM["D_Pulkovo_1995",SPHEROID["Krasovsky_1940",6378245.0,298.3]],)"
            R"(PRIMEM["Greenwich",0.0],UNIT["Degree",0.0174532925199433]],PROJECTION["Gauss_Kruger"],)"
            R"(PARAMETER["False_Easting",500000.0],PARAMETER["False_Northing",0.0],)"
            R"(PARAMETER["Central_Meridian",93.0],PARAMETER["Scale_Factor",1.0],)"
            R"(PARAMETER["Latitude_Of_Origin",0.0],UNIT["Meter",1.0]])");
    const auto scan = load(folder.file("a.asc"));
    EXPECT_TRUE(scan) << scan.error().line();
    return scan ? scan->field.grid().crs_wkt : std::string();
  };
  const std::string either = named("unknown");
  EXPECT_TRUE(either.starts_with("PROJCRS[\"unknown\"")) << either;
  // By its name each is found.
  const std::string six = named("Pulkovo_1995_Gauss-Kruger_CM_93E"),
                    three = named("Pulkovo_1995_3_Degree_GK_CM_93E");
  EXPECT_NE(six.find("ID[\"EPSG\",2475]"), std::string::npos) << six;
  EXPECT_NE(three.find("ID[\"EPSG\",2723]"), std::string::npos) << three;
}

TEST(AsciiGrid, ACoordinateSystemIsWrittenToAPrjAndComesBack) {
  const TempFolder folder;
  writeBytes(folder.file("in.asc"), kTwoSamples);
  writeBytes(folder.file("in.prj"),
             "Projection    UTM\nZone          33\nDatum         WGS84\nUnits         METERS\n");
  FETTLE_LOAD(scan, folder.file("in.asc"));
  const auto written = save(scan.field, folder.file("out.asc"));
  ASSERT_TRUE(written) << written.error().line();
  EXPECT_TRUE(written->warnings.empty()) << written->warnings.front();
  EXPECT_TRUE(readBytes(folder.file("out.prj")).starts_with("PROJCS["));
  FETTLE_LOAD(again, folder.file("out.asc"));
  EXPECT_NE(again.field.grid().crs_wkt.find("UTM zone 33N"), std::string::npos);
  EXPECT_EQ(again.field.grid().lateral_unit, scan.field.grid().lateral_unit);
  EXPECT_EQ(contentHash(again.field), contentHash(scan.field));

  // One that is there and belongs to the new grid no more is not passed over.
  const auto plain = save(makeField(gridOf(2, 1), {1, 2}), folder.file("out.asc"));
  ASSERT_TRUE(plain);
  EXPECT_TRUE(warned(plain->warnings, "out.prj"));
  // And none is written where the grid is not.
  const auto nowhere = save(scan.field, folder.file("none/out.asc"));
  EXPECT_FALSE(nowhere);
}

TEST(AsciiGrid, AnAuxXmlBesideItSaysWhatIsAHole) {
  const TempFolder folder;
  writeBytes(folder.file("a.asc"), "ncols 3\nnrows 1\nxllcorner 0\nyllcorner 0\ncellsize 1\n0 3 -9999");
  writeBytes(folder.file("a.asc.aux.xml"),
             "<PAMDataset>\n  <PAMRasterBand band=\"1\">\n    <NoDataValue>0</NoDataValue>\n"
             "    <UnitType>ft</UnitType>\n  </PAMRasterBand>\n</PAMDataset>\n");
  FETTLE_LOAD(scan, folder.file("a.asc"));
  EXPECT_EQ(summarize(scan.field).no_data, 1);
  EXPECT_TRUE(std::isnan(stored(scan.field, 0, 0)));
  EXPECT_EQ(scan.field.grid().height_unit.name, "ft");
  writeBytes(folder.file("a.asc.aux.xml"), "<html>");
  FETTLE_LOAD(other, folder.file("a.asc"));
  EXPECT_TRUE(warned(other.warnings, "a.asc.aux.xml"));
  EXPECT_TRUE(std::isnan(stored(other.field, 0, 2)));
}

// Writes a PNG with libpng directly.
void makePng(const std::string& path, int width, int height, int bits, int color, bool interlaced,
             const std::vector<std::uint16_t>& values, int channels = 1) {
  FILE* file = std::fopen(path.c_str(), "wb");
  png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, nullptr, nullptr);
  png_infop info = png_create_info_struct(png);
  png_init_io(png, file);
  png_set_IHDR(png, info, static_cast<png_uint_32>(width), static_cast<png_uint_32>(height), bits, color,
               interlaced ? PNG_INTERLACE_ADAM7 : PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT,
               PNG_FILTER_TYPE_DEFAULT);
  if (color == PNG_COLOR_TYPE_PALETTE) {
    const png_color red{255, 0, 0};
    png_set_PLTE(png, info, &red, 1);
  }
  png_write_info(png, info);
  png_set_packing(png);  // of samples below 8 bits too a byte each is given
  std::vector<std::vector<unsigned char>> rows;
  std::vector<png_bytep> pointers;
  for (int r = 0; r < height; ++r) {
    std::vector<unsigned char> row;
    for (int i = 0; i < width * channels; ++i) {
      const std::uint16_t v = values[static_cast<std::size_t>(r * width * channels + i)];
      if (bits == 16) row.push_back(static_cast<unsigned char>(v >> 8));
      row.push_back(static_cast<unsigned char>(v));
    }
    rows.push_back(row);
  }
  for (auto& row : rows) pointers.push_back(row.data());
  png_write_image(png, pointers.data());
  png_write_end(png, nullptr);
  png_destroy_write_struct(&png, &info);
  std::fclose(file);
}

TEST(Png, InterlacedSixteenBitPicturesKeepTheirBytesInOrder) {
  const TempFolder folder;
  std::vector<std::uint16_t> values;
  for (int i = 0; i < 37 * 29; ++i) values.push_back(static_cast<std::uint16_t>(i * 61 + 259));
  for (const bool interlaced : {false, true}) {
    makePng(folder.file("a.png"), 37, 29, 16, PNG_COLOR_TYPE_GRAY, interlaced, values);
    FETTLE_LOAD(scan, folder.file("a.png"));
    for (int r = 0; r < 29; ++r)
      for (int c = 0; c < 37; ++c)
        ASSERT_EQ(stored(scan.field, r, c), values[static_cast<std::size_t>(r * 37 + c)]) << interlaced;
  }
}

TEST(Png, SamplesOfOneTwoAndFourBitsAreNumbersAsTheyAreStored) {
  const TempFolder folder;
  for (const int bits : {1, 2, 4})
    for (const bool interlaced : {false, true}) {
      std::vector<std::uint16_t> values;
      for (int i = 0; i < 13 * 9; ++i) values.push_back(static_cast<std::uint16_t>(i * 7 % 11 % (1 << bits)));
      makePng(folder.file("a.png"), 13, 9, bits, PNG_COLOR_TYPE_GRAY, interlaced, values);
      FETTLE_LOAD(scan, folder.file("a.png"));
      for (int r = 0; r < 9; ++r)
        for (int c = 0; c < 13; ++c)
          ASSERT_EQ(stored(scan.field, r, c), values[static_cast<std::size_t>(r * 13 + c)])
              << bits << " bits, " << c << ' ' << r;
    }
}

TEST(Png, EightBitsAreTakenWithAWarningColourAndPaletteAreRefused) {
  const TempFolder folder;
  makePng(folder.file("a.png"), 2, 1, 8, PNG_COLOR_TYPE_GRAY, false, {7, 200});
  FETTLE_LOAD(grey, folder.file("a.png"));
  EXPECT_EQ(stored(grey.field, 0, 1), 200.0F);
  EXPECT_TRUE(warned(grey.warnings, "8 bits"));
  makePng(folder.file("a.png"), 2, 1, 16, PNG_COLOR_TYPE_GRAY_ALPHA, true, {7, 0, 200, 0}, 2);
  FETTLE_LOAD(alpha, folder.file("a.png"));
  EXPECT_EQ(stored(alpha.field, 0, 1), 200.0F);
  EXPECT_TRUE(warned(alpha.warnings, "transparency"));
  makePng(folder.file("a.png"), 1, 1, 8, PNG_COLOR_TYPE_RGB, false, {1, 2, 3}, 3);
  const auto rgb = load(folder.file("a.png"));
  ASSERT_FALSE(rgb);
  EXPECT_NE(rgb.error().what.find("colour"), std::string::npos);
  makePng(folder.file("a.png"), 1, 1, 8, PNG_COLOR_TYPE_PALETTE, false, {0});
  const auto palette = load(folder.file("a.png"));
  ASSERT_FALSE(palette);
  EXPECT_NE(palette.error().what.find("palette"), std::string::npos);
}

TEST(Units, NamesAreFoundInAnyCase) {
  EXPECT_EQ(lengthUnitFromName("MM"), (LengthUnit{"mm", 1.0}));
  EXPECT_EQ(lengthUnitFromName("Metre"), (LengthUnit{"m", 1000.0}));
  EXPECT_EQ(lengthUnitFromName("\xc2\xb5m"), (LengthUnit{"um", 1e-3}));
  EXPECT_EQ(lengthUnitFromName("US survey foot")->name, "ftUS");
  EXPECT_EQ(lengthUnitFromName("furlong"), std::nullopt);
  EXPECT_EQ(lengthUnitFromName("deg"), std::nullopt);
  EXPECT_EQ(lengthUnitFromName(""), std::nullopt);
  EXPECT_EQ(lengthUnitFromComment("comment scan, units mm"), (LengthUnit{"mm", 1.0}));
  EXPECT_EQ(lengthUnitFromComment("united nations m"), std::nullopt);
}

TEST(Formats, TheTableNamesWhatCanBeReadAndWritten) {
  std::string table;
  for (const FormatInfo& info : formats()) {
    table += std::string(info.name) + (info.reads ? " r" : " ") + (info.writes ? "w " : " ");
    ASSERT_FALSE(info.extensions.empty());
    EXPECT_EQ(info.extensions.front().front(), '.');
  }
  EXPECT_EQ(table,
            "GTiff rw PNG rw PLY rw PCD r LAS r SUR r X3P rw SDF rw EXR rw STL rw AAIGrid rw Fettle rw "
            "Matrix r XYZ rw ");
}

TEST(AsciiGrid, ThatIsCutInsideItsLastNumberIsWarnedOf) {
  const TempFolder folder;
  std::string text = "ncols 3\nnrows 2\nxllcorner 0\nyllcorner 0\ncellsize 1\n1 2 3\n4 5 67.25\n";
  writeBytes(folder.file("whole.asc"), text);
  FETTLE_LOAD(whole, folder.file("whole.asc"));
  EXPECT_FALSE(warned(whole.warnings, "may be cut short"));
  writeBytes(folder.file("cut.asc"), text.substr(0, text.size() - 3));
  FETTLE_LOAD(cut, folder.file("cut.asc"));
  EXPECT_EQ(stored(cut.field, 1, 2), 67.0F);
  EXPECT_TRUE(warned(cut.warnings, "may be cut short inside its last number"));
  // What stands behind the last number ends it, and what is left out is not it.
  writeBytes(folder.file("blank.asc"), text.substr(0, text.size() - 1) + " ");
  FETTLE_LOAD(blank, folder.file("blank.asc"));
  EXPECT_FALSE(warned(blank.warnings, "may be cut short"));
  writeBytes(folder.file("more.asc"), text + "8");
  FETTLE_LOAD(more, folder.file("more.asc"));
  EXPECT_FALSE(warned(more.warnings, "may be cut short"));
}

TEST(TextGrids, WhatFettleWritesEndsWithALineEnd) {
  const TempFolder folder;
  for (const char* name : {"f.asc", "f.xyz"}) {
    ASSERT_TRUE(save(makeField(gridOf(3, 2), {1, 2, 3, 4, 5, kNan}), folder.file(name)));
    EXPECT_TRUE(readBytes(folder.file(name)).ends_with('\n')) << name;
    FETTLE_LOAD(again, folder.file(name));
    EXPECT_FALSE(warned(again.warnings, "may be cut short")) << name;
  }
}

TEST(AsciiGrid, APrjBesideItIsFoundWhateverItsCase) {
  const std::string prj =
      R"(PROJCS["WGS_1984_UTM_Zone_33N",GEOGCS["GCS_WGS_1984",DATUM["D_WGS_1984",SPHEROID["WGS_1984",)"
      R"(6378137.0,298.257223563]],PRIMEM["Greenwich",0.0],UNIT["Degree",0.0174532925199433]],)"
      R"(PROJECTION["Transverse_Mercator"],PARAMETER["False_Easting",500000.0],PARAMETER["False_Northing",0.0],)"
      R"(PARAMETER["Central_Meridian",15.0],PARAMETER["Scale_Factor",0.9996],)"
      R"(PARAMETER["Latitude_Of_Origin",0.0],UNIT["Meter",1.0]])";
  for (const char* name : {"U.PRJ", "U.Prj", "U.prj"}) {
    const TempFolder folder;
    writeBytes(folder.file("U.ASC"), "ncols 2\nnrows 1\nxllcorner 0\nyllcorner 0\ncellsize 1\n1 2\n");
    writeBytes(folder.file(name), prj);
    FETTLE_LOAD(scan, folder.file("U.ASC"));
    EXPECT_NE(scan.field.grid().crs_wkt.find("33N"), std::string::npos) << name;
    // Written again it takes the place of that one.
    ASSERT_TRUE(save(scan.field, folder.file("U.ASC")));
    EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder.path()), {}), 2) << name;
  }
}

}  // namespace
}  // namespace fettle::engine
