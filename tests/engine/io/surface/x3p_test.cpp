// x3p archives as other programs make them: flat and in a folder, bytes and text, checksums, masks, lies.

#include <cmath>
#include <cstring>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "engine/io/files/md5.h"
#include "engine/io/files/zip_archive.h"
#include "tests/engine/io/io_support.h"
#include "tests/support/temp_folder.h"

namespace fettle::engine {
namespace {

using tests::TempFolder;
using Entries = std::vector<std::pair<std::string, std::string>>;

void zip(const std::string& path, const Entries& entries) {
  auto file = AtomicFile::create(path);
  ASSERT_TRUE(file);
  ZipWriter writer(*file);
  for (const auto& [name, bytes] : entries) {
    ASSERT_TRUE(writer.begin(name, bytes.size()));
    ASSERT_TRUE(writer.write(bytes.data(), bytes.size()));
  }
  ASSERT_TRUE(writer.finish());
  ASSERT_TRUE(file->commit());
}

template <class T>
std::string bytesOf(const std::vector<T>& numbers) {
  return {reinterpret_cast<const char*>(numbers.data()), numbers.size() * sizeof(T)};
}

std::string md5Of(const std::string& bytes) {
  Md5 md5;
  md5.add(bytes);
  return md5.hex();
}

struct Xml {
  std::string type = "D", increment = "1", offset = "0", sx = "2e-6", sy = "5E-007", ox = "0", oy = "0";
  std::string width = "3", height = "2", layers = "1", feature = "SUR", kind = "I", root = "p:ISO5436_2";
  std::string heights = "<DataLink><PointDataLink>bindata/data.bin</PointDataLink></DataLink>";

  [[nodiscard]] std::string text() const {
    return fmt::format(
        "<?xml version=\"1.0\"?><{0} "
        "xmlns:p=\"x\"><Record1><FeatureType>{1}</FeatureType><Axes><CX><AxisType>{2}</AxisType><DataType>D</"
        "DataType><Increment>{3}</Increment><Offset>{4}</Offset></CX><CY><AxisType>I</AxisType><DataType>D</"
        "DataType><Increment>{5}</Increment><Offset>{6}</Offset></CY><CZ><AxisType>A</"
        "AxisType><DataType>{7}</DataType><Increment>{8}</Increment><Offset>{9}</Offset></CZ></Axes></"
        "Record1><Record3><MatrixDimension><SizeX>{10}</SizeX><SizeY>{11}</SizeY><SizeZ>{12}</SizeZ></"
        "MatrixDimension>{13}</Record3><Record4><ChecksumFile>md5checksum.hex</ChecksumFile></Record4></{0}>",
        root, feature, kind, sx, ox, sy, oy, type, increment, offset, width, height, layers, heights);
  }
};

class X3p : public ::testing::Test {
 protected:
  Result<Imported> load(const Entries& entries, const ImportOptions& options = {}) {
    zip(folder_.file("a.x3p"), entries);
    return engine::load(folder_.file("a.x3p"), options);
  }
  std::string refused(const Entries& entries) {
    const auto scan = load(entries);
    EXPECT_FALSE(scan);
    if (scan) return {};
    EXPECT_EQ(scan.error().kind, ErrorKind::kInput) << scan.error().line();
    return scan.error().line();
  }
  TempFolder folder_;
};

const std::vector<double> kHeights{1e-6, 2e-6, double{kNan}, -3e-6, 4.5e-6, 0.0};

void expectHeights(const Result<Imported>& scan) {
  ASSERT_TRUE(scan) << scan.error().line();
  EXPECT_EQ(scan->format, "X3P");
  const Grid& grid = scan->field.grid();
  ASSERT_EQ(grid.width, 3);
  ASSERT_EQ(grid.height, 2);
  EXPECT_EQ(grid.spacing_x, 2e-6);
  EXPECT_EQ(grid.spacing_y, 5e-7);
  EXPECT_EQ(grid.lateral_unit.name, "m");
  EXPECT_EQ(grid.height_unit.name, "m");
  for (std::size_t i = 0; i < 6; ++i) {
    const float z = stored(scan->field, static_cast<int>(i / 3), static_cast<int>(i % 3));
    if (std::isnan(kHeights[i]))
      EXPECT_TRUE(std::isnan(z)) << i;
    else
      EXPECT_FLOAT_EQ(z, static_cast<float>(kHeights[i])) << i;
  }
}

TEST_F(X3p, FlatAndFolderedArchivesWithAndWithoutANameSpaceAreTheSame) {
  const std::string data = bytesOf(kHeights);
  Xml xml;
  expectHeights(load({{"main.xml", xml.text()}, {"bindata/data.bin", data}}));
  expectHeights(load({{"bindata/data.bin", data}, {"main.xml", xml.text()}}));
  xml.root = "ISO5436";
  // As a Mac packs a folder; its own main.xml is none.
  expectHeights(load({{"__MACOSX/main.xml", "no xml"},
                      {"scan/", ""},
                      {"scan/bindata/.DS_Store", "x"},
                      {"scan/bindata/data.bin", data},
                      {"scan/old/main.xml", "no xml either"},
                      {"scan/main.xml", xml.text()}}));
  xml.heights = "<DataLink><PointDataLink>.\\BinData\\data.bin</PointDataLink></DataLink>";
  expectHeights(load({{"main.xml", xml.text()}, {"bindata\\data.bin", data}}));
}

TEST_F(X3p, EveryTypeOfNumberIsRead) {
  Xml xml;
  std::vector<float> floats(kHeights.begin(), kHeights.end());
  xml.type = "F";
  expectHeights(load({{"main.xml", xml.text()}, {"bindata/data.bin", bytesOf(floats)}}));
  // Counts of 0.5 um above 1 um; a bit a point says which were measured.
  xml.increment = "5e-7";
  xml.offset = "1e-6";
  xml.heights =
      "<DataLink><PointDataLink>bindata/data.bin</PointDataLink><ValidPointsLink>bindata/valid.bin</"
      "ValidPointsLink></DataLink>";
  const std::vector<std::int16_t> counts{0, 2, 0, -8, 7, -2};
  const std::vector<std::int32_t> wide(counts.begin(), counts.end());
  const std::string valid(1, '\x3b');  // all but the third
  xml.type = "I";
  const auto scan =
      load({{"main.xml", xml.text()}, {"bindata/data.bin", bytesOf(counts)}, {"bindata/valid.bin", valid}});
  expectHeights(scan);
  EXPECT_EQ(scan->field.grid().height_per_count, 5e-7);
  xml.type = "L";
  expectHeights(
      load({{"main.xml", xml.text()}, {"bindata/data.bin", bytesOf(wide)}, {"bindata/valid.bin", valid}}));
  EXPECT_NE(refused({{"main.xml", xml.text()}, {"bindata/data.bin", bytesOf(wide)}}).find("valid.bin"),
            std::string::npos);
  EXPECT_NE(
      refused({{"main.xml", xml.text()}, {"bindata/data.bin", bytesOf(wide)}, {"bindata/valid.bin", ""}})
          .find("too short"),
      std::string::npos);
}

TEST_F(X3p, AMatrixOfTextIsRead) {
  Xml xml;
  xml.heights =
      "<DataList>\n<Datum>1e-6</Datum><!-- one --> <Datum> 2.0E-006\n</Datum><Datum/><Datum>-3e-6</Datum>"
      "<Datum>4.5e-6</Datum><Datum>0</Datum></DataList>";
  expectHeights(load({{"main.xml", xml.text()}}));
  xml.heights = "<DataList><Datum>1</Datum></DataList>";
  EXPECT_NE(refused({{"main.xml", xml.text()}}).find("row 1 of 2"), std::string::npos);
  xml.heights = "<DataList><Datum>1</Datum><Datum>0,5</Datum></DataList>";
  EXPECT_NE(refused({{"main.xml", xml.text()}}).find("column 2"), std::string::npos);
  // A height of 512 characters is read, a longer one is none.
  const auto long_one = [](std::size_t characters) {
    return "<DataList><Datum>1." + std::string(characters - 5, '0') +
           "e-6</Datum><Datum>2e-6</Datum><Datum/><Datum>-3e-6</Datum>"
           "<Datum>4.5e-6</Datum><Datum>0</Datum></DataList>";
  };
  xml.heights = long_one(512);
  expectHeights(load({{"main.xml", xml.text()}}));
  xml.heights = long_one(513);
  EXPECT_NE(refused({{"main.xml", xml.text()}}).find("row 1 of 2"), std::string::npos);
  // Far more than the parser of the rest would be given.
  xml.width = "700";
  xml.height = "500";
  xml.heights = "<DataList>";
  for (int i = 0; i < 700 * 500; ++i) xml.heights += fmt::format("<Datum>{}e-7</Datum>", i);
  xml.heights += "</DataList>";
  const auto large = load({{"main.xml", xml.text()}});
  ASSERT_TRUE(large) << large.error().line();
  EXPECT_EQ(stored(large->field, 499, 699), 349999e-7F);
}

TEST_F(X3p, ChecksumsThatDoNotHoldAreWarnedOf) {
  const std::string data = bytesOf(kHeights);
  Xml xml;
  const auto link = [](const std::string& md5) {
    return "<DataLink><PointDataLink>bindata/data.bin</PointDataLink><MD5ChecksumPointData>" + md5 +
           "</MD5ChecksumPointData></DataLink>";
  };
  std::string upper = md5Of(data);
  for (char& c : upper) c = static_cast<char>(std::toupper(c));
  xml.heights = link(upper);
  const auto sound = load({{"main.xml", xml.text()},
                           {"bindata/data.bin", data},
                           {"md5checksum.hex", md5Of(xml.text()) + " *main.xml\n"}});
  expectHeights(sound);
  EXPECT_FALSE(warned(sound->warnings, "checksum"));
  xml.heights = link(md5Of("other"));
  const auto changed = load({{"main.xml", xml.text()},
                             {"bindata/data.bin", data},
                             {"md5checksum.hex", md5Of("other") + " *main.xml\n"}});
  expectHeights(changed);
  EXPECT_TRUE(warned(changed->warnings, "heights do not match their checksum"));
  EXPECT_TRUE(warned(changed->warnings, "main.xml does not match its checksum"));
}

TEST_F(X3p, HeightsTooLargeForMetresAreDoubted) {
  Xml xml;
  const auto scan =
      load({{"main.xml", xml.text()}, {"bindata/data.bin", bytesOf(std::vector<double>{1, 2, 3, 4, 5, 6})}});
  ASSERT_TRUE(scan);
  EXPECT_TRUE(warned(scan->warnings, "heights in micrometres in a file whose standard says metres?"));
  ImportOptions um;
  um.unit = lengthUnitFromName("um");
  const auto loaded = load(
      {{"main.xml", xml.text()}, {"bindata/data.bin", bytesOf(std::vector<double>{1, 2, 3, 4, 5, 6})}}, um);
  ASSERT_TRUE(loaded);
  EXPECT_FALSE(warned(loaded->warnings, "metres?"));
}

TEST_F(X3p, WhatIsNoRasterIsRefusedByName) {
  const std::string data = bytesOf(kHeights);
  const auto with = [&](auto change) {
    Xml xml;
    change(xml);
    return refused({{"main.xml", xml.text()}, {"bindata/data.bin", data}});
  };
  EXPECT_NE(with([](Xml& x) { x.feature = "PRF"; }).find("PRF"), std::string::npos);
  EXPECT_NE(with([](Xml& x) { x.layers = "3"; }).find("3 layers"), std::string::npos);
  EXPECT_NE(with([](Xml& x) { x.kind = "A"; }).find("of their own"), std::string::npos);
  EXPECT_NE(with([](Xml& x) { x.type = "Q"; }).find("\"Q\""), std::string::npos);
  EXPECT_NE(with([](Xml& x) { x.sx = "0,5"; }).find("decimal comma"), std::string::npos);
  EXPECT_NE(with([](Xml& x) { x.sx = "-1"; }).find("spacing of -1"), std::string::npos);
  EXPECT_NE(with([](Xml& x) { x.width = "-3"; }).find("side of -3"), std::string::npos);
  EXPECT_NE(with([](Xml& x) { x.width = "2.5"; }).find("side of 2.5"), std::string::npos);
  with([](Xml& x) { x.width = "0"; });
  EXPECT_NE(with([](Xml& x) { x.width = "4"; }).find("row 2 of 2"), std::string::npos);
  EXPECT_NE(refused({{"data.bin", data}}).find("no main.xml"), std::string::npos);
  EXPECT_NE(refused({{"main.xml", "<a><b></a>"}}).find("not XML"), std::string::npos);
}

TEST_F(X3p, HostileArchivesAreRefused) {
  Xml xml;
  // Names that lead out of the archive lead nowhere.
  for (const char* link : {"../../../../etc/passwd", "/etc/passwd", "..\\..\\secret.bin"}) {
    xml.heights = fmt::format("<DataLink><PointDataLink>{}</PointDataLink></DataLink>", link);
    EXPECT_NE(refused({{"main.xml", xml.text()}, {"bindata/data.bin", bytesOf(kHeights)}}).find("holds no"),
              std::string::npos);
  }
  xml = {};
  for (const char* side : {"2147483648", "262144", "1e300", "nan"}) {
    xml.width = xml.height = side;
    refused({{"main.xml", xml.text()}, {"bindata/data.bin", bytesOf(kHeights)}});
  }
  // A bomb: 300 MB of zeros, promised as such; the file holds the first 5 of them.
  xml.width = "10000";
  xml.height = "7500";
  xml.type = "F";
  EXPECT_NE(refused({{"main.xml", xml.text()}, {"bindata/data.bin", std::string(5000000, '\0')}})
                .find("made to fill memory"),
            std::string::npos);
  // Entities that double each other, elements without end, a document of nothing.
  std::string laughs = "<?xml version=\"1.0\"?><!DOCTYPE a [<!ENTITY b0 \"ha\">";
  for (int i = 1; i < 40; ++i) laughs += fmt::format("<!ENTITY b{} \"&b{};&b{};\">", i, i - 1, i - 1);
  refused({{"main.xml", laughs + "]><a>&b39;</a>"}});
  std::string deep;
  for (int i = 0; i < 600000; ++i) deep += "<a>";
  refused({{"main.xml", deep}});
  EXPECT_NE(refused({{"main.xml", "<a>" + std::string(50 << 20, ' ')}}).find("too long"), std::string::npos);
  xml = {};
  xml.heights = "<DataList><Datum>" + std::string(50 << 20, '1');
  EXPECT_NE(refused({{"main.xml", xml.text()}}).find("row 1 of 2"), std::string::npos);
}

TEST_F(X3p, NoBeginningOfAnArchiveIsTakenForTheWhole) {
  zip(folder_.file("whole.x3p"), {{"main.xml", Xml{}.text()}, {"bindata/data.bin", bytesOf(kHeights)}});
  const std::string whole = readBytes(folder_.file("whole.x3p"));
  for (std::size_t bytes = 4; bytes < whole.size(); bytes += 7) {
    writeBytes(folder_.file("cut.x3p"), whole.substr(0, bytes));
    EXPECT_FALSE(engine::load(folder_.file("cut.x3p"))) << bytes;
  }
}

TEST_F(X3p, OtherProgramsFindMetresInWhatIsWritten) {
  Grid grid = gridOf(2, 1);
  grid.lateral_unit = grid.height_unit = {"um", 1e-3};
  grid.spacing_x = 2.5;
  ASSERT_TRUE(save(makeField(grid, {1.5F, kNan}), folder_.file("out.x3p")));
  const auto file = InputFile::open(folder_.file("out.x3p"));
  ASSERT_TRUE(file);
  ZipReader zip_file(*file);
  std::array<double, 2> metres{};
  ASSERT_TRUE(zip_file.find("bindata/data.bin"));
  EXPECT_EQ(zip_file.read(reinterpret_cast<char*>(metres.data()), 16).value_or(0), 16U);
  EXPECT_DOUBLE_EQ(metres[0], 1.5e-6);
  EXPECT_TRUE(std::isnan(metres[1]));
  ASSERT_TRUE(zip_file.find("main.xml"));
  std::string xml(4000, '\0');
  xml.resize(zip_file.read(xml.data(), xml.size()).value_or(0));
  EXPECT_NE(xml.find("<Increment>2.5e-06</Increment>"), std::string::npos) << xml;
  ASSERT_TRUE(zip_file.find("md5checksum.hex"));
  std::string sum(32, '\0');
  EXPECT_EQ(zip_file.read(sum.data(), 32).value_or(0), 32U);
  EXPECT_EQ(sum, md5Of(xml));
}

}  // namespace
}  // namespace fettle::engine
