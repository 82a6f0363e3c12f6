// The material ratios, volumes and features of fettle measure that are asked for.

#include <fstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tests/end_to_end/measured_scans.h"
#include "tests/end_to_end/program.h"
#include "tests/support/temp_folder.h"

namespace fettle::tests {
namespace {

TEST(Measure, MaterialRatiosAreThoseAskedFor) {
  const TempFolder folder;
  const std::string scan = folder.file("wave.asc");
  writeWave(scan);
  const auto report =
      fettleJson({"measure", scan, "--unit", "mm", "--at-height", "-1mm,0,500nm", "--at-ratio", "50"});
  EXPECT_EQ(report["smr"][0]["ratio"], 1.0);
  EXPECT_NEAR(report["smr"][1]["ratio"], 0.5, 0.05);
  EXPECT_NEAR(report["smr"][2]["height"], 5e-4, 1e-12);
  EXPECT_NEAR(report["smc"][0]["height"], 0.0, 2e-4);
  expectRefused(fettle({"measure", scan, "--unit", "mm", "--at-height", "1kg"}), "--at-height");
}

// Of a ramp along y, of which a mean takes nothing, from 1.99 to 0 mm: z = 2 (1 - q) by the share q, to half a row.
TEST(Measure, VolumesAndPruningAreThoseAskedFor) {
  const TempFolder folder;
  const std::string scan = folder.file("ramp.asc");
  {
    std::ofstream out(scan);
    out << "ncols 20\nnrows 200\nxllcenter 0\nyllcenter 0\ncellsize 0.1\n";
    for (int r = 199; r >= 0; --r)
      for (int c = 0; c < 20; ++c) out << 0.01 * r << (c == 19 ? '\n' : ' ');
  }
  const std::vector<std::string> words{
      "measure",    scan, "--unit",           "mm",       "--form",  "mean", "--ratios", "25,60",
      "--at-ratio", "5",  "--height-between", "2.5,97.5", "--prune", "8"};
  const auto report = fettleJson(words);
  constexpr double kNear = 0.011;
  EXPECT_NEAR(report["vmp"], 0.25 * 0.25, kNear);
  EXPECT_NEAR(report["vmc"], 0.6 * 0.6 - 0.25 * 0.25, kNear);
  EXPECT_NEAR(report["vvc"], 0.75 * 0.75 - 0.4 * 0.4, kNear);
  EXPECT_NEAR(report["vvv"], 0.4 * 0.4, kNear);
  EXPECT_NEAR(report["smc"][0]["material_volume"], 0.05 * 0.05, kNear);
  EXPECT_NEAR(report["smc"][0]["void_volume"], 0.95 * 0.95, kNear);
  EXPECT_NEAR(report["sdc"]["height"], 0.95 * 2.0, kNear);
  // A ramp has no noise: each is known beside itself.
  for (const auto& [of, value] :
       {std::pair(report["smc"][0], "material_volume"), {report["smc"][0], "void_volume"}}) {
    const std::string key = value;
    EXPECT_NEAR(of[key + "_without"], of[value].get<double>(), 1e-4) << key;
    EXPECT_LT(of[key + "_error"], 1e-3) << key;
    EXPECT_EQ(of[key + "_reason"], "") << key;
  }
  EXPECT_NEAR(report["sdc"]["without"], report["sdc"]["height"].get<double>(), 1e-3);
  EXPECT_LT(report["sdc"]["error"], 1e-2);
  EXPECT_EQ(report["prune"], 0.08);
  const Outcome text = fettle(words);
  for (const char* const part :
       {"(25 to 60 %)", "(60 %)", "Vm(p)", "Vv(p)", "Sdc ", "material ratios 2.5 and 97.5 %", "of 8 % of Sz"})
    EXPECT_NE(text.out.find(part), std::string::npos) << part << text.out;
  const auto usual = fettleJson({"measure", scan, "--unit", "mm", "--form", "mean"});
  EXPECT_FALSE(usual.contains("sdc"));
  EXPECT_NEAR(usual["vmp"], 0.1 * 0.1, kNear);
  for (const char* const wrong : {"60,25", "-1,50", "10,101", "10"})
    expectRefused(fettle({"measure", scan, "--unit", "mm", "--ratios", wrong}), "--ratios");
  expectRefused(fettle({"measure", scan, "--unit", "mm", "--only", "hybrid", "--height-between", "2,98"}),
                "--height-between");
}

}  // namespace
}  // namespace fettle::tests
