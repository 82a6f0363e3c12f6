#include <filesystem>

#include <gtest/gtest.h>

#include "tests/end_to_end/program.h"
#include "tests/support/temp_folder.h"

namespace fettle::tests {
namespace {

// The claim of Potter, Johnson and Cohen (2004), in figures: marking edges by hand and filtering around them
// keeps edges that the filter alone destroys, while flats become as smooth. The scan is the README's.
TEST(Demo, HegBeatsTheFilterAloneAtEdgesAndMatchesItOnFlats) {
  const TempFolder folder;
  const auto report = fettleJson({"demo", folder.file("demo")});
  ASSERT_EQ(report["table"].size(), 13U);
  const auto row = [&](const std::string& name) {
    for (const auto& r : report["table"])
      if (r["name"] == name) return r;
    return nlohmann::json();
  };
  // The strokes smooth the surface next to the edges and not a sample near them.
  EXPECT_EQ(row("touched")["rmse_edge"], row("noisy")["rmse_edge"]);
  const double noisy_flat = row("noisy")["rmse_flat"];
  for (const std::string filter : {"box", "gaussian", "median"}) {
    const auto alone = row(filter);
    const auto heg = row("heg-" + filter);
    EXPECT_GE(report["edge_gain"][filter], 2.0) << filter;
    EXPECT_LT(heg["edge_width"], alone["edge_width"]) << filter;
    EXPECT_LT(heg["rmse_flat"], 0.5 * noisy_flat) << filter;
    // Flats begin 12 samples from an edge and the marks end about there, tremor more or less: a few flat
    // samples are marked and keep their noise.
    EXPECT_LT(heg["rmse_flat"], 1.25 * alone["rmse_flat"].get<double>()) << filter;
  }
  // Lines of the same strokes, where the marks of the same strokes keep their noise.
  EXPECT_LT(row("tgv")["rmse_edge"], 0.6 * row("tv")["rmse_edge"].get<double>());
  EXPECT_LT(row("planes")["rmse"], row("tv")["rmse"].get<double>());
  EXPECT_LE(row("tgv-hand")["rmse"], 1.02 * row("tgv")["rmse"].get<double>());
  EXPECT_LE(row("tgv-true")["rmse_edge"], 1.02 * row("tgv")["rmse_edge"].get<double>());
  EXPECT_LT(row("tgv-hand")["rmse_edge"], 0.4 * row("heg-median")["rmse_edge"].get<double>());
  for (const auto& picture : report["pictures"])
    EXPECT_GT(std::filesystem::file_size(folder.path() / "demo" / picture.get<std::string>()), 10000U)
        << picture;
  for (const char* name : {"scan.tif", "truth.tif", "edges.png", "marks.png", "strokes.csv", "scene.toml",
                           "touched.tif", "heg-median.tif", "table.csv", "lines.csv"})
    EXPECT_TRUE(std::filesystem::exists(folder.path() / "demo" / name)) << name;
}

// What the folder holds is enough to do it again: the recorded session on the scan gives the touched field.
TEST(Demo, TheSessionItLeavesReplaysToTheSameField) {
  const TempFolder folder;
  const auto printed = fettle({"demo", folder.file("demo"), "--side", "256"});
  ASSERT_EQ(printed.status, 0);
  // Beside the gain of the paper's process stands that over the best filter without a hand.
  EXPECT_NE(printed.out.find("tgv: near edges the lines of the hand leave"), std::string::npos)
      << printed.out;
  const std::string demo = folder.file("demo/");
  const auto replayed =
      fettleJson({"replay", demo + "scan.tif", demo + "strokes.csv", folder.file("again.tif"), "--scene",
                  demo + "scene.toml", "--marks-out", folder.file("again.png")});
  EXPECT_GT(replayed["samples_changed"], 0);
  EXPECT_EQ(fettleJson({"compare", demo + "touched.tif", folder.file("again.tif")})["max_abs"], 0.0);
  (void)fettleJson({"filter", demo + "scan.tif", folder.file("clean.tif"), "--filter", "tgv", "--lines",
                    demo + "lines.csv"});
  EXPECT_EQ(fettleJson({"compare", demo + "tgv-hand.tif", folder.file("clean.tif")})["max_abs"], 0.0);
}

}  // namespace
}  // namespace fettle::tests
