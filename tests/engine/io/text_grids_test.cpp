// ASCII grids and PNGs as other programs write them.

#include <cmath>
#include <cstdio>

#include <gtest/gtest.h>
#include <png.h>

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
  writeBytes(folder.file("a.asc"), "ncols 2\nnrows 1\nxllcorner 0\nyllcorner 0\ncellsize 1\n2 3");
  FETTLE_LOAD(scan, folder.file("a.asc"));
  EXPECT_EQ(scan.warnings,
            std::vector<std::string>{"the file states no unit, mm taken: give it with --unit"});
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

TEST(AsciiGrid, HeightsEqualToTheUsualMarkChooseAnother) {
  const TempFolder folder;
  const Version field = makeField(gridOf(3, 1), {-9999.0F, kNan, 4.0F});
  ASSERT_TRUE(save(field, folder.file("a.asc")));
  FETTLE_LOAD(again, folder.file("a.asc"));
  EXPECT_EQ(contentHash(again.field), contentHash(field));
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
            "GTiff rw PNG rw PLY rw PCD r LAS r SUR r X3P rw EXR rw STL rw AAIGrid rw Fettle rw XYZ rw ");
}

}  // namespace
}  // namespace fettle::engine
