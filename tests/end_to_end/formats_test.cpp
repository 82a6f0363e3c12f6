// Formats as a user meets them at the program: how a TIFF is packed, holes that a file hardly declares,
// points with a header.

#include <filesystem>
#include <fstream>

#include <gtest/gtest.h>

#include "tests/end_to_end/program.h"
#include "tests/support/temp_folder.h"

namespace fettle::tests {
namespace {

void writeText(const std::string& path, const std::string& text) {
  std::ofstream(path, std::ios::binary) << text;
}

TEST(Formats, CompressSaysHowATiffIsPackedAndOnlyATiff) {
  const TempFolder folder;
  const std::string scan = folder.file("scan.tif");
  ASSERT_EQ(fettle({"synth", scan, "--size", "300x280", "--seed", "5"}).status, 0);
  const auto samples = [](const std::string& path) { return fettleJson({"compare", path, path})["rms"]; };
  std::uintmax_t plain = 0;
  for (const std::string name : {"none", "lzw", "deflate", "zstd"}) {
    const std::string out = folder.file(name + ".tif"), filtered = folder.file(name + "_f.tif");
    EXPECT_EQ(fettle({"convert", scan, out, "--compress", name}).status, 0) << name;
    EXPECT_EQ(fettleJson({"compare", scan, out})["max_abs"], 0.0) << name;
    EXPECT_EQ(fettle({"filter", scan, filtered, "--filter", "box", "--compress", name}).status, 0) << name;
    EXPECT_EQ(samples(filtered), 0.0);
    if (name == "none") plain = std::filesystem::file_size(filtered);
    if (name == "deflate" || name == "zstd") {
      EXPECT_LT(std::filesystem::file_size(filtered), plain) << name;
    }
  }
  // Said before anything is read, so that nobody waits for a filter whose result cannot be written.
  for (const char* command : {"convert", "filter"}) {
    std::vector<std::string> arguments{command, scan, folder.file("no.asc"), "--compress", "lzw"};
    if (command == std::string("filter")) arguments.insert(arguments.end(), {"--filter", "box"});
    expectRefused(fettle(arguments), "--compress");
    EXPECT_FALSE(std::filesystem::exists(folder.file("no.asc")));
  }
  EXPECT_EQ(fettle({"convert", scan, folder.file("no.tif"), "--compress", "jpeg"}).status, 2);
  EXPECT_FALSE(std::filesystem::exists(folder.file("no.tif")));
}

TEST(Formats, SdfIsWrittenInBothFormsAndOnlySdfIsAskedForText) {
  const TempFolder folder;
  const std::string scan = folder.file("scan.tif"), text = folder.file("t.sdf"),
                    binary = folder.file("b.sdf");
  ASSERT_EQ(fettle({"synth", scan, "--size", "60x50", "--dropouts", "1"}).status, 0);
  EXPECT_EQ(fettleJson({"convert", scan, text, "--ascii"})["format"], "SDF");
  EXPECT_EQ(fettleJson({"convert", scan, binary})["format"], "SDF");
  EXPECT_EQ(std::filesystem::file_size(binary), 81U + 60U * 50U * 8U);
  for (const std::string& file : {text, binary}) {
    EXPECT_EQ(fettleJson({"compare", scan, file})["max_abs"], 0.0);
    EXPECT_EQ(fettleJson({"info", file})["no_data"], fettleJson({"info", scan})["no_data"]);
  }
  expectRefused(fettle({"convert", scan, folder.file("no.tif"), "--ascii"}), "--ascii");
  EXPECT_FALSE(std::filesystem::exists(folder.file("no.tif")));
}

TEST(Formats, HolesOfAPngThatFettleWroteStayHolesThroughAFilter) {
  const TempFolder folder;
  std::string grid = "ncols 60\nnrows 50\nxllcorner 0\nyllcorner 0\ncellsize 1\nNODATA_value -9999\n";
  for (int i = 0; i < 3000; ++i) grid += i % 6 == 1 ? "-9999 " : std::to_string(100 + i % 17) + " ";
  writeText(folder.file("scan.asc"), grid);
  ASSERT_EQ(fettle({"convert", folder.file("scan.asc"), folder.file("scan.png")}).status, 0);
  EXPECT_EQ(fettleJson({"info", folder.file("scan.png")})["no_data"], 500);
  ASSERT_EQ(fettle({"filter", folder.file("scan.png"), folder.file("out.tif"), "--filter", "median"}).status,
            0);
  EXPECT_EQ(fettleJson({"info", folder.file("out.tif")})["no_data"], 500);
}

TEST(Formats, PointsTakeTheColumnsThatAHeaderNamesOrAreRefused) {
  const TempFolder folder;
  writeText(folder.file("named.csv"), "id,z,x,y\n7,5,0,0\n8,6,1,0\n9,5,0,1\n7,8,1,1\n");
  const auto info = fettleJson({"info", folder.file("named.csv")});
  EXPECT_EQ(info["min"], 5.0);
  EXPECT_EQ(info["max"], 8.0);
  EXPECT_EQ(info["width"], 2);
  writeText(folder.file("unnamed.csv"), "id,a,b,c\n7,5,0,0\n8,6,1,0\n9,5,0,1\n7,8,1,1\n");
  expectRefused(fettle({"info", folder.file("unnamed.csv")}), "id, a, b, c");
}

}  // namespace
}  // namespace fettle::tests
