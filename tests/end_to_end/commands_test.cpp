// Each command of the table once, as a user would call it, on a small simulated scan.

#include <cmath>

#include <filesystem>
#include <fstream>
#include <limits>
#include <sstream>

#include <gtest/gtest.h>

#include "tests/end_to_end/program.h"
#include "tests/support/temp_folder.h"

namespace fettle::tests {
namespace {

class Commands : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = std::make_unique<TempFolder>();
    ASSERT_EQ(fettle({"synth", scan(), "--size", "256x192", "--seed", "5", "--outliers", "0.05", "--dropouts",
                      "1", "--truth", truth(), "--edges", edges()})
                  .status,
              0);
  }
  static void TearDownTestSuite() { folder_.reset(); }

  static std::string scan() { return folder_->file("scan.tif"); }
  static std::string truth() { return folder_->file("truth.tif"); }
  static std::string edges() { return folder_->file("edges.png"); }
  static std::string file(const std::string& name) { return folder_->file(name); }

  static std::unique_ptr<TempFolder> folder_;
};
std::unique_ptr<TempFolder> Commands::folder_;

TEST_F(Commands, InfoReportsSizeSpacingHeightsAndHoles) {
  const auto info = fettleJson({"info", scan()});
  EXPECT_EQ(info["width"], 256);
  EXPECT_EQ(info["height"], 192);
  for (const char* key : {"spacing_x", "spacing_y", "origin_x", "origin_y", "min", "max", "mean"})
    EXPECT_TRUE(info[key].is_number()) << key;
  EXPECT_GT(info["no_data"], 0);
  EXPECT_EQ(info["unit"], "mm");
  EXPECT_EQ(info["format"], "GTiff");
}

TEST_F(Commands, InfoReportsNoiseSteepestCellAndHistogram) {
  // The simulated noise is known from the truth. Counts of 0.01 mm give the finest detail to 0.0025 mm, which what
  // lines have in common is not in.
  ASSERT_EQ(fettle({"synth", file("noisy.tif"), "--size", "256x192", "--seed", "5", "--truth",
                    file("smooth.tif"), "--part", "plate"})
                .status,
            0);
  const auto info = fettleJson({"info", file("noisy.tif"), "--bins", "7"});
  const double sigma = fettleJson({"compare", file("smooth.tif"), file("noisy.tif")})["rms"];
  EXPECT_NEAR(info["noise"], sigma, 0.05 * sigma);
  EXPECT_NEAR(info["noise_finest"], sigma, 0.0025);
  EXPECT_NEAR(info["noise_rows"], 0.005, 0.0015);
  EXPECT_EQ(fettleJson({"info", file("smooth.tif")})["noise"], 0.0);
  EXPECT_EQ(info["histogram"]["low"], info["min"]);
  EXPECT_EQ(info["histogram"]["high"], info["max"]);
  ASSERT_EQ(info["histogram"]["counts"].size(), 7U);
  std::int64_t counted = 0;
  for (const auto& count : info["histogram"]["counts"]) counted += count.get<std::int64_t>();
  EXPECT_EQ(counted, 256 * 192);
  EXPECT_NEAR(info["steepest"]["degrees"],
              57.29577951308232 * std::atan(info["steepest"]["slope"].get<double>()), 1e-9);

  // A grid whose steepest cell is known: rows as in the file, spacing 2, so that it rises by 8 / 2.
  std::ofstream(file("steep.asc")) << "ncols 3\nnrows 3\nxllcorner 0\nyllcorner 0\ncellsize 2\n"
                                   << "0 0 0\n0 0 8\n0 0 8\n";
  const auto steep = fettleJson({"info", file("steep.asc"), "--unit", "mm"})["steepest"];
  EXPECT_NEAR(steep["slope"], std::hypot(4.0, 4.0), 1e-12);
  EXPECT_EQ(steep["row"], 0);
  EXPECT_EQ(steep["column"], 1);
  EXPECT_EQ(steep["x"], 4.0);
  EXPECT_EQ(steep["y"], 4.0);
}

TEST_F(Commands, InfoDrawsBarsForPeopleAndAThumbnail) {
  std::ofstream(file("bars.asc")) << "ncols 4\nnrows 1\ncellsize 1\nxllcorner 0\nyllcorner 0\n0 0 0 2\n";
  const Outcome printed = fettle({"info", file("bars.asc"), "--bins", "2", "--picture", file("thumb.png")});
  ASSERT_EQ(printed.status, 0) << printed.err;
  EXPECT_NE(printed.out.find(std::string(50, '#') + "  75.000 %"), std::string::npos) << printed.out;
  EXPECT_NE(printed.out.find(std::string(17, '#') + std::string(35, ' ') + "25.000 %"), std::string::npos)
      << printed.out;
  EXPECT_GT(std::filesystem::file_size(file("thumb.png")), 500U);
  expectRefused(fettle({"info", file("bars.asc"), "--picture", file("bars.asc")}), ".png");
}

TEST_F(Commands, SynthIsTheSameForTheSameSeedAndDifferentForAnother) {
  const auto again = [](const std::string& seed, const std::string& name) {
    return fettleJson({"synth", file(name), "--size", "256x192", "--seed", seed, "--outliers", "0.05",
                       "--dropouts", "1"})["hash"];
  };
  EXPECT_EQ(again("5", "a.tif"), again("5", "b.tif"));
  EXPECT_NE(again("5", "a.tif"), again("6", "c.tif"));
}

TEST_F(Commands, FilterKeepsMarksAndStaysWithinTheMaximumChange) {
  const auto report = fettleJson({"filter", scan(), file("f.tif"), "--filter", "gaussian", "--window", "5",
                                  "--keep", edges(), "--max-change", "10um", "--passes", "2"});
  EXPECT_EQ(report["filter"], "gaussian");
  EXPECT_GT(report["changed"], 1000);
  EXPECT_LE(report["max_change"], 0.01);
  for (const char* key : {"rms_change", "seconds", "samples_per_second"}) EXPECT_GT(report[key], 0) << key;
  const auto deviation = fettleJson({"compare", scan(), file("f.tif")});
  EXPECT_EQ(deviation["max_abs"], report["max_change"]);
  EXPECT_EQ(deviation["only_a"], 0);
  EXPECT_EQ(deviation["only_b"], 0);
}

TEST_F(Commands, FilterGivesTheSameBitsForAnyNumberOfThreads) {
  for (const std::string filter : {"box", "gaussian", "median", "bilateral", "tv"}) {
    const auto hash = [&](const std::string& threads) {
      return fettleJson({"filter", scan(), file("t.tif"), "--filter", filter, "--window", "9", "--threads",
                         threads})["hash"];
    };
    EXPECT_EQ(hash("1"), hash("3")) << filter;
  }
}

TEST_F(Commands, FilterByCutOffWritesWavinessAndRoughness) {
  const auto report = fettleJson({"filter", scan(), file("w.tif"), "--filter", "areal-gaussian", "--cutoff",
                                  "2500um", "--residual", file("r.tif")});
  EXPECT_EQ(report["cutoff"], 2.5);
  EXPECT_EQ(report["residual"], file("r.tif"));
  // The residual is what compare states between the two.
  EXPECT_EQ(fettle({"compare", file("w.tif"), scan(), "--deviation", file("d.tif")}).status, 0);
  EXPECT_EQ(fettleJson({"info", file("r.tif")})["hash"], fettleJson({"info", file("d.tif")})["hash"]);
  EXPECT_EQ(fettleJson({"filter", scan(), file("w.tif"), "--filter", "areal-gaussian", "--cutoff", "2.5",
                        "--threads", "1"})["hash"],
            report["hash"]);
  const auto refused = [&](const std::vector<std::string>& more, const std::string& where) {
    std::vector<std::string> arguments{"filter", scan(), file("w.tif"), "--filter"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    expectRefused(fettle(arguments), where);
  };
  refused({"areal-gaussian"}, "cutoff");
  refused({"robust-gaussian", "--cutoff", "1nm"}, "two samples");
  refused({"box", "--cutoff", "1"}, "--cutoff");
  refused({"box", "--residual", scan()}, "input");
  refused({"box", "--residual", "-"}, "--residual");
}

TEST_F(Commands, FilterRollsABallADiskOrASquare) {
  const auto filter = [&](const std::vector<std::string>& more) {
    std::vector<std::string> arguments{"filter", scan(), file("o.tif"), "--filter"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return arguments;
  };
  const auto ball = fettleJson(filter({"opening", "--radius", "2500um", "--residual", file("peaks.tif")}));
  EXPECT_EQ(ball["radius"], 2.5);
  EXPECT_EQ(ball["element"], "ball");
  // An opening raises no sample: what it takes away is not negative, by as much as it reports.
  const auto peaks = fettleJson({"info", file("peaks.tif")});
  EXPECT_GE(peaks["min"].get<double>(), 0.0);
  EXPECT_NEAR(peaks["max"].get<double>(), ball["max_change"].get<double>(),
              1e-6 * peaks["max"].get<double>());
  EXPECT_EQ(fettleJson(filter({"opening", "--radius", "2.5", "--threads", "1"}))["hash"], ball["hash"]);
  // A body that holds another one takes more away.
  const double disk = fettleJson(filter({"opening", "--radius", "2.5", "--element", "disk"}))["rms_change"],
               square =
                   fettleJson(filter({"opening", "--radius", "2.5", "--element", "square"}))["rms_change"];
  EXPECT_LT(ball["rms_change"].get<double>(), disk);
  EXPECT_LT(disk, square);
  EXPECT_TRUE(fettleJson(filter({"closing", "--radius", "2.5", "--estimate"})).contains("seconds"));
  expectRefused(fettle(filter({"opening"})), "radius");
  expectRefused(fettle(filter({"opening", "--cutoff", "2"})), "--cutoff");
  expectRefused(fettle(filter({"opening", "--radius", "1nm"})), "one spacing");
  expectRefused(fettle(filter({"spline", "--radius", "2"})), "--radius");
  expectRefused(fettle(filter({"box", "--element", "disk"})), "element");
  expectRefused(fettle(filter({"opening", "--radius", "2", "--element", "cube"})), "cube");
}

TEST_F(Commands, FilterTakesARangeSigmaWithAUnitOrFromTheNoise) {
  const auto range = [&](const std::string& given) {
    std::vector<std::string> arguments{"filter", scan(), file("b.tif"), "--filter", "bilateral"};
    if (!given.empty()) arguments.insert(arguments.end(), {"--range-sigma", given});
    return fettleJson(arguments)["range_sigma"].get<double>();
  };
  EXPECT_EQ(range("80um"), 0.08);
  EXPECT_EQ(range("0.08"), 0.08);
  EXPECT_EQ(range(""), 4.0 * fettleJson({"info", scan()})["noise_finest"].get<double>());
  expectRefused(fettle({"filter", scan(), file("b.tif"), "--filter", "box", "--range-sigma", "1"}),
                "range sigma");
  expectRefused(fettle({"filter", scan(), file("b.tif"), "--filter", "tv", "--range-sigma", "0"}),
                "range sigma");
}

TEST_F(Commands, SuggestedFilterTypedAsPrintedLeavesWhatWasTolerated) {
  ASSERT_EQ(fettle({"synth", file("s.tif"), "--size", "512x512", "--truth", file("st.tif"), "--edges",
                    file("se.png")})
                .status,
            0);
  const auto said = fettleJson(
      {"filter", file("s.tif"), file("clean.tif"), "--suggest", "--tolerance", "15um", "--budget", "600"});
  EXPECT_EQ(said["met"], true);
  EXPECT_GT(said["candidates"].size(), 20U);
  EXPECT_FALSE(std::filesystem::exists(file("clean.tif"))) << "only named";
  ASSERT_EQ(said["commands"].size(), 1U);
  std::istringstream words(said["commands"][0].get<std::string>());
  std::vector<std::string> arguments;
  for (std::string word; words >> word;) arguments.push_back(word);
  ASSERT_EQ(arguments.front(), "fettle");
  arguments.erase(arguments.begin());
  const Outcome done = fettle(arguments);
  ASSERT_EQ(done.status, 0) << done.err;
  const auto left = fettleJson(
      {"compare", file("s.tif"), file("clean.tif"), "--truth", file("st.tif"), "--edges", file("se.png")});
  EXPECT_LT(left["rmse_flat"], 1.2 * 0.015);
  EXPECT_LT(left["rmse_edge"], 1.2 * 0.015);
  // For people, the same in words; and what cannot be had is said.
  const Outcome printed = fettle({"filter", file("s.tif"), "--suggest", "--tolerance", "1um"});
  EXPECT_EQ(printed.status, 0) << printed.err;
  EXPECT_NE(printed.out.find(" helps most: it leaves "), std::string::npos) << printed.out;
  EXPECT_NE(printed.out.find(" times 0.001 mm."), std::string::npos) << printed.out;
  expectRefused(fettle({"filter", file("s.tif"), "--suggest"}), "--tolerance");
  expectRefused(fettle({"filter", file("s.tif"), "--suggest", "--tolerance", "15um", "--compute", "gpu"}),
                "--compute");
  expectRefused(fettle({"filter", file("s.tif"), file("o.tif"), "--filter", "box", "--tolerance", "1"}),
                "--suggest");
}

TEST_F(Commands, PlacesWhereALineByHandIsWorthMostAreNamedInTheScansOwnCoordinates) {
  ASSERT_EQ(fettle({"synth", file("s.tif"), "--part", "steps", "--noise", "3", "--size", "320x320"}).status,
            0);
  const auto said = fettleJson({"filter", file("s.tif"), "--suggest", "--places", "3"});
  EXPECT_FALSE(said.contains("commands")) << "no tolerance, no filter";
  ASSERT_EQ(said["places"].size(), 3U);
  const auto grid = fettleJson({"info", file("s.tif")});
  double left = said["rmse_without"], rate = std::numeric_limits<double>::infinity();
  for (const auto& place : said["places"]) {
    EXPECT_GE(place["x"], grid["origin_x"]);
    EXPECT_GE(place["y"], grid["origin_y"]);
    EXPECT_LE(place["x"], 90.0);
    EXPECT_LT(place["rmse_after"], left);
    left = place["rmse_after"];
    EXPECT_LE(place["gain"].get<double>() / place["seconds"].get<double>(), rate);
    rate = place["gain"].get<double>() / place["seconds"].get<double>();
  }
  const Outcome printed = fettle({"filter", file("s.tif"), "--suggest", "--places", "1"});
  EXPECT_NE(printed.out.find("x, mm"), std::string::npos) << printed.out;
  expectRefused(fettle({"filter", file("s.tif"), file("o.tif"), "--filter", "tgv", "--places", "3"}),
                "--suggest");
  EXPECT_EQ(fettle({"filter", file("s.tif"), "--suggest", "--places", "0"}).status, 2);
  expectRefused(fettle({"filter", file("s.tif"), "--suggest", "--places", "1", "--budget", "5"}), "--budget");
  expectRefused(fettle({"filter", file("s.tif"), file("o.tif"), "--suggest", "--places", "1"}), "OUT");
}

TEST_F(Commands, CompareAgainstTheTruthJudgesFlatsAndEdges) {
  ASSERT_EQ(fettle({"filter", scan(), file("box.tif"), "--filter", "box", "--window", "5"}).status, 0);
  const auto before = fettleJson({"compare", scan(), scan(), "--truth", truth(), "--edges", edges()});
  const auto after = fettleJson({"compare", scan(), file("box.tif"), "--truth", truth(), "--edges", edges()});
  EXPECT_EQ(before["rms"], 0.0);
  EXPECT_LT(after["rmse_flat"], before["rmse_flat"]);
  EXPECT_GT(after["edge_width"], before["edge_width"]);
  for (const char* key : {"mean", "max_abs", "p99", "sq", "sa", "rmse", "rmse_edge"})
    EXPECT_TRUE(after[key].is_number()) << key;
}

TEST_F(Commands, CompareWritesTheDeviationAsAScan) {
  ASSERT_EQ(fettle({"filter", scan(), file("dev_b.tif"), "--filter", "median", "--window", "5"}).status, 0);
  for (const char* name : {"dev.tif", "dev.asc", "dev.x3p", "dev.exr", "dev.xyz", "dev.ply", "dev.fettle"}) {
    const auto report = fettleJson({"compare", scan(), file("dev_b.tif"), "--deviation", file(name)});
    const auto written = fettleJson({"info", file(name)});
    EXPECT_NEAR(std::max(std::abs(written["min"].get<double>()), std::abs(written["max"].get<double>())),
                report["max_abs"].get<double>(), 1e-7 * report["max_abs"].get<double>())
        << name;
    EXPECT_NEAR(written["mean"], report["mean"], 1e-9) << name;
  }
  expectRefused(fettle({"compare", scan(), truth(), "--deviation", truth()}), "replace an input");
  expectRefused(fettle({"compare", scan(), truth(), "--deviation", file("d.docx")}), "docx");
}

TEST_F(Commands, ReplaySmoothsMarksAndReportsForces) {
  // Down onto the middle row, along 40 columns a tenth of a millimetre deep with the smooth tool, then a
  // little way with the mark tool. Files count rows from the top: row 95 of 192 is row 96 of the field.
  std::vector<std::string> ask{"info", truth()};
  for (int column = 100; column <= 140; ++column) {
    ask.emplace_back("--at");
    ask.push_back("95," + std::to_string(column));
  }
  const auto info = fettleJson(ask);
  std::ofstream strokes(file("strokes.csv"));
  strokes << "t,x,y,z,tool\n";
  for (int i = 0; i < 400; ++i) {
    const auto& under = info["at"][static_cast<std::size_t>(i / 10)];
    const double z = i < 5 ? info["max"].get<double>() + 1.0 : under["height"].get<double>() - 0.1;
    strokes << i * 0.001 << ',' << under["column"].get<int>() * info["spacing_x_mm"].get<double>() << ','
            << 96 * info["spacing_y_mm"].get<double>() << ',' << z << ',' << (i < 300 ? "smooth" : "mark")
            << '\n';
  }
  strokes.close();
  const auto run = [&](const std::string& out) {
    return fettleJson({"replay", scan(), file("strokes.csv"), file(out), "--marks-out", file("m.png"),
                       "--forces", file("forces.csv"), "--certify"});
  };
  const auto report = run("r.tif");
  EXPECT_EQ(report["ticks"], 400);
  EXPECT_GT(report["contact_ticks"], 300);
  EXPECT_GT(report["max_force_n"], 0.0);
  EXPECT_GT(report["samples_changed"], 10);
  EXPECT_GT(report["marked"], 2);
  EXPECT_GT(report["ticks_per_second"], 0.0);
  EXPECT_EQ(run("r2.tif")["hash"], report["hash"]);

  std::ifstream forces(file("forces.csv"));
  std::string line;
  std::getline(forces, line);
  EXPECT_EQ(line, "t,proxy_x,proxy_y,proxy_z,fx,fy,fz,contact");
  int rows = 0;
  while (std::getline(forces, line)) ++rows;
  EXPECT_EQ(rows, 400);

  // The marks written are the marks a filter reads: filtered around them, they keep their bits.
  ASSERT_EQ(
      fettle({"filter", file("r.tif"), file("rf.tif"), "--filter", "box", "--keep", file("m.png")}).status,
      0);
  const auto only =
      fettleJson({"filter", file("r.tif"), file("ro.tif"), "--filter", "box", "--only", file("m.png")});
  EXPECT_LE(only["changed"], report["marked"]);
}

TEST_F(Commands, RenderDrawsAPictureOfTheSizeAsked) {
  const auto report = fettleJson(
      {"render", scan(), file("p.png"), "--size", "320x200", "--marks", edges(), "--compare", truth()});
  EXPECT_EQ(report["width"], 320);
  EXPECT_EQ(report["height"], 200);
  EXPECT_GT(report["tiles_uploaded"], 0);
  EXPECT_GT(report["frame_ms"], 0.0);
  EXPECT_FALSE(report["device"].get<std::string>().empty());
  EXPECT_GT(std::filesystem::file_size(file("p.png")), 2000U);
  EXPECT_EQ(
      fettle({"render", scan(), file("d.png"), "--size", "320x200", "--deviation", truth(), "--validate"})
          .err,
      "");
}

TEST_F(Commands, ConvertThereAndBackKeepsEveryHeight) {
  for (const char* name : {"c.asc", "c.xyz", "c.ply"}) {
    const auto report = fettleJson({"convert", truth(), file(name)});
    EXPECT_FALSE(report["format"].get<std::string>().empty());
    ASSERT_EQ(fettle({"convert", file(name), file("back.tif")}).status, 0) << name;
    const auto deviation = fettleJson({"compare", truth(), file("back.tif")});
    EXPECT_EQ(deviation["max_abs"], 0.0) << name;
    EXPECT_EQ(deviation["only_b"], 0) << name;
    EXPECT_EQ(deviation["only_a"], 0) << name;
  }
}

TEST(Program, EveryCommandHasHelp) {
  for (const char* command : {"info", "synth", "filter", "replay", "render", "compare", "convert", "demo"}) {
    const Outcome outcome = fettle({command, "--help"});
    EXPECT_EQ(outcome.status, 0);
    EXPECT_NE(outcome.out.find("--json"), std::string::npos) << command;
  }
  EXPECT_EQ(fettle({"--version"}).status, 0);
}

TEST(Program, ProgressIsSilentWhereStderrIsNoTerminal) {
  const TempFolder folder;
  EXPECT_EQ(fettle({"synth", folder.file("s.tif"), "--size", "1024x1024"}).err, "");
}

}  // namespace
}  // namespace fettle::tests
