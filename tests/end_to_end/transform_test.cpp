// fettle transform, as a user types it.

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

namespace fs = std::filesystem;

// 40 x 30 samples, 0.5 mm apart, with a hole; the height says where a sample was. ESRI ASCII.
std::string ramp(const TempFolder& folder) {
  std::ofstream out(folder.file("s.asc"));
  out << "ncols 40\nnrows 30\nxllcenter 1000\nyllcenter 2000\ncellsize 0.5\nNODATA_value -9999\n";
  for (int r = 29; r >= 0; --r) {
    for (int c = 0; c < 40; ++c) out << (r == 4 && c == 6 ? -9999 : 100 * r + c) << ' ';
    out << '\n';
  }
  return folder.file("s.asc");
}

nlohmann::json transformTo(const std::string& scan, const std::string& out,
                           std::vector<std::string> options) {
  std::vector<std::string> all{"transform", scan, out, "--unit", "mm"};
  all.insert(all.end(), options.begin(), options.end());
  return fettleJson(all);
}

double heightAt(const std::string& scan, const std::string& row_column) {
  const auto info = fettleJson({"info", scan, "--at", row_column});
  const auto& z = info["at"][0]["height"];
  return z.is_null() ? -1.0 : z.get<double>();
}

TEST(TransformCommand, CropsBySamplesAndByCoordinates) {
  const TempFolder folder;
  const std::string scan = ramp(folder), a = folder.file("a.tif"), b = folder.file("b.tif");
  const auto by_samples =
      transformTo(scan, a, {"--crop-samples", "19,5,10,20"});  // rows 1 to 10, columns 5 to 24
  const auto by_lengths = transformTo(scan, b, {"--crop", "2.5,0.5,12,5"});
  EXPECT_EQ(by_samples["hash"], by_lengths["hash"]);
  EXPECT_EQ(by_samples["width"], 20);
  EXPECT_EQ(by_samples["height"], 10);
  EXPECT_EQ(by_samples["no_data"], 1);
  EXPECT_EQ(by_samples["origin_x"], 1002.5);
  EXPECT_EQ(by_samples["origin_y"], 2000.5);
  EXPECT_EQ(heightAt(a, "9,0"), 105.0);
}

TEST(TransformCommand, TurnsMirrorsAndResamples) {
  const TempFolder folder;
  const std::string scan = ramp(folder), out = folder.file("o.tif"), back = folder.file("b.tif");
  const auto turned = transformTo(scan, out, {"--turn", "90"});
  EXPECT_EQ(turned["width"], 30);
  // The lower right sample of the scan, height 39, goes to the upper right.
  EXPECT_EQ(heightAt(out, "0,29"), 39.0);
  EXPECT_EQ(transformTo(scan, back, {"--angle", "90"})["hash"], turned["hash"]);
  EXPECT_EQ(transformTo(scan, back, {"--angle", "-270"})["hash"], turned["hash"]);
  EXPECT_EQ(transformTo(out, back, {"--turn", "180", "--angle", "90"})["hash"],
            transformTo(scan, folder.file("d.tif"), {"--crop", "0,0,1000,1000"})["hash"]);
  EXPECT_EQ(transformTo(scan, out, {"--mirror", "x"})["no_data"], 1);
  EXPECT_EQ(heightAt(out, "29,39"), 0.0);
  const auto coarse = transformTo(scan, out, {"--to-spacing", "1000um"});
  EXPECT_EQ(coarse["method"], "area");
  EXPECT_EQ(coarse["width"], 20);
  EXPECT_EQ(heightAt(out, "14,0"), 50.5);  // of 0, 1, 100, 101
  const auto fine = transformTo(scan, out, {"--to-spacing", "0.25"});
  EXPECT_EQ(fine["method"], "cubic");
  EXPECT_EQ(fine["width"], 79);
  EXPECT_EQ(heightAt(out, "58,1"), 0.5);
  EXPECT_EQ(transformTo(scan, out, {"--to-spacing", "0.25,0.5", "--method", "linear"})["height"], 30);
  EXPECT_GT(transformTo(scan, out, {"--angle", "30"})["no_data"].get<int>(), 100);
}

// The words after a value are the scans, wherever they stand.
TEST(TransformCommand, OptionsMayComeBeforeTheScans) {
  const TempFolder folder;
  const std::string scan = folder.file("s.tif"), a = folder.file("a.tif"), b = folder.file("b.tif");
  ASSERT_EQ(fettle({"synth", scan, "--size", "90x70"}).status, 0);
  for (const std::vector<std::string>& options :
       std::vector<std::vector<std::string>>{{"--crop", "10,10,60,50"},
                                             {"--crop-samples", "3,4,40,50"},
                                             {"--crop=10,10,60,50", "--to-spacing", "2.5mm"},
                                             {"--to-spacing", "2,3"},
                                             {"--to-spacing=1.7"}}) {
    std::vector<std::string> before{"transform"}, after{"transform", scan, a};
    before.insert(before.end(), options.begin(), options.end());
    before.insert(before.end(), {scan, b});
    after.insert(after.end(), options.begin(), options.end());
    EXPECT_EQ(fettleJson(before)["hash"], fettleJson(after)["hash"]) << options[0];
    fs::remove(a);
    fs::remove(b);
  }
  expectRefused(fettle({"transform", "--crop", "1,2,3", scan, a}), "--crop takes X,Y,X,Y");
  expectRefused(fettle({"transform", "--crop", "1,2,3,4,5", scan, a}), "--crop takes X,Y,X,Y");
}

TEST(TransformCommand, MarksLinesAndFilledSamplesOfASessionGoAlong) {
  const TempFolder folder;
  const std::string scan = ramp(folder), session = folder.file("f.fettle"), out = folder.file("t.fettle");
  EXPECT_EQ(fettleJson({"fill", scan, session, "--unit", "mm"})["filled"], 1);
  for (const std::vector<std::string>& how :
       {std::vector<std::string>{"--turn", "270"}, {"--crop", "0,0,10,10"}, {"--mirror", "y"}}) {
    std::vector<std::string> all{"transform", session, out};
    all.insert(all.end(), how.begin(), how.end());
    EXPECT_EQ(fettleJson(all)["no_data"], 0);
    EXPECT_EQ(fettleJson({"info", out})["filled"], 1);
  }
}

TEST(TransformCommand, RefusesWhatHasNoEffectOrNoSample) {
  const TempFolder folder;
  const std::string scan = ramp(folder), out = folder.file("o.tif");
  expectRefused(fettle({"transform", scan, out, "--unit", "mm"}), "nothing is to be done");
  expectRefused(fettle({"transform", scan, out, "--turn", "90", "--method", "cubic"}), "--method");
  expectRefused(fettle({"transform", scan, out, "--unit", "mm", "--crop", "30,0,40,5"}), "--crop");
  expectRefused(fettle({"transform", scan, out, "--unit", "mm", "--crop", "nan,0,4,5"}), "--crop");
  expectRefused(fettle({"transform", scan, out, "--unit", "mm", "--crop-samples", "0,0,31,5"}),
                "--crop-samples");
  expectRefused(fettle({"transform", scan, out, "--unit", "mm", "--to-spacing", "0"}), "--to-spacing");
  expectRefused(fettle({"transform", scan, out, "--unit", "mm", "--to-spacing", "1,2,3"}), "--to-spacing");
  expectRefused(fettle({"transform", scan, out, "--unit", "mm", "--to-spacing", "1e-9"}),
                "samples cannot be held");
  expectRefused(fettle({"transform", scan, out, "--unit", "mm", "--angle", "nan"}), "--angle");
  expectRefused(fettle({"transform", scan, scan, "--unit", "mm", "--turn", "90"}), "s.asc");
  EXPECT_FALSE(std::filesystem::exists(out));
}

}  // namespace
}  // namespace fettle::tests
