// Every way in which a file may be wrong: one clear line, nothing on stderr, little memory.

#include <algorithm>
#include <cstring>
#include <filesystem>

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/stat.h>

#include "engine/formats/formats.h"
#include "tests/engine/io/io_support.h"
#include "tests/support/temp_folder.h"

namespace fettle::engine {
namespace {

using tests::TempFolder;

long peakKilobytes() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return usage.ru_maxrss;
}

// Loads a file that must be refused, and checks the manner of the refusal.
Error refusal(const std::string& path, const ImportOptions& options = {}) {
  const long before = peakKilobytes();
  ::testing::internal::CaptureStderr();
  const auto scan = load(path, options);
  EXPECT_EQ(::testing::internal::GetCapturedStderr(), "") << path;
  EXPECT_FALSE(scan) << path;
  if (scan) return {};
  EXPECT_EQ(scan.error().kind, ErrorKind::kInput) << scan.error().line();
  EXPECT_EQ(scan.error().line().find('\n'), std::string::npos);
  EXPECT_FALSE(scan.error().what.empty());
  EXPECT_LT(peakKilobytes() - before, 256 * 1024) << path;
  return scan.error();
}

Error refusalOf(const TempFolder& folder, const std::string& name, const std::string& bytes) {
  writeBytes(folder.file(name), bytes);
  return refusal(folder.file(name));
}

// Every file that is a proper beginning of a good one. Some still hold all samples; those may be read.
void expectNoPrefixReadsWrongly(const std::string& name, const Version& field, std::size_t step) {
  const TempFolder folder;
  ASSERT_TRUE(save(field, folder.file(name)));
  const std::string whole = readBytes(folder.file(name));
  for (std::size_t bytes = 0; bytes < whole.size(); bytes += step) {
    writeBytes(folder.file("cut" + name), whole.substr(0, bytes));
    const auto scan = load(folder.file("cut" + name));
    if (scan) {
      EXPECT_EQ(contentHash(scan->field), contentHash(field))
          << name << " cut to " << bytes << " of " << whole.size();
    } else {
      EXPECT_EQ(scan.error().kind, ErrorKind::kInput);
    }
  }
}

Version someField() {
  std::vector<float> z;
  for (int i = 0; i < 60 * 50; ++i)
    z.push_back(static_cast<float>(i % 61) * 1.37F + static_cast<float>(i) * 0.01F);
  return makeField(gridOf(60, 50), z);
}

std::string number(std::uint64_t value, int bytes, bool big = false) {
  std::string out;
  for (int i = 0; i < bytes; ++i) out += static_cast<char>(value >> (8 * (big ? bytes - 1 - i : i)));
  return out;
}

// A one-strip little-endian TIFF of 8-bit grey whose header may lie.
std::string tiff(std::uint32_t width, std::uint32_t height, std::uint32_t strip_bytes,
                 const std::string& strip, std::uint32_t compression = 1) {
  std::string ifd = number(9, 2);
  const auto entry = [&](std::uint32_t tag, std::uint32_t value) {
    ifd += number(tag, 2) + number(4, 2) + number(1, 4) + number(value, 4);
  };
  entry(256, width);
  entry(257, height);
  entry(258, 8);
  entry(259, compression);
  entry(262, 1);
  entry(273, 8 + 2 + 9 * 12 + 4);
  entry(277, 1);
  entry(278, height);
  entry(279, strip_bytes);
  return std::string("II*\0", 4) + number(8, 4) + ifd + number(0, 4) + strip;
}

TEST(BadInput, TheSyntheticTiffIsSoundWhenItDoesNotLie) {
  const TempFolder folder;
  writeBytes(folder.file("t.tif"), tiff(2, 2, 4, "\x01\x02\x03\x04"));
  FETTLE_LOAD(scan, folder.file("t.tif"));
  EXPECT_EQ(stored(scan.field, 1, 0), 3.0F);
}

TEST(BadInput, PathsThatAreNoFilesAreRefused) {
  const TempFolder folder;
  EXPECT_NE(refusal(folder.file("none.tif")).what.find("No such file"), std::string::npos);
  EXPECT_NE(refusal(folder.path().string()).what.find("folder"), std::string::npos);
  refusal("/dev/zero");
  refusal("/dev/null");
  refusal("");
  refusal("/vsicurl/http://localhost/a.tif");
  refusal("/vsizip/" + folder.file("a.zip"));
  refusal("GTIFF_DIR:1:" + folder.file("a.tif"));
  ASSERT_EQ(mkfifo(folder.file("pipe.tif").c_str(), 0600), 0);
  refusal(folder.file("pipe.tif"));
  refusal(std::string(5000, 'x'));
}

TEST(BadInput, EmptyFilesAndOtherContentsAreRefusedUnderEveryName) {
  const TempFolder folder;
  for (const char* name : {"a.tif", "a.png", "a.asc", "a.xyz", "a.ply", "a.bin"}) {
    EXPECT_EQ(refusalOf(folder, name, "").what, "the file is empty");
    refusalOf(folder, name, std::string(1000, '\0'));
    refusalOf(folder, name, "PK\x03\x04 a zip");
    refusalOf(folder, name, "a plain text\nwithout a number\n");
    refusalOf(folder, name, "%PDF-1.4\n%\xe2\xe3\xcf\xd3\n1 0 obj");
    refusalOf(folder, name, "\x89PNG\r\n\x1a\n");
    refusalOf(folder, name, std::string("II*\0", 4));
    refusalOf(folder, name, std::string("II*\0\xff\xff\xff\xff", 8));
    refusalOf(folder, name, std::string("MM\0+\0\x08\0\0\xff\xff\xff\xff\xff\xff\xff\xff", 16));
  }
}

TEST(BadInput, AbsurdSizesAreRefusedBeforeMemoryIsTaken) {
  const TempFolder folder;
  refusalOf(folder, "a.tif", tiff(0x80000000U, 0x80000000U, 4, "abcd"));
  refusalOf(folder, "a.tif", tiff(0xffffffffU, 1, 4, "abcd"));
  refusalOf(folder, "a.tif", tiff(200000, 200000, 4, "abcd"));
  refusalOf(folder, "a.tif", tiff(60000, 60000, 0xfffffff0U, "abcd"));
  refusalOf(folder, "a.tif", tiff(60000, 60000, 4, "abcd", 5));
  refusalOf(folder, "a.tif", tiff(60000, 60000, 4, "abcd", 8));
  refusalOf(folder, "a.tif", tiff(0, 5, 4, "abcd"));
  refusalOf(folder, "a.asc",
            "ncols 2147483648\nnrows 2147483648\nxllcorner 0\nyllcorner 0\ncellsize 1\n1 2 3");
  refusalOf(folder, "a.asc", "ncols 200000\nnrows 200000\nxllcorner 0\nyllcorner 0\ncellsize 1\n1 2 3");
  refusalOf(folder, "a.asc", "ncols -4\nnrows 4\nxllcorner 0\nyllcorner 0\ncellsize 1\n1 2 3");
  refusalOf(folder, "a.asc", "ncols 1.5\nnrows 4\nxllcorner 0\nyllcorner 0\ncellsize 1\n1 2 3 4 5 6");
  refusalOf(folder, "a.asc", "ncols 1e30\nnrows nan\nxllcorner 0\nyllcorner 0\ncellsize 1\n1 2 3 4 5 6");
  const std::string ply = "ply\nformat binary_little_endian 1.0\nelement vertex ";
  const std::string rest = "\nproperty float x\nproperty float y\nproperty float z\nend_header\n0123456789ab";
  refusalOf(folder, "a.ply", ply + "4000000000000" + rest);
  refusalOf(folder, "a.ply", ply + "18446744073709551615" + rest);
  refusalOf(folder, "a.ply", ply + "99999999999999999999999" + rest);
  refusalOf(folder, "a.ply", ply + "-1" + rest);
  refusalOf(folder, "a.ply", ply + "2" + rest);
}

TEST(BadInput, APngWithALyingHeaderIsRefused) {
  const TempFolder folder;
  ASSERT_TRUE(save(someField(), folder.file("good.png")));
  const std::string good = readBytes(folder.file("good.png"));
  for (const std::uint32_t side : {0U, 60000U, 200000U, 0x7fffffffU, 0xffffffffU}) {
    std::string bad = good;
    bad.replace(16, 8, number(side, 4, true) + number(side, 4, true));
    refusalOf(folder, "bad.png", bad);
  }
}

// The checksum of PNG's chunks (ISO 15948, annex D), bit by bit.
std::uint32_t pngChecksum(const std::string& bytes) {
  std::uint32_t sum = 0xffffffffU;
  for (const char byte : bytes) {
    sum ^= static_cast<unsigned char>(byte);
    for (int bit = 0; bit < 8; ++bit) sum = (sum >> 1U) ^ ((sum & 1U) != 0 ? 0xedb88320U : 0U);
  }
  return ~sum;
}

// Deflate makes one byte of 1032 at most; 64 MB are believed without that.
TEST(BadInput, APngThatPromisesMoreThanItsBytesCanHoldIsRefusedByThat) {
  const TempFolder folder;
  ASSERT_TRUE(save(someField(), folder.file("good.png")));
  const std::string good = readBytes(folder.file("good.png"));
  ASSERT_EQ(good.substr(24, 2), std::string("\x10\0", 2)) << "16 bits of grey";
  const double most = (64 << 20) + 1032.0 * static_cast<double>(good.size());
  constexpr std::uint32_t kRows = 2000;
  for (const double share : {1.02, 0.98}) {
    const auto columns = static_cast<std::uint32_t>(share * most / kRows / 2.0);
    std::string lying = good;
    lying.replace(16, 8, number(columns, 4, true) + number(kRows, 4, true));
    lying.replace(29, 4, number(pngChecksum(lying.substr(12, 17)), 4, true));
    const std::string line = refusalOf(folder, "lying.png", lying).line();
    EXPECT_EQ(line.find("the header states") != std::string::npos, share > 1.0) << line;
  }
}

// A raster of holes is one, as a scan of glass; a cloud without a point has no place.
TEST(BadInput, RastersWithoutAnyHeightAreReadWithAWarningAndCloudsRefused) {
  const TempFolder folder;
  const auto read = [&](const std::string& path, const ImportOptions& options) {
    JobControl job;
    const auto imported = importField(path, options, job);
    ASSERT_TRUE(imported) << imported.error().line();
    EXPECT_EQ(summarize(imported->field).no_data, imported->field.grid().samples()) << path;
    EXPECT_TRUE(std::ranges::any_of(imported->warnings, [](const std::string& warning) {
      return warning.find("every sample is no-data") != std::string::npos;
    })) << path;
  };
  ImportOptions options;
  options.unit = lengthUnitFromName("mm");
  writeBytes(folder.file("a.asc"),
             "ncols 2\nnrows 1\nxllcorner 0\nyllcorner 0\ncellsize 1\nNODATA_value 7\n7 7\n");
  read(folder.file("a.asc"), options);
  writeBytes(folder.file("b.asc"), "ncols 2\nnrows 1\nxllcorner 0\nyllcorner 0\ncellsize 1\nnan inf\n");
  read(folder.file("b.asc"), options);
  const Version holes = makeField(gridOf(5, 5), std::vector<float>(25, kNan));
  for (const char* name : {"h.tif", "h.asc"}) {
    ASSERT_TRUE(save(holes, folder.file(name)));
    read(folder.file(name), options);
  }
  writeBytes(folder.file("a.tif"), tiff(2, 2, 4, std::string(4, '\0')));
  options.no_data = 0.0;
  read(folder.file("a.tif"), options);
  refusalOf(folder, "a.xyz", "nan 1 2\n1 inf 2\n1 2 -inf\n");
  refusalOf(folder, "a.ply",
            "ply\nformat ascii 1.0\nelement vertex 0\nproperty float x\nproperty float y\nproperty float "
            "z\nend_header\n");
  ASSERT_TRUE(save(holes, folder.file("h.ply")));
  refusal(folder.file("h.ply"));
}

TEST(BadInput, NoBeginningOfAFileIsTakenForTheWhole) {
  expectNoPrefixReadsWrongly("a.tif", someField(), 61);
  expectNoPrefixReadsWrongly("a.png", someField(), 61);
  expectNoPrefixReadsWrongly("a.ply", someField(), 613);
}

// The tiff() above with a tag more, ASCII, its value at the end of the file unless it fits the entry.
std::string tiffWithText(std::uint32_t tag, const std::string& value) {
  const std::size_t directory = 2 + 10 * 12 + 4;
  std::string bytes = tiff(2, 2, 4, "\x01\x02\x03\x04");
  const std::string entry =
      number(tag, 2) + number(2, 2) + number(value.size(), 4) +
      (value.size() <= 4 ? value + std::string(4 - value.size(), '\0') : number(8 + directory + 4, 4));
  bytes[8] = 10;
  bytes.insert(10 + 9 * 12, entry);
  bytes.replace(10 + 5 * 12 + 8, 4, number(8 + directory, 4));  // the strip has moved
  return value.size() <= 4 ? bytes : bytes + value;
}

TEST(BadInput, ATiffWhoseTagValuesAreCutIsRefused) {
  const TempFolder folder;
  for (const std::uint32_t tag : {42113U, 34737U, 65000U}) {  // hole value, names of the CRS, private
    const std::string whole = tiffWithText(tag, std::string("2.0000000", 10));
    writeBytes(folder.file("t.tif"), whole);
    FETTLE_LOAD(scan, folder.file("t.tif"));
    EXPECT_EQ(summarize(scan.field).no_data, tag == 42113 ? 1 : 0);
    for (std::size_t bytes = 0; bytes < whole.size(); ++bytes) {
      const Error error = refusalOf(folder, "t.tif", whole.substr(0, bytes));
      if (bytes + 10 >= whole.size()) {
        EXPECT_EQ(error.remedy, "the file is cut short");
      }
    }
    std::string lying = whole;
    lying.replace(10 + 9 * 12 + 4, 4, "\xff\xff\xff\xff");
    refusalOf(folder, "t.tif", lying);
  }
  // Four characters lie within the entry: their bytes are no place in the file.
  writeBytes(folder.file("t.tif"), tiffWithText(42113, std::string("2.0", 4)));
  FETTLE_LOAD(inside, folder.file("t.tif"));
  EXPECT_EQ(summarize(inside.field).no_data, 1);
  // A type that no specification knows: its size is not known, readers skip it.
  std::string unknown = tiffWithText(65000, std::string("2.0000000", 10));
  unknown.replace(10 + 9 * 12 + 2, 2, number(99, 2));
  writeBytes(folder.file("t.tif"), unknown);
  FETTLE_LOAD(skipped, folder.file("t.tif"));
  EXPECT_EQ(summarize(skipped.field).no_data, 0);
}

TEST(BadInput, ATiffWhoseNextDirectoryIsCutOffIsRefused) {
  const TempFolder folder;
  std::string bytes = tiff(2, 2, 4, "\x01\x02\x03\x04");
  bytes.replace(10 + 9 * 12, 4, number(bytes.size(), 4));
  EXPECT_EQ(refusalOf(folder, "t.tif", bytes).remedy, "the file is cut short");
}

TEST(BadInput, DamagedBytesNeverCrashAReader) {
  const TempFolder folder;
  std::uint32_t state = 5;
  const auto random = [&state] { return state = state * 1664525U + 1013904223U, state >> 8; };
  for (const std::string name : {"a.tif", "a.png", "a.ply", "a.asc", "a.xyz"}) {
    ASSERT_TRUE(save(someField(), folder.file(name)));
    const std::string whole = readBytes(folder.file(name));
    for (int round = 0; round < 150; ++round) {
      std::string bad = whole;
      const std::size_t within = round % 2 == 0 ? std::min<std::size_t>(bad.size(), 400) : bad.size();
      for (int k = 0; k <= round % 4; ++k) bad[random() % within] = static_cast<char>(random());
      writeBytes(folder.file("bad" + name), bad);
      ::testing::internal::CaptureStderr();
      const auto scan = load(folder.file("bad" + name));
      EXPECT_EQ(::testing::internal::GetCapturedStderr(), "");
      if (!scan) {
        EXPECT_EQ(scan.error().kind, ErrorKind::kInput) << scan.error().line();
      }
    }
  }
}

TEST(BadInput, AsciiGridsSayWhereTheyAreWrong) {
  const TempFolder folder;
  const std::string head = "ncols 2\nnrows 2\nxllcorner 0\nyllcorner 0\ncellsize 1\n";
  EXPECT_NE(refusalOf(folder, "a.asc", head + "1 2\n3").what.find("row 2 of 2"), std::string::npos);
  EXPECT_NE(refusalOf(folder, "a.asc", head + "1,5 2\n3 4").what.find("decimal comma"), std::string::npos);
  EXPECT_NE(refusalOf(folder, "a.asc", head + "1 2\n3 x").what.find("row 2, column 2"), std::string::npos);
  EXPECT_NE(refusalOf(folder, "a.asc", "ncols 2\nnrows 2\n1 2 3 4 5").what.find("cellsize"),
            std::string::npos);
  EXPECT_NE(
      refusalOf(folder, "a.asc", "ncols 2\nnrows 2\ncellsize 0,5\n1 2 3 4 5").what.find("decimal comma"),
      std::string::npos);
}

TEST(BadInput, AsciiGridsWithoutAPositiveSpacingAreRefused) {
  const TempFolder folder;
  for (const char* spacing :
       {"cellsize 0", "cellsize -1", "dx 0\ndy 1", "dx 1\ndy 0", "dx -1\ndy 1", "dx 1\ndy -1"})
    EXPECT_NE(
        refusalOf(folder, "a.asc",
                  "ncols 2\nnrows 2\nxllcorner 0\nyllcorner 0\n" + std::string(spacing) + "\n1 2\n3 4\n")
            .what.find("no positive cellsize"),
        std::string::npos)
        << spacing;
}

TEST(BadInput, PointFilesSayWhereTheyAreWrong) {
  const TempFolder folder;
  EXPECT_NE(refusalOf(folder, "a.xyz", "1 2 3\n4 5\n").what.find("line 2"), std::string::npos);
  EXPECT_NE(refusalOf(folder, "a.xyz", "1,5 2,5 3,5\n").what.find("decimal commas"), std::string::npos);
  EXPECT_NE(refusalOf(folder, "a.csv", "1,5;2,5;3,5\n").what.find("decimal commas"), std::string::npos);
  EXPECT_NE(
      refusalOf(
          folder, "a.ply",
          "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nend_header\n1 2\n")
          .what.find("\"z\""),
      std::string::npos);
  refusalOf(folder, "a.ply", "ply\nformat ascii 1.0\nelement vertex 1\nproperty half x\nend_header\n1 2\n");
  refusalOf(folder, "a.ply", "ply\nelement vertex 1\n");
  refusalOf(folder, "a.xyz", std::string(3 << 20, '1'));
}

TEST(BadInput, DecimalCommasAnywhereInALineOfPointsAreNamed) {
  const TempFolder folder;
  // One in a line is enough, also of a later line: none of these is read as something else.
  for (const char* text : {"0 0 1,5\n1 0 2,5\n", "0 0 0\n1 0 1,25\n", "0;0;3,5\n", "1,5, 2,5, 3,5\n",
                           "1.234,5 2.000,25 3,5\n", "-1,5e1\t2\t3\t128\n"}) {
    const Error error = refusalOf(folder, "a.xyz", text);
    EXPECT_NE(error.what.find("decimal commas"), std::string::npos) << text << error.line();
    EXPECT_NE(error.remedy.find("tr , ."), std::string::npos) << text;
  }
  // Commas that stand between numbers are none.
  for (const char* text : {"0,0,1\n1,0,2\n0,1,3\n", "0, 0, 1\n1, 0, 2\n", "0.5,0.5 ,1\n1.5,0.5 ,2\n"}) {
    writeBytes(folder.file("b.xyz"), text);
    EXPECT_TRUE(load(folder.file("b.xyz"))) << text;
  }
}

TEST(BadInput, ImpossibleOptionsAreRefused) {
  const TempFolder folder;
  writeBytes(folder.file("a.xyz"), "1 2 3\n");
  for (const double bad : {0.0, -1.0, double{kNan}, double{kInf}}) {
    ImportOptions options;
    options.spacing = std::pair{bad, 1.0};
    EXPECT_EQ(refusal(folder.file("a.xyz"), options).where, "--spacing");
    options = {};
    options.cell_size = bad;
    EXPECT_EQ(refusal(folder.file("a.xyz"), options).where, "--cell-size");
    options = {};
    options.z_scale = bad == -1.0 ? 0.0 : bad;
    EXPECT_EQ(refusal(folder.file("a.xyz"), options).where, "--z-scale");
  }
}

TEST(BadInput, ACancelledImportSaysSo) {
  const TempFolder folder;
  for (const char* name : {"a.tif", "a.png", "a.asc", "a.xyz", "a.ply"}) {
    ASSERT_TRUE(save(someField(), folder.file(name)));
    JobControl job;
    job.cancel();
    const auto scan = importField(folder.file(name), {}, job);
    ASSERT_FALSE(scan) << name;
    EXPECT_EQ(scan.error().kind, ErrorKind::kCancelled) << name;
  }
}

}  // namespace
}  // namespace fettle::engine
