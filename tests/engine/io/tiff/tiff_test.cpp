// TIFFs of every kind, made with GDAL or byte by byte.

#include <array>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <functional>
#include <system_error>
#include <thread>

#include <cpl_string.h>
#include <gdal.h>
#include <gdal_frmts.h>
#include <gtest/gtest.h>
#include <ogr_srs_api.h>

#include "engine/formats/formats.h"
#include "tests/engine/io/io_support.h"
#include "tests/support/temp_folder.h"

namespace fettle::engine {
namespace {

using tests::TempFolder;

// Writes a TIFF of one or more bands from doubles, in the order of the file.
void makeTiff(const std::string& path, GDALDataType type, int width, int height, const std::vector<double>& z,
              std::vector<const char*> options = {}, const std::function<void(GDALDatasetH)>& describe = {},
              int bands = 1) {
  GDALRegister_GTiff();
  options.push_back(nullptr);
  GDALDatasetH dataset = GDALCreate(GDALGetDriverByName("GTiff"), path.c_str(), width, height, bands, type,
                                    const_cast<char**>(options.data()));
  ASSERT_NE(dataset, nullptr);
  if (describe) describe(dataset);
  for (int band = 1; band <= bands; ++band)
    ASSERT_EQ(GDALRasterIO(GDALGetRasterBand(dataset, band), GF_Write, 0, 0, width, height,
                           const_cast<double*>(z.data()), width, height, GDT_Float64, 0, 0),
              CE_None);
  GDALClose(dataset);
}

void setCrs(GDALDatasetH dataset, int epsg) {
  OGRSpatialReferenceH crs = OSRNewSpatialReference(nullptr);
  ASSERT_EQ(OSRImportFromEPSG(crs, epsg), OGRERR_NONE);
  OSRSetAxisMappingStrategy(crs, OAMS_TRADITIONAL_GIS_ORDER);
  GDALSetSpatialRef(dataset, crs);
  OSRDestroySpatialReference(crs);
}

TEST(Tiff, EverySampleTypeIsReadExactly) {
  const TempFolder folder;
  struct Case {
    GDALDataType type;
    std::vector<double> z;
    std::vector<const char*> options;
    std::vector<double> read = {};  // where it is not z: GDAL takes signed bytes by their bits
  };
  for (const Case& c :
       {Case{GDT_Byte, {0, 1, 128, 255}, {}},
        Case{GDT_Byte, {128, 255, 0, 127}, {"PIXELTYPE=SIGNEDBYTE"}, {-128, -1, 0, 127}},
        Case{GDT_UInt16, {0, 1, 32768, 65535}, {}}, Case{GDT_Int16, {-32768, -1, 0, 32767}, {}},
        Case{GDT_UInt32, {0, 1, 65536, 4294967040.0}, {}},
        Case{GDT_Int32, {-2147483648.0, -1, 0, 16777216}, {}},
        Case{GDT_Int64, {-1099511627776.0, -1, 0, 16777216}, {}},
        Case{GDT_UInt64, {0, 1, 2, 1099511627776.0}, {}}, Case{GDT_Float32, {-1.5, 0.25, 1e-40, 3e38}, {}},
        Case{GDT_Float64, {-1.5, 0.25, 1e6, 0x1p120}, {}}}) {
    for (const char* endian : {"ENDIANNESS=LITTLE", "ENDIANNESS=BIG"})
      for (const char* compress : {"COMPRESS=NONE", "COMPRESS=LZW", "COMPRESS=DEFLATE", "COMPRESS=ZSTD"})
        for (const char* big : {"BIGTIFF=NO", "BIGTIFF=YES"}) {
          auto options = c.options;
          options.insert(options.end(), {endian, compress, big});
          const std::string path = folder.file("t.tif");
          makeTiff(path, c.type, 2, 2, c.z, options);
          FETTLE_LOAD(scan, path);
          const std::vector<double>& read = c.read.empty() ? c.z : c.read;
          for (int i = 0; i < 4; ++i)
            EXPECT_EQ(stored(scan.field, i / 2, i % 2), static_cast<float>(read[static_cast<std::size_t>(i)]))
                << GDALGetDataTypeName(c.type) << ' ' << endian << ' ' << compress << ' ' << big;
          EXPECT_EQ(scan.field.grid().height_per_count, GDALDataTypeIsInteger(c.type) != 0 ? 1.0 : 0.0);
          EXPECT_FALSE(warned(scan.warnings, "rounding"));
        }
  }
}

TEST(Tiff, TilesAndManyStripsComeInTheRightOrder) {
  const TempFolder folder;
  std::vector<double> z;
  for (int i = 0; i < 333 * 217; ++i) z.push_back(i);
  for (const std::vector<const char*>& options :
       {std::vector<const char*>{"TILED=YES", "BLOCKXSIZE=32", "BLOCKYSIZE=48"},
        {"BLOCKYSIZE=1"},
        {"BLOCKYSIZE=7"},
        {"BLOCKYSIZE=217", "COMPRESS=LZW", "PREDICTOR=2"}}) {
    makeTiff(folder.file("t.tif"), GDT_Int32, 333, 217, z, options);
    FETTLE_LOAD(scan, folder.file("t.tif"));
    for (int r = 0; r < 217; ++r)
      for (int c = 0; c < 333; ++c) ASSERT_EQ(stored(scan.field, r, c), static_cast<float>(r * 333 + c));
  }
}

TEST(Tiff, DeflateWithEachPredictorIsReadExactly) {
  const TempFolder folder;
  std::vector<double> z;
  for (int i = 0; i < 333 * 217; ++i) z.push_back((i * 7919) % 251);
  for (const GDALDataType type : {GDT_Byte, GDT_Int16, GDT_UInt32, GDT_Float32, GDT_Float64})
    for (const char* predictor : {"PREDICTOR=1", "PREDICTOR=2", "PREDICTOR=3"})
      for (const std::vector<const char*>& layout :
           {std::vector<const char*>{"TILED=YES", "BLOCKXSIZE=32", "BLOCKYSIZE=48"}, {"BLOCKYSIZE=100"}}) {
        if (std::string(predictor) == "PREDICTOR=3" && type != GDT_Float32 && type != GDT_Float64) continue;
        auto options = layout;
        options.insert(options.end(), {"COMPRESS=DEFLATE", predictor});
        makeTiff(folder.file("t.tif"), type, 333, 217, z, options);
        FETTLE_LOAD(scan, folder.file("t.tif"));
        for (int r = 0; r < 217; ++r)
          for (int c = 0; c < 333; ++c)
            ASSERT_EQ(stored(scan.field, r, c),
                      static_cast<float>(z[static_cast<std::size_t>(r) * 333 + static_cast<std::size_t>(c)]))
                << GDALGetDataTypeName(type) << ' ' << predictor << ' ' << r << ' ' << c;
      }
}

TEST(Tiff, LostBitsOfLargeNumbersAreStated) {
  const TempFolder folder;
  makeTiff(folder.file("t.tif"), GDT_Int32, 2, 1, {16777217, 2147483647});
  FETTLE_LOAD(ints, folder.file("t.tif"));
  EXPECT_TRUE(warned(ints.warnings, "largest rounding is 1 mm")) << ints.warnings.back();
  makeTiff(folder.file("t.tif"), GDT_Float64, 2, 1, {0.1, 1e300});
  FETTLE_LOAD(doubles, folder.file("t.tif"));
  EXPECT_TRUE(warned(doubles.warnings, "largest rounding is 1.5e-09 mm")) << doubles.warnings.back();
  EXPECT_TRUE(warned(doubles.warnings, "1 heights are infinite or outside the range"));
  EXPECT_TRUE(std::isnan(stored(doubles.field, 0, 1)));
}

TEST(Tiff, NoDataIsComparedAsTheSamplesAre) {
  const TempFolder folder;
  const auto declare = [](double value) {
    return [value](GDALDatasetH d) { GDALSetRasterNoDataValue(GDALGetRasterBand(d, 1), value); };
  };
  struct Case {
    GDALDataType type;
    double sample, no_data;
    bool hole;
  };
  for (const Case& c :
       {Case{GDT_Float32, -9999.9, -9999.9, true},  // differ as doubles, equal as floats
        Case{GDT_Float32, -3.4028234663852886e38, -3.402823e38, true},
        Case{GDT_Float32, 3.4028234663852886e38, -3.402823e38, false}, Case{GDT_Float64, 0.1, 0.1, true},
        Case{GDT_Int16, -32768, -32768, true}, Case{GDT_UInt16, 0, 0, true}, Case{GDT_UInt16, 1, 0, false}}) {
    makeTiff(folder.file("t.tif"), c.type, 2, 1, {c.sample, 5}, {}, declare(c.no_data));
    FETTLE_LOAD(scan, folder.file("t.tif"));
    EXPECT_EQ(std::isnan(stored(scan.field, 0, 0)), c.hole) << c.sample << ' ' << c.no_data;
    EXPECT_EQ(stored(scan.field, 0, 1), 5.0F);
  }
  ImportOptions options;
  options.no_data = 7.0;
  makeTiff(folder.file("t.tif"), GDT_UInt16, 3, 1, {0, 7, 8}, {}, declare(0));
  FETTLE_LOAD(both, folder.file("t.tif"), options);
  EXPECT_EQ(summarize(both.field).no_data, 2);
}

TEST(Tiff, NanAndInfinityAreHolesAndTheInfiniteAreCounted) {
  const TempFolder folder;
  makeTiff(folder.file("t.tif"), GDT_Float32, 4, 1, {kNan, kInf, -kInf, 1});
  FETTLE_LOAD(scan, folder.file("t.tif"));
  EXPECT_EQ(summarize(scan.field).no_data, 3);
  EXPECT_TRUE(warned(scan.warnings, "2 heights are infinite"));
}

TEST(Tiff, BandScaleAndOffsetAreAppliedAndZScaleOverrulesThem) {
  const TempFolder folder;
  const auto scale = [](GDALDatasetH d) {
    GDALSetRasterScale(GDALGetRasterBand(d, 1), 0.01);
    GDALSetRasterOffset(GDALGetRasterBand(d, 1), -5.0);
  };
  makeTiff(folder.file("t.tif"), GDT_Int16, 2, 1, {100, -300}, {}, scale);
  FETTLE_LOAD(scan, folder.file("t.tif"));
  EXPECT_EQ(stored(scan.field, 0, 0), static_cast<float>(100 * 0.01 - 5.0));
  EXPECT_EQ(stored(scan.field, 0, 1), -8.0F);
  EXPECT_EQ(scan.field.grid().height_per_count, 0.0);
  ImportOptions options;
  options.z_scale = 0.5;
  FETTLE_LOAD(overruled, folder.file("t.tif"), options);
  EXPECT_EQ(stored(overruled.field, 0, 0), 50.0F);
  EXPECT_EQ(overruled.field.grid().height_per_count, 0.5);
  EXPECT_TRUE(warned(overruled.warnings, "as requested"));
}

TEST(Tiff, BottomUpAndRightToLeftRastersLieWhereTheyShould) {
  const TempFolder folder;
  const auto place = [](double dx, double dy) {
    return [dx, dy](GDALDatasetH d) {
      std::array<double, 6> gt{100.0, dx, 0, 200.0, 0, dy};
      GDALSetGeoTransform(d, gt.data());
    };
  };
  // Stored: 1 2 3 / 4 5 6. Corner of the first pixel at (100, 200).
  makeTiff(folder.file("t.tif"), GDT_Byte, 3, 2, {1, 2, 3, 4, 5, 6}, {}, place(2, -4));
  FETTLE_LOAD(usual, folder.file("t.tif"));
  EXPECT_EQ(heightsOf(usual.field), (std::vector<float>{4, 5, 6, 1, 2, 3}));
  EXPECT_EQ(usual.field.grid().origin_x, 101.0);
  EXPECT_EQ(usual.field.grid().origin_y, 194.0);
  EXPECT_FALSE(warned(usual.warnings, "run upwards") || warned(usual.warnings, "run leftwards"));
  makeTiff(folder.file("t.tif"), GDT_Byte, 3, 2, {1, 2, 3, 4, 5, 6}, {}, place(2, 4));
  FETTLE_LOAD(up, folder.file("t.tif"));
  EXPECT_EQ(heightsOf(up.field), (std::vector<float>{1, 2, 3, 4, 5, 6}));
  EXPECT_EQ(up.field.grid().origin_y, 202.0);
  EXPECT_EQ(up.field.grid().spacing_y, 4.0);
  EXPECT_TRUE(warned(up.warnings, "rows go upwards: rows are counted from the highest y"));
  EXPECT_FALSE(warned(up.warnings, "run leftwards"));
  makeTiff(folder.file("t.tif"), GDT_Byte, 3, 2, {1, 2, 3, 4, 5, 6}, {}, place(-2, -4));
  FETTLE_LOAD(left, folder.file("t.tif"));
  EXPECT_EQ(heightsOf(left.field), (std::vector<float>{6, 5, 4, 3, 2, 1}));
  EXPECT_EQ(left.field.grid().origin_x, 100.0 - 2.5 * 2);
  EXPECT_TRUE(warned(left.warnings, "columns go leftwards: columns are counted from the lowest x"));
  EXPECT_FALSE(warned(left.warnings, "run upwards"));
}

TEST(Tiff, RotatedRastersAreRefused) {
  const TempFolder folder;
  makeTiff(folder.file("t.tif"), GDT_Byte, 2, 1, {1, 2}, {}, [](GDALDatasetH d) {
    std::array<double, 6> gt{0, 1, 0.1, 0, 0.1, -1};
    GDALSetGeoTransform(d, gt.data());
  });
  const auto scan = load(folder.file("t.tif"));
  ASSERT_FALSE(scan);
  EXPECT_NE(scan.error().what.find("rotated"), std::string::npos);
}

TEST(Tiff, NoDataOfAnAuxXmlBesideItIsAHole) {
  const TempFolder folder;
  const auto aux = [&](const std::string& value) {
    writeBytes(folder.file("t.tif.aux.xml"), "<PAMDataset>\n  <PAMRasterBand band=\"1\">\n    " + value +
                                                 "\n  </PAMRasterBand>\n</PAMDataset>\n");
  };
  for (const char* tag : {"", "-7"}) {
    makeTiff(folder.file("t.tif"), GDT_Int16, 2, 2, {1, -9999, -7, 4}, {}, [&](GDALDatasetH d) {
      if (*tag != '\0') GDALSetRasterNoDataValue(GDALGetRasterBand(d, 1), -7);
    });
    aux("<NoDataValue>-9.99900000000000E+03</NoDataValue>");
    FETTLE_LOAD(scan, folder.file("t.tif"));
    EXPECT_TRUE(std::isnan(stored(scan.field, 0, 1)));
    // It wins over the file's own, as in GDAL, and says so.
    EXPECT_EQ(stored(scan.field, 1, 0), -7.0F);
    EXPECT_EQ(warned(scan.warnings, "no-data -7"), *tag != '\0');
  }
  // The lowest float as GDAL writes it, which ends two units of its last place off.
  makeTiff(folder.file("t.tif"), GDT_Float32, 2, 1, {std::numeric_limits<float>::lowest(), 5.0});
  aux("<NoDataValue>-3.40282300000000E+38</NoDataValue>");
  FETTLE_LOAD(lowest, folder.file("t.tif"));
  EXPECT_EQ(summarize(lowest.field).no_data, 1);
}

TEST(Tiff, WhiteThatIsZeroIsNamedAndNotTakenForAPalette) {
  const TempFolder folder;
  for (const GDALDataType type : {GDT_Byte, GDT_UInt16}) {
    makeTiff(folder.file("t.tif"), type, 2, 1, {3, 200}, {"PHOTOMETRIC=MINISWHITE"});
    const auto refused = load(folder.file("t.tif"));
    ASSERT_FALSE(refused);
    EXPECT_NE(refused.error().what.find("MINISWHITE"), std::string::npos) << refused.error().line();
    EXPECT_NE(refused.error().remedy.find("--z-scale -1"), std::string::npos);
    ImportOptions depths;
    depths.z_scale = -1.0;
    FETTLE_LOAD(scan, folder.file("t.tif"), depths);
    EXPECT_EQ(stored(scan.field, 0, 1), -200.0F);
  }
  // Of floats it says nothing.
  makeTiff(folder.file("t.tif"), GDT_Float32, 2, 1, {3, 200}, {"PHOTOMETRIC=MINISWHITE"});
  FETTLE_LOAD(floats, folder.file("t.tif"));
  EXPECT_EQ(stored(floats.field, 0, 1), 200.0F);
}

TEST(Tiff, SamplesThatAreNoLengthsAreNamedAndGivenNoUnit) {
  const TempFolder folder;
  makeTiff(folder.file("t.tif"), GDT_Float32, 40, 40, std::vector<double>(1600, 0.0), {},
           [](GDALDatasetH d) { GDALSetRasterUnitType(GDALGetRasterBand(d, 1), "Intensity"); });
  FETTLE_LOAD(scan, folder.file("t.tif"));
  EXPECT_EQ(scan.field.grid().height_unit.name, "Intensity");
  EXPECT_TRUE(warned(scan.warnings, "\"Intensity\", which is not a length"));
  EXPECT_FALSE(warned(scan.warnings, "not known"));
}

TEST(Tiff, UnitsComeFromTheCoordinateSystem) {
  const TempFolder folder;
  const auto withCrs = [&](int epsg, const char* unit = nullptr) {
    makeTiff(folder.file("t.tif"), GDT_Float32, 2, 2, {1, 2, 3, 4}, {}, [&](GDALDatasetH d) {
      std::array<double, 6> gt{10.0, 0.001, 0, 60.0, 0, -0.001};
      GDALSetGeoTransform(d, gt.data());
      setCrs(d, epsg);
      if (unit != nullptr) GDALSetRasterUnitType(GDALGetRasterBand(d, 1), unit);
    });
    return load(folder.file("t.tif"));
  };
  const auto metres = withCrs(32632);
  ASSERT_TRUE(metres);
  EXPECT_EQ(metres->field.grid().lateral_unit, (LengthUnit{"m", 1000.0}));
  const auto survey_feet = withCrs(2994, "cm");  // Oregon Lambert is in feet; 2225 in US survey feet
  ASSERT_TRUE(survey_feet);
  EXPECT_EQ(survey_feet->field.grid().lateral_unit, (LengthUnit{"ft", 304.8}));
  EXPECT_EQ(survey_feet->field.grid().height_unit, (LengthUnit{"cm", 10.0}));
  const auto us = withCrs(2225);
  ASSERT_TRUE(us);
  EXPECT_EQ(us->field.grid().lateral_unit.name, "ftUS");
  EXPECT_NEAR(us->field.grid().lateral_unit.mm, 304.800609601, 1e-9);
  EXPECT_EQ(us->field.grid().height_unit.name, "ftUS");
  const auto degrees = withCrs(4326);
  ASSERT_TRUE(degrees);
  EXPECT_EQ(degrees->field.grid().lateral_unit.name, "deg");
  // At 60 degrees: 111.412 km to the north, 55.800 km to the east (WGS 84); the mean is their root.
  EXPECT_NEAR(degrees->field.grid().lateral_unit.mm, std::sqrt(111412.3e3 * 55800.3e3), 2e4);
  EXPECT_EQ(degrees->field.grid().height_unit.name, "m");
  EXPECT_TRUE(warned(degrees->warnings, "degrees"));
}

// GDAL's programs keep metadata items and change what these describe.
TEST(Tiff, TheNotedUnitIsNotThatOfACoordinateSystemWhichTheFileGotLater) {
  const TempFolder folder;
  const std::string file = folder.file("t.tif");
  Grid grid = gridOf(2, 2);
  grid.origin_x = 10.0;
  grid.origin_y = 60.0;
  grid.spacing_x = grid.spacing_y = 0.001;
  grid.lateral_unit = grid.height_unit = {"um", 1e-3};
  const auto written = [&](int epsg, const char* crs_unit) {
    EXPECT_TRUE(save(makeField(grid, {1, 2, 3, 4}), file));
    GDALDatasetH d = GDALOpen(file.c_str(), GA_Update);
    if (epsg != 0) setCrs(d, epsg);
    GDALSetMetadataItem(d, "FETTLE_CRS_UNIT", crs_unit, nullptr);
    GDALClose(d);
    return load(file);
  };
  // An earlier version wrote no item.
  for (const char* item : {"none", static_cast<const char*>(nullptr)}) {
    const auto same = written(0, item), degrees = written(4326, item);
    ASSERT_TRUE(same && degrees);
    EXPECT_EQ(same->field.grid().lateral_unit, grid.lateral_unit);
    EXPECT_FALSE(warned(same->warnings, "noted"));
    EXPECT_EQ(degrees->field.grid().lateral_unit.name, "deg");
    EXPECT_TRUE(warned(degrees->warnings, "the unit um was noted before the file got its coordinate system"));
    EXPECT_EQ(degrees->field.grid().height_unit, grid.height_unit);
  }
  const auto metres = written(32632, "none");
  ASSERT_TRUE(metres);
  EXPECT_EQ(metres->field.grid().lateral_unit, (LengthUnit{"m", 1000.0}));
  // A unit that the user gave in spite of the coordinate system stays.
  const auto given = written(4326, "deg");
  ASSERT_TRUE(given);
  EXPECT_EQ(given->field.grid().lateral_unit, grid.lateral_unit);
  ASSERT_TRUE(save(given->field, folder.file("u.tif")));
  FETTLE_LOAD(again, folder.file("u.tif"));
  EXPECT_EQ(again.field.grid(), given->field.grid());
}

TEST(Tiff, ACoordinateSystemComesBackThroughAnExport) {
  const TempFolder folder;
  for (const int epsg : {32632, 4326, 2225, 28992}) {
    makeTiff(folder.file("t.tif"), GDT_Float32, 2, 2, {1, 2, 3, 4}, {}, [&](GDALDatasetH d) {
      std::array<double, 6> gt{10.0, 0.001, 0, 60.0, 0, -0.001};
      GDALSetGeoTransform(d, gt.data());
      setCrs(d, epsg);
    });
    FETTLE_LOAD(scan, folder.file("t.tif"));
    ASSERT_TRUE(save(scan.field, folder.file("u.tif")));
    FETTLE_LOAD(again, folder.file("u.tif"));
    EXPECT_EQ(again.field.grid(), scan.field.grid()) << epsg;
  }
}

TEST(Tiff, ResolutionTagsGiveSpacingUnlessTheyAreThoseOfAPrinter) {
  const TempFolder folder;
  const auto tags = [](const char* x, const char* y, const char* unit) {
    return [=](GDALDatasetH d) {
      GDALSetMetadataItem(d, "TIFFTAG_XRESOLUTION", x, nullptr);
      GDALSetMetadataItem(d, "TIFFTAG_YRESOLUTION", y, nullptr);
      GDALSetMetadataItem(d, "TIFFTAG_RESOLUTIONUNIT", unit, nullptr);
    };
  };
  makeTiff(folder.file("t.tif"), GDT_Byte, 2, 1, {1, 2}, {}, tags("40", "20", "3"));
  FETTLE_LOAD(per_cm, folder.file("t.tif"));
  EXPECT_EQ(per_cm.field.grid().spacing_x, 0.25);
  EXPECT_EQ(per_cm.field.grid().spacing_y, 0.5);
  ImportOptions micrometres;
  micrometres.unit = lengthUnitFromName("um");
  FETTLE_LOAD(in_um, folder.file("t.tif"), micrometres);
  EXPECT_EQ(in_um.field.grid().spacing_x, 250.0);
  makeTiff(folder.file("t.tif"), GDT_Byte, 2, 1, {1, 2}, {}, tags("254", "127", "2"));
  FETTLE_LOAD(per_inch, folder.file("t.tif"));
  EXPECT_NEAR(per_inch.field.grid().spacing_x, 0.1, 1e-15);
  EXPECT_NEAR(per_inch.field.grid().spacing_y, 0.2, 1e-15);
  makeTiff(folder.file("t.tif"), GDT_Byte, 2, 1, {1, 2}, {}, tags("300", "300", "2"));
  FETTLE_LOAD(printed, folder.file("t.tif"));
  EXPECT_EQ(printed.field.grid().spacing_x, 1.0);
  EXPECT_TRUE(warned(printed.warnings, "print resolution"));
}

TEST(Tiff, TagsRewrittenAtTheEndAreNotLostWithIt) {
  const TempFolder folder;
  for (const char* endian : {"ENDIANNESS=LITTLE", "ENDIANNESS=BIG"})
    for (const char* big : {"BIGTIFF=NO", "BIGTIFF=YES"}) {
      makeTiff(folder.file("t.tif"), GDT_Float32, 2, 2, {1, 2, 3, -3.5e37}, {endian, big});
      GDALDatasetH dataset = GDALOpen(folder.file("t.tif").c_str(), GA_Update);
      ASSERT_NE(dataset, nullptr);
      setCrs(dataset, 32632);
      GDALSetRasterNoDataValue(GDALGetRasterBand(dataset, 1), -3.5e37);
      GDALClose(dataset);
      const std::string whole = readBytes(folder.file("t.tif"));
      FETTLE_LOAD(scan, folder.file("t.tif"));
      EXPECT_EQ(summarize(scan.field).no_data, 1);
      for (std::size_t bytes = 0; bytes < whole.size(); ++bytes) {
        writeBytes(folder.file("cut.tif"), whole.substr(0, bytes));
        EXPECT_FALSE(load(folder.file("cut.tif"))) << endian << ' ' << big << ' ' << bytes;
      }
    }
}

TEST(Tiff, UnitsThatNobodyStatesAreWarnedAbout) {
  const TempFolder folder;
  const auto warnings = [&](bool placed, const char* height_unit, const ImportOptions& options = {}) {
    makeTiff(folder.file("t.tif"), GDT_Byte, 2, 1, {1, 2}, {}, [&](GDALDatasetH d) {
      std::array<double, 6> gt{0, 2, 0, 0, 0, -2};
      if (placed) GDALSetGeoTransform(d, gt.data());
      if (height_unit != nullptr) GDALSetRasterUnitType(GDALGetRasterBand(d, 1), height_unit);
    });
    const auto scan = load(folder.file("t.tif"), options);
    return scan ? scan->warnings : std::vector<std::string>{scan.error().line()};
  };
  using Lines = std::vector<std::string>;
  EXPECT_EQ(warnings(true, nullptr), Lines{"the file states no unit, mm is assumed: give it with --unit"});
  EXPECT_EQ(warnings(true, "m"),
            Lines{"the file states no lateral unit, mm is assumed: give it with --unit"});
  EXPECT_EQ(warnings(false, nullptr),
            Lines{"the file states no unit and no spacing, mm and 1 mm are assumed: give "
                  "them with --unit and --spacing"});
  ImportOptions metres;
  metres.unit = lengthUnitFromName("m");
  EXPECT_EQ(warnings(true, nullptr, metres), Lines{});
  EXPECT_EQ(warnings(false, nullptr, metres),
            Lines{"the file states no spacing, 1 m is assumed: give it with --spacing"});
}

// What is counted as done has been compressed and written but for a strip or two, so cancelling late ends soon.
TEST(Tiff, TheProgressOfAnExportIsThatOfItsCompression) {
  const TempFolder folder;
  // Noise, which hardly becomes smaller.
  std::vector<float> z(std::size_t{2048} * 2048);
  std::uint32_t state = 7;
  for (float& height : z) {
    state = state * 1664525U + 1013904223U;
    height = static_cast<float>(state >> 8) * 1e-3F;
  }
  const Version field = makeField(gridOf(2048, 2048), z);
  JobControl job;
  std::uintmax_t written_bytes = 0;
  std::thread user([&] {
    while (job.total() == 0 || job.done() < job.total() - job.total() / 8) std::this_thread::yield();
    // Under the name that it has until it is whole, or under its own.
    for (std::error_code gone(1, std::generic_category()); gone;)
      for (const auto& file : std::filesystem::directory_iterator(folder.path()))
        written_bytes = file.file_size(gone);
    job.cancel();
  });
  const auto written = exportField(field, folder.file("t.tif"), {}, job);
  user.join();
  if (!written) {
    EXPECT_EQ(written.error().kind, ErrorKind::kCancelled);
  }
  EXPECT_GT(written_bytes, z.size() * sizeof(float) / 2);
}

TEST(Tiff, PicturesAreRefusedGreyWithAlphaIsTaken) {
  const TempFolder folder;
  makeTiff(folder.file("t.tif"), GDT_Byte, 2, 1, {1, 2}, {"PHOTOMETRIC=RGB"}, {}, 3);
  const auto rgb = load(folder.file("t.tif"));
  ASSERT_FALSE(rgb);
  EXPECT_NE(rgb.error().what.find("3 bands"), std::string::npos);
  makeTiff(folder.file("t.tif"), GDT_Byte, 2, 1, {1, 2}, {}, [](GDALDatasetH d) {
    GDALColorTableH table = GDALCreateColorTable(GPI_RGB);
    const GDALColorEntry red{255, 0, 0, 255};
    GDALSetColorEntry(table, 1, &red);
    GDALSetRasterColorTable(GDALGetRasterBand(d, 1), table);
    GDALDestroyColorTable(table);
  });
  const auto palette = load(folder.file("t.tif"));
  ASSERT_FALSE(palette);
  EXPECT_NE(palette.error().what.find("palette"), std::string::npos);
  makeTiff(folder.file("t.tif"), GDT_CFloat32, 2, 1, {1, 2});
  const auto complex = load(folder.file("t.tif"));
  ASSERT_FALSE(complex);
  EXPECT_NE(complex.error().what.find("complex"), std::string::npos);
  makeTiff(folder.file("t.tif"), GDT_UInt16, 2, 1, {1, 2}, {"ALPHA=YES"}, {}, 2);
  FETTLE_LOAD(alpha, folder.file("t.tif"));
  EXPECT_TRUE(warned(alpha.warnings, "transparency"));
  EXPECT_EQ(stored(alpha.field, 0, 1), 2.0F);
}

TEST(Tiff, ACloudOptimisedFileHasOverviewsAndEveryBit) {
  const TempFolder folder;
  std::vector<float> z;
  for (int i = 0; i < 1100 * 700; ++i)
    z.push_back(i % 1000 == 3 ? kNan : static_cast<float>(i % 977) * 0.37F);
  Grid grid = gridOf(1100, 700);
  grid.spacing_x = grid.spacing_y = 0.5;
  grid.origin_x = 73410.25;
  grid.lateral_unit = {"um", 1e-3};
  grid.height_unit = {"nm", 1e-6};
  const Version field = makeField(grid, z);
  ExportOptions options;
  options.cloud_optimised = true;
  JobControl job;
  const auto written = exportField(field, folder.file("a.tif"), options, job);
  ASSERT_TRUE(written) << written.error().line();
  EXPECT_EQ(job.stage(), std::string("overviews"));
  EXPECT_EQ(job.total(), 100U);
  EXPECT_EQ(job.done(), job.total());
  FETTLE_LOAD(again, folder.file("a.tif"));
  EXPECT_EQ(contentHash(again.field), contentHash(field));
  EXPECT_EQ(again.field.grid(), grid);
  GDALRegister_GTiff();
  GDALDatasetH dataset = GDALOpen(folder.file("a.tif").c_str(), GA_ReadOnly);
  ASSERT_NE(dataset, nullptr);
  EXPECT_STREQ(GDALGetMetadataItem(dataset, "LAYOUT", "IMAGE_STRUCTURE"), "COG");
  GDALRasterBandH band = GDALGetRasterBand(dataset, 1);
  EXPECT_GE(GDALGetOverviewCount(band), 2);
  // The mean of four samples; the one at row 0, column 3 is a hole and left out.
  float mean = 0.0F;
  EXPECT_EQ(GDALRasterIO(GDALGetOverview(band, 0), GF_Read, 1, 0, 1, 1, &mean, 1, 1, GDT_Float32, 0, 0),
            CE_None);
  double sum = 0.0;
  int count = 0;
  for (const auto& [r, c] : {std::pair{0, 2}, {0, 3}, {1, 2}, {1, 3}})
    if (const float height = stored(field, r, c); !std::isnan(height)) {
      sum += static_cast<double>(height);
      ++count;
    }
  EXPECT_NEAR(static_cast<double>(mean), sum / count, 1e-3);
  GDALClose(dataset);
  // Nothing is left next to it.
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder.path()), {}), 1);
  EXPECT_FALSE(save(field, folder.file("a.png"), options));
}

TEST(Tiff, NoFileIsWrittenBesideTheUsersFile) {
  const TempFolder folder;
  makeTiff(folder.file("t.tif"), GDT_Byte, 2, 1, {1, 2});
  FETTLE_LOAD(scan, folder.file("t.tif"));
  ASSERT_TRUE(save(scan.field, folder.file("u.tif")));
  int files = 0;
  for ([[maybe_unused]] const auto& entry : std::filesystem::directory_iterator(folder.path())) ++files;
  EXPECT_EQ(files, 2);
}

}  // namespace
}  // namespace fettle::engine
