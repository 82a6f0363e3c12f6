// fettle fill, as a user types it, and what is known of filled samples afterwards.

#include <cmath>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tests/end_to_end/program.h"
#include "tests/support/temp_folder.h"

namespace fettle::tests {
namespace {

// A plane of 60 x 50 samples with a hole of 8 x 6 samples in it, one of 2 x 2, and one at the border. ESRI ASCII.
void writeHoled(const std::string& path, bool step = false) {
  std::ofstream out(path);
  out << "ncols 60\nnrows 50\nxllcenter 0\nyllcenter 0\ncellsize 0.5\nNODATA_value -9999\n";
  for (int r = 49; r >= 0; --r) {
    for (int c = 0; c < 60; ++c) {
      const bool hole = (c >= 20 && c < 28 && r >= 20 && r < 26) || (c >= 40 && c < 42 && r >= 8 && r < 10) ||
                        (c < 3 && r < 3);
      out << (hole ? -9999.0 : 0.25 * c + 0.5 * r + (step && c >= 24 ? 5.0 : 0.0)) << ' ';
    }
    out << '\n';
  }
}

// A run whose report was held against its schema and is read by another command.
void runWhole(const std::vector<std::string>& arguments) {
  EXPECT_FALSE(fettleJson(arguments).empty());
}

TEST(FillCommand, FillsHolesUpToASizeAndSaysWhatStays) {
  const TempFolder folder;
  const std::string scan = folder.file("s.asc"), out = folder.file("o.tif");
  writeHoled(scan);
  const auto all = fettleJson({"fill", scan, out, "--unit", "mm", "--filled-out", folder.file("f.png")});
  EXPECT_EQ(all["holes"], 3);
  EXPECT_EQ(all["filled_holes"], 2);
  EXPECT_EQ(all["filled"], 52);
  EXPECT_EQ(all["at_border"], 1);
  EXPECT_EQ(all["no_data"], 9);
  const auto info = fettleJson({"info", out, "--at", "26,23", "--at", "49,0"});
  EXPECT_NEAR(info["at"][0]["height"].get<double>(), 0.25 * 23 + 0.5 * 23, 1e-5);
  EXPECT_TRUE(info["at"][1]["height"].is_null());
  // The picture of filled samples has as many as the report.
  EXPECT_EQ(fettleJson({"mark", scan, folder.file("m.png"), "--unit", "mm", "--add",
                        folder.file("f.png")})["marked"],
            52);
  EXPECT_EQ(fettleJson({"fill", scan, out, "--unit", "mm", "--max-extent", "1mm"})["filled"], 4);
  EXPECT_EQ(fettleJson({"fill", scan, out, "--unit", "mm", "--max-area", "0.9"})["filled"], 0);
  const auto border = fettleJson({"fill", scan, out, "--unit", "mm", "--border", "--method", "membrane"});
  EXPECT_EQ(border["no_data"], 0);
  EXPECT_EQ(border["filled"], 61);
}

TEST(FillCommand, ASessionKnowsItsFilledSamplesThroughLaterWork) {
  const TempFolder folder;
  const std::string scan = folder.file("s.asc"), session = folder.file("o.fettle");
  writeHoled(scan);
  runWhole({"fill", scan, session, "--unit", "mm"});
  EXPECT_EQ(fettleJson({"info", session})["filled"], 52);
  const std::string filtered = folder.file("g.fettle"), level = folder.file("l.fettle");
  runWhole({"filter", session, filtered, "--filter", "gaussian"});
  EXPECT_EQ(fettleJson({"info", filtered})["filled"], 52);
  runWhole({"level", filtered, level});
  EXPECT_EQ(fettleJson({"info", level})["filled"], 52);
  // Filled again after a part of it was: what is filled now and what was.
  const std::string small = folder.file("a.fettle"), more = folder.file("b.fettle");
  runWhole({"fill", scan, small, "--unit", "mm", "--max-extent", "1mm"});
  runWhole({"fill", small, more});
  EXPECT_EQ(fettleJson({"info", more})["filled"], 52);

  const auto measured = fettleJson({"measure", level, "--only", "hybrid"});
  EXPECT_EQ(measured["filled"], 52);
  EXPECT_EQ(measured["samples"], 60 * 50 - 9);
  const auto left_out = fettleJson({"measure", level, "--only", "hybrid", "--region", "measured"});
  EXPECT_EQ(left_out["filled"], 0);
  EXPECT_EQ(left_out["samples"], 60 * 50 - 61);
  EXPECT_EQ(fettleJson({"mark", session, folder.file("m.png"), "--filled"})["marked"], 52);
  runWhole({"report", session, folder.file("r.html"), "--region", "measured"});
  expectRefused(fettle({"measure", scan, "--unit", "mm", "--region", "measured"}),
                "which samples were filled");
  expectRefused(fettle({"mark", scan, folder.file("n.png"), "--filled"}), "which samples were filled");
}

TEST(FillCommand, GoesUpToALineOnBothSides) {
  const TempFolder folder;
  const std::string scan = folder.file("s.asc"), lines = folder.file("l.geojson"), out = folder.file("o.tif");
  writeHoled(scan, true);
  // Between columns 23 and 24, drawn right through the hole; in millimetres.
  std::ofstream(lines) << R"({"type": "FeatureCollection", "features": [{"type": "Feature", "properties": {},
    "geometry": {"type": "LineString", "coordinates": [[11.75, 1], [11.75, 20]]}}]})";
  runWhole({"fill", scan, out, "--unit", "mm", "--lines", lines});
  const auto info = fettleJson({"info", out, "--at", "26,23", "--at", "26,24"});
  EXPECT_NEAR(info["at"][0]["height"].get<double>(), 0.25 * 23 + 0.5 * 23, 1e-4);
  EXPECT_NEAR(info["at"][1]["height"].get<double>(), 0.25 * 24 + 0.5 * 23 + 5.0, 1e-4);
}

TEST(FillCommand, SaysWhatItCannotDo) {
  const TempFolder folder;
  const std::string scan = folder.file("s.asc"), out = folder.file("o.tif");
  writeHoled(scan);
  // A file that cannot store which samples were filled is said to.
  const Outcome plain = fettle({"fill", scan, out, "--unit", "mm"});
  EXPECT_EQ(plain.status, 0);
  EXPECT_NE(plain.err.find("--filled-out"), std::string::npos) << plain.err;
  EXPECT_EQ(
      fettle({"fill", scan, out, "--unit", "mm", "--filled-out", folder.file("f.png")}).err.find("--filled"),
      std::string::npos);
  std::filesystem::remove(out);
  expectRefused(fettle({"fill", scan, out, "--unit", "mm", "--max-extent", "0"}), "--max-extent");
  expectRefused(fettle({"fill", scan, out, "--unit", "mm", "--max-extent", "wide"}), "--max-extent");
  expectRefused(fettle({"fill", scan, "--out-dir", folder.file("d"), "--filled-out", folder.file("f.png")}),
                "--filled-out");
  expectRefused(fettle({"fill", scan, out, "--filled-out", out}), "o.tif");
  expectRefused(fettle({"fill", scan, scan, "--unit", "mm"}), "s.asc");
  const std::string none = folder.file("none.asc");
  std::ofstream(none) << "ncols 3\nnrows 3\nxllcenter 0\nyllcenter 0\ncellsize 1\nNODATA_value -9999\n"
                      << "-9999 -9999 -9999\n-9999 -9999 -9999\n-9999 -9999 -9999\n";
  EXPECT_EQ(fettle({"fill", none, out, "--unit", "mm", "--border"}).status, 2);
  EXPECT_FALSE(std::filesystem::exists(out));
}

}  // namespace
}  // namespace fettle::tests
