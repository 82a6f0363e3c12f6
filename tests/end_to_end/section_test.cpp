// fettle section, as a metrologist types it.

#include <cmath>
#include <fstream>
#include <iterator>
#include <random>
#include <string>
#include <tuple>

#include <gtest/gtest.h>

#include "tests/end_to_end/program.h"
#include "tests/support/temp_folder.h"

namespace fettle::tests {
namespace {

// A plate of 80 x 40 samples, 0.1 mm apart, with a groove of 0.05 mm from 3 to 5 mm; one hole. ESRI ASCII.
void writeGroove(const std::string& path, double up = 0.0) {
  std::ofstream out(path);
  out << "ncols 80\nnrows 40\nxllcenter 0\nyllcenter 0\ncellsize 0.1\nNODATA_value -9999\n";
  for (int r = 39; r >= 0; --r) {
    for (int c = 0; c < 80; ++c)
      out << (r == 10 && c == 10 ? -9999.0
                                 : up + (c >= 30 && c < 50 ? 0.95 : 1.0) + 1e-4 * ((c * 7 + r * 5) % 3))
          << ' ';
    out << '\n';
  }
}

TEST(SectionCommand, MeasuresAGrooveAndAStep) {
  const TempFolder folder;
  const std::string scan = folder.file("groove.asc");
  writeGroove(scan);
  const auto report = fettleJson({"section", scan, "--unit", "mm", "--start", "0,2", "--end", "7.9,2",
                                  "--width", "1", "--groove", "auto", "--step", "2.95", "--cursors", "1,4"});
  const auto& section = report["sections"][0];
  EXPECT_EQ(section["places"], 80);
  EXPECT_EQ(section["lanes"], 11);
  EXPECT_NEAR(section["groove"]["edges"][0], 2.95, 1e-9);
  EXPECT_NEAR(section["groove"]["edges"][1], 4.95, 1e-9);
  EXPECT_NEAR(section["groove"]["depth_mm"], 0.05, 1e-4);
  EXPECT_GT(section["groove"]["depth_error_mm"].get<double>(), 0.0);
  // Of two edges, each anywhere between two places of 0.1 mm.
  EXPECT_NEAR(section["groove"]["edges_error_mm"], 0.1 / std::sqrt(12.0), 1e-6);
  EXPECT_NEAR(section["groove"]["width_error_mm"], 0.1 / std::sqrt(6.0), 1e-6);
  EXPECT_TRUE(section["step"]["edge_error_mm"].is_null()) << "it was given";
  EXPECT_NEAR(section["cursors"]["dz_mm"], -0.05, 2e-4);
  const Outcome text =
      fettle({"section", scan, "--unit", "mm", "--start", "0,2", "--end", "7.9,2", "--groove", "auto"});
  EXPECT_NE(text.out.find("depth 50 +- "), std::string::npos) << text.out;
  EXPECT_NE(text.out.find("width 2 +- 0.041 mm from 2.95 mm"), std::string::npos) << text.out;
  const Outcome step =
      fettle({"section", scan, "--unit", "mm", "--start", "0,2", "--end", "7.9,2", "--step", "2.95"});
  EXPECT_NE(step.out.find("by 0 to 1.96667 mm and 3.93333 to 5.9 mm"), std::string::npos) << step.out;
}

// The step sought on a groove is one of its walls, and no line of it goes on behind the other one.
TEST(SectionCommand, AStepSoughtOnAGrooveIsOneOfItsWalls) {
  const TempFolder folder;
  const std::string scan = folder.file("groove.asc");
  writeGroove(scan);
  for (const auto& [from, to, edge, height] :
       {std::tuple{"0,2", "7.9,2", 2.95, -0.05}, {"2,2", "7.9,2", 2.95, 0.05}, {"0,2", "6,2", 2.95, -0.05}}) {
    const auto report = fettleJson(
        {"section", scan, "--unit", "mm", "--start", from, "--end", to, "--width", "1", "--step", "auto"});
    const auto& step = report["sections"][0]["step"];
    EXPECT_NEAR(step["step_mm"], height, 1e-4) << from << ' ' << to;
    EXPECT_NEAR(step["edge_mm"], edge, 1e-9) << from << ' ' << to;
    EXPECT_LT(step["rms_mm"].get<double>(), 1e-4);
  }
}

TEST(SectionCommand, WritesTableDrawingAndPictureOfBothScans) {
  const TempFolder folder;
  const std::string scan = folder.file("groove.asc"), other = folder.file("other.asc");
  writeGroove(scan);
  writeGroove(other, 0.25);
  const auto report = fettleJson({"section", scan, "--compare", other, "--unit", "mm", "--line", "0,1:7.9,1",
                                  "--line", "1,1:1,3:4,3", "--csv", folder.file("p.csv"), "--dxf",
                                  folder.file("p.dxf"), "--plot", folder.file("p.png")});
  ASSERT_EQ(report["sections"].size(), 2U);
  EXPECT_NEAR(report["sections"][0]["deviation"]["mean_mm"], 0.25, 1e-6);
  EXPECT_EQ(report["sections"][0]["without_height"], 1);
  const std::string csv = bytesOf(folder.file("p.csv"));
  EXPECT_TRUE(csv.starts_with(
      "section,along_mm,x_mm,y_mm,height_mm,share,other_mm,interpolation,layer,other_layer\n0,0,0,1,1"));
  EXPECT_NE(csv.find("\n0,1,1,1,,0,,bilinear,,\n"), std::string::npos);
  // A hole divides the first polyline.
  const std::string dxf = bytesOf(folder.file("p.dxf"));
  std::size_t polylines = 0;
  for (std::size_t at = dxf.find("POLYLINE\n8\nSECTION_0\n"); at != std::string::npos;
       at = dxf.find("POLYLINE\n8\nSECTION_0\n", at + 1))
    ++polylines;
  EXPECT_EQ(polylines, 2U);
  EXPECT_TRUE(bytesOf(folder.file("p.png")).starts_with("\x89PNG"));
}

TEST(SectionCommand, FollowsTheLinesOfAFile) {
  const TempFolder folder;
  const std::string scan = folder.file("groove.asc");
  writeGroove(scan);
  std::ofstream(folder.file("l.geojson"))
      << R"({"type":"FeatureCollection","features":[{"type":"Feature","properties":{},"geometry":)"
      << R"({"type":"LineString","coordinates":[[0.5,2],[7.5,2]]}}]})";
  const auto report = fettleJson({"section", scan, "--unit", "mm", "--lines", folder.file("l.geojson"),
                                  "--step", "2.45", "--within", "1,4"});
  EXPECT_NEAR(report["sections"][0]["length_mm"], 7.0, 1e-5);
  EXPECT_NEAR(report["sections"][0]["step"]["step_mm"], -0.05, 2e-4);
}

TEST(SectionCommand, RefusesWhatItCannotMeasure) {
  const TempFolder folder;
  const std::string scan = folder.file("groove.asc");
  writeGroove(scan);
  const auto refused = [&](std::vector<std::string> words, const std::string& word) {
    words.insert(words.begin(), {"section", scan, "--unit", "mm"});
    expectRefused(fettle(words), word);
  };
  refused({}, "--start");
  refused({"--start", "1,1"}, "--end");
  refused({"--line", "1,1"}, "--line");
  refused({"--line", "1,1:2"}, "--line");
  refused({"--line", "50,50:60,60"}, "no sample");
  refused({"--line", "1,2:7,2", "--step", "x"}, "--step");
  refused({"--line", "1,2:7,2", "--groove", "3"}, "--groove");
  refused({"--line", "1,2:7,2", "--arc", "0,1"}, "curvature");
  refused({"--line", "1,2:7,2", "--cutoff", "5"}, "cut-off");
  refused({"--line", "1,2:7,2", "--cursors", "1,9"}, "cursor");
  refused({"--line", "1,2:7,2", "--plot", folder.file("p.bmp")}, ".svg");
  refused({"--probe", "1"}, "--probe");
  refused({"--probe", "50,2"}, "the scan is from 0,0 to 7.9,3.9 mm");
  // What would have no effect, and what is given twice.
  refused({"--line", "1,2:7,2", "--within", "1,4"}, "--groove");
  refused({"--line", "1,2:7,2", "--probe-radius", "1"}, "add --probe");
  refused({"--probe", "1,1", "--step", "auto"}, "a line");
  refused({"--probe", "1,1", "--plot", folder.file("p.png")}, "a line");
  refused({"--line", "1,2:7,2", "--cursors", "1,2,3"}, "--cursors takes A,B");
  refused({"--line", "1,2:7,2", "--cursors", "1,2", "--cursors", "3,4"}, "--cursors");
  refused({"--line", "1,2:7,2", "--spacing", "1", "--spacing", "2"}, "more than once");
}

// Two sines on a slope: P has both, W the long one, R the short one; each under its own letter.
TEST(SectionCommand, ProfilesAreThoseAskedFor) {
  const TempFolder folder;
  const std::string scan = folder.file("two.asc");
  {
    std::ofstream out(scan);
    out.precision(9);
    out << "ncols 410\nnrows 6\nxllcenter 5e6\nyllcenter 5e6\ncellsize 0.05\n";
    for (int r = 0; r < 6; ++r) {
      for (int c = 0; c < 410; ++c)
        out << 0.01 * c + 0.02 * std::sin(2.0 * M_PI * c / 10.0) + 0.1 * std::cos(2.0 * M_PI * c / 100.0)
            << ' ';
      out << '\n';
    }
  }
  const std::vector<std::string> line = {"section", scan,     "--unit", "mm",
                                         "--start", "0,0.12", "--end",  "20.45,0.12"};
  const auto with = [&](std::vector<std::string> more) {
    more.insert(more.begin(), line.begin(), line.end());
    return fettleJson(more)["sections"][0];
  };
  const auto plain = with({"--cutoff", "1.5"});
  EXPECT_FALSE(plain.contains("primary") || plain.contains("waviness"));
  const auto all = with({"--cutoff", "1.5", "--profile", "roughness,primary,waviness"});
  EXPECT_EQ(all["roughness"], plain["roughness"]);
  const double left = 0.1 * std::exp(-std::log(2.0) * std::pow(1.5 / 5.0, 2));
  EXPECT_NEAR(all["waviness"]["wq_mm"], left / std::sqrt(2.0), 0.05 * left);
  EXPECT_NEAR(all["waviness"]["wsm_mm"], 5.0, 0.1);
  EXPECT_NEAR(all["primary"]["pq_mm"], std::hypot(0.02, 0.1) / std::sqrt(2.0), 0.005);
  EXPECT_NEAR(all["primary"]["pt_mm"], 0.24, 0.01);
  EXPECT_FALSE(all["primary"].contains("cutoff_mm") || all["primary"].contains("ra_mm"));
  const auto primary = with({"--profile", "primary"});
  EXPECT_EQ(primary["primary"], all["primary"]);
  EXPECT_FALSE(primary.contains("roughness"));
  std::vector<std::string> text = line;
  text.insert(text.end(), {"--cutoff", "1.5", "--profile", "primary", "--profile", "waviness"});
  const Outcome shown = fettle(text);
  for (const char* const part :
       {"waviness", "cut-off 1.5 mm, from 0.75 to ", "Wq ", "WSm ", "PSm ", "without a cut-off"})
    EXPECT_NE(shown.out.find(part), std::string::npos) << part << shown.out;
  // Each figure has one without noise or a reason.
  for (const char* const name : {"roughness", "primary", "waviness"})
    for (const auto& [key, value] : all[name].items())
      if (const std::size_t at = key.find("_without"); at != std::string::npos && value.is_null()) {
        EXPECT_TRUE(all[name].contains(key.substr(0, at) + "_reason")) << key;
      }
  EXPECT_EQ(all["waviness"]["wk_reason"], "the scan has no noise that was found");
  EXPECT_NE(shown.out.find("without noise not stated: the scan has no noise"), std::string::npos)
      << shown.out;
  const auto refused = [&](std::vector<std::string> more, const char* why) {
    more.insert(more.begin(), line.begin(), line.end());
    expectRefused(fettle(more), why);
  };
  refused({"--profile", "waviness"}, "add --cutoff");
  refused({"--profile", "primary", "--cutoff", "1.5"}, "--cutoff");
  // Letters are the words.
  EXPECT_EQ(with({"--cutoff", "1.5", "--profile", "R,P,W"}), all);
  // Of a wave of 0.02 mm, whose mean line the filter takes out: acos(c / A) / pi, and A (cos(pi p) - cos(pi q)).
  const auto asked = with(
      {"--cutoff", "1.5", "--profile", "R,P", "--at-height", "0,-0.01,10um", "--height-between", "10,60"});
  ASSERT_EQ(asked["roughness"]["rmr"].size(), 3U);
  EXPECT_NEAR(asked["roughness"]["rmr"][0]["ratio"], 0.5, 0.03);
  EXPECT_NEAR(asked["roughness"]["rmr"][1]["ratio"], 2.0 / 3.0, 0.03);
  EXPECT_NEAR(asked["roughness"]["rmr"][2]["ratio"], 1.0 / 3.0, 0.03);
  EXPECT_EQ(asked["roughness"]["rmr"][2]["height_mm"], 0.01);
  EXPECT_NEAR(asked["roughness"]["rdc"][0]["height_mm"], 0.02 * (std::cos(0.1 * M_PI) - std::cos(0.6 * M_PI)),
              0.002);
  EXPECT_EQ(asked["primary"]["pmr"].size(), 3U);
  EXPECT_EQ(asked["primary"]["pdc"].size(), 1U);
  std::vector<std::string> asking = line;
  asking.insert(asking.end(), {"--profile", "P", "--at-height", "10um", "--height-between", "10,60"});
  const Outcome stated = fettle(asking);
  for (const char* const part :
       {"Pmr ", "material ratio at 10 um about the mean line", "Pdc ", "ratios 10 and 60 %"})
    EXPECT_NE(stated.out.find(part), std::string::npos) << part << stated.out;
  refused({"--at-height", "0"}, "add --cutoff or --profile");
  refused({"--height-between", "10,60"}, "add --cutoff or --profile");
  refused({"--cutoff", "1.5", "--at-height", "1kg"}, "--at-height");
  refused({"--cutoff", "1.5", "--height-between", "60,10"}, "--height-between");
  refused({"--cutoff", "1.5", "--height-between", "10,101"}, "--height-between");
  refused({"--profile", "w"}, "--profile");
}

// Each place may be typed in its own unit; one that is none is refused by name.
TEST(SectionCommand, TakesPlacesInAnyUnitOfLength) {
  const TempFolder folder;
  const std::string scan = folder.file("s.tif"), out = folder.file("t.tif");
  ASSERT_EQ(fettle({"synth", scan, "--size", "120x100", "--seed", "2"}).status, 0);
  const auto plain = fettleJson({"section", scan, "--start", "1,2", "--end", "5,2.5", "--width", "0.2",
                                 "--cursors", "1,3", "--probe", "2,2", "--step", "2"});
  const auto typed =
      fettleJson({"section", scan, "--start", "1mm,2000um", "--end", "0.5cm,2.5", "--width", "200um",
                  "--cursors", "1000um,3mm", "--probe", "2mm,0.2cm", "--step", "2mm"});
  EXPECT_NEAR(plain["sections"][0]["length_mm"], std::hypot(4.0, 0.5), 1e-9);
  for (const char* key : {"sections", "probes"}) EXPECT_EQ(typed[key], plain[key]) << key;
  EXPECT_EQ(fettleJson({"section", scan, "--line", "1mm,2000um:0.5cm,2.5"})["sections"][0]["length_mm"],
            plain["sections"][0]["length_mm"]);
  EXPECT_EQ(fettleJson({"transform", scan, out, "--crop", "1mm,1mm,0.4cm,3000um"})["hash"],
            fettleJson({"transform", scan, out, "--crop", "1,1,4,3"})["hash"]);
  EXPECT_EQ(
      fettleJson({"level", scan, out, "--through", "1mm,1mm:4000um,1:2,3mm", "--probe", "300um",
                  "--force"})["tilt_x"],
      fettleJson({"level", scan, out, "--through", "1,1:4,1:2,3", "--probe", "0.3", "--force"})["tilt_x"]);
  const std::vector<std::vector<std::string>> wrong = {
      {"--start", "1q,2", "--end", "5,2.5"},
      {"--line", "1mm,2q:3,4"},
      {"--start", "1,2", "--end", "5,2.5", "--width", "2parsec"},
      {"--probe", "1mm"}};
  for (const std::vector<std::string>& options : wrong) {
    std::vector<std::string> words{"section", scan};
    words.insert(words.end(), options.begin(), options.end());
    const Outcome outcome = fettle(words);
    EXPECT_EQ(outcome.status, 2) << options.back();
    EXPECT_NE(
        outcome.err.find(options.size() > 2 ? options[options.size() - 2] == "--end" ? "--start" : "--width"
                                            : options.front()),
        std::string::npos)
        << outcome.err;
  }
}

TEST(SectionCommand, AFigureThatIsNotDeterminedLeavesTheOthers) {
  const TempFolder folder;
  const std::string scan = folder.file("groove.asc");
  writeGroove(scan);
  const Outcome outcome = fettle({"section", scan, "--unit", "mm", "--line", "1,2:7,2", "--arc", "0,1",
                                  "--cursors", "1,4", "--cutoff", "5", "--json"});
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  const auto report = nlohmann::json::parse(outcome.out);
  const auto section = report["sections"][0];
  EXPECT_TRUE(section.contains("cursors"));
  EXPECT_FALSE(section.contains("arc"));
  EXPECT_FALSE(section.contains("roughness"));
  ASSERT_EQ(report["warnings"].size(), 2U) << report["warnings"].dump();
  EXPECT_EQ(report["warnings"][0].get<std::string>().find("section 0, arc: "), 0U)
      << report["warnings"].dump();
  EXPECT_EQ(report["warnings"][1].get<std::string>().find("section 0, roughness: "), 0U)
      << report["warnings"].dump();
  // Nothing of what was wanted is no result.
  expectRefused(
      fettle({"section", scan, "--unit", "mm", "--line", "1,2:7,2", "--arc", "0,1", "--cutoff", "5"}),
      "curvature");
}

// The middle of what lies on the section: a stretch that was typed beyond its end is not extrapolated.
TEST(SectionCommand, ALinesMiddleIsOnTheSection) {
  const TempFolder folder;
  const std::string scan = folder.file("groove.asc");
  writeGroove(scan);
  const auto line = [&](const char* stretch) {
    return fettleJson({"section", scan, "--unit", "mm", "--line", "0,2:7.9,2", "--fit-line",
                       stretch})["sections"][0]["line"];
  };
  EXPECT_EQ(line("5.5,7.9")["height_mm"], line("5.5,70")["height_mm"]);
}

TEST(SectionCommand, NamesPlacesThatWereFilled) {
  const TempFolder folder;
  const std::string scan = folder.file("groove.asc"), filled = folder.file("filled.fettle");
  writeGroove(scan);
  ASSERT_EQ(fettle({"fill", scan, filled, "--unit", "mm"}).status, 0);
  const auto at = [&](const char* line, std::vector<std::string> more) {
    std::vector<std::string> words{"section", filled, "--line", line};
    words.insert(words.end(), more.begin(), more.end());
    return fettleJson(words)["sections"][0];
  };
  EXPECT_EQ(at("0,1:7.9,1", {})["filled"], 1);
  EXPECT_EQ(at("0,1.05:7.9,1.05", {})["filled"], 1) << "between two rows one of which is filled";
  EXPECT_EQ(at("0,1:7.9,1", {"--width", "1"})["filled"], 1) << "one lane of eleven";
  EXPECT_EQ(at("0,2:7.9,2", {})["filled"], 0);
  const Outcome table = fettle({"section", filled, "--line", "0,1:7.9,1", "--csv", "-"});
  EXPECT_EQ(table.out.rfind("section,along_mm,x_mm,y_mm,height_mm,share,filled,interpolation,layer\n", 0), 0U)
      << table.out;
  const auto lines = [&](const char* with) {
    std::size_t count = 0;
    for (std::size_t i = table.out.find(with); i != std::string::npos; i = table.out.find(with, i + 1))
      ++count;
    return count;
  };
  EXPECT_EQ(lines(",yes,bilinear"), 1U);
  EXPECT_EQ(lines(",no,bilinear"), 79U);
  const auto measured = at("0,1:7.9,1", {"--region", "measured"});
  EXPECT_EQ(measured["without_height"], 1);
  EXPECT_FALSE(measured.contains("filled"));
  const Outcome text = fettle({"section", filled, "--line", "0,1:7.9,1"});
  EXPECT_NE(text.out.find("1 places have heights that were filled"), std::string::npos) << text.out;
  for (const auto& words :
       {std::vector<std::string>{"fit", filled, "--shape", "plane"}, {"compare", filled, filled}}) {
    const Outcome said = fettle(words);
    ASSERT_EQ(said.status, 0) << said.err;
    EXPECT_NE(said.err.find("1 of its samples were filled, not measured"), std::string::npos) << said.err;
  }
}

// Each reason for a section without heights is another remedy.
TEST(SectionCommand, SaysWhyThereIsNoHeight) {
  const TempFolder folder;
  const std::string scan = folder.file("groove.asc"), row = folder.file("row.asc"),
                    holes = folder.file("h.asc");
  writeGroove(scan);
  std::ofstream(row) << "ncols 5\nnrows 1\nxllcenter 0\nyllcenter 0\ncellsize 1\n1 2 3 4 5\n";
  std::ofstream(holes) << "ncols 3\nnrows 3\nxllcenter 0\nyllcenter 0\ncellsize 1\nNODATA_value -9999\n"
                       << "1 1 1\n-9999 -9999 -9999\n1 1 1\n";
  const auto refused = [](const std::string& of, std::vector<std::string> words, const std::string& why) {
    words.insert(words.begin(), {"section", of, "--unit", "mm"});
    expectRefused(fettle(words), why);
  };
  refused(scan, {"--line", "50,50:60,60"}, "to 7.9,3.9 mm");
  refused(scan, {"--line", "1,1:6,1", "--region", "marked"}, "with a height is marked");
  refused(holes, {"--line", "0,1:2,1"}, "holes alone");
  refused(row, {"--line", "0,0:4,0", "--width", "3"}, "smaller width");
  refused(scan, {"--line", "1,1:6,1", "--compare", row}, "row.asc");
  EXPECT_EQ(fettleJson({"section", row, "--unit", "mm", "--line", "0,0:4,0"})["sections"][0]["partial"], 0);
  const auto wide = fettleJson({"section", scan, "--unit", "mm", "--line", "0,0:7.9,0", "--width", "0.2"});
  EXPECT_EQ(wide["sections"][0]["partial"], 80) << "a lane of three lies outside";
}

// A scan of an atomic force microscope is not read in thousandths of micrometres.
TEST(SectionCommand, ReadsInTheUnitsOfTheScansSize) {
  const TempFolder folder;
  const std::string scan = folder.file("afm.asc");
  std::ofstream out(scan);
  out << "ncols 40\nnrows 20\nxllcenter 0\nyllcenter 0\ncellsize 4e-9\n";
  for (int r = 0; r < 20; ++r) {
    for (int c = 0; c < 40; ++c) out << (c < 20 ? 0.0 : 1.3e-8) + 1e-11 * ((c * 7 + r * 5) % 3) << ' ';
    out << "\n";
  }
  out.close();
  const Outcome text = fettle({"section", scan, "--unit", "m", "--start", "0,4e-5", "--end", "1.5e-4,4e-5",
                               "--step", "auto", "--plot", folder.file("p.svg")});
  EXPECT_NE(text.out.find("150 nm long"), std::string::npos) << text.out;
  EXPECT_NE(text.out.find("step       13"), std::string::npos) << text.out;
  EXPECT_EQ(text.out.find("e-"), std::string::npos) << text.out;
  const std::string picture = bytesOf(folder.file("p.svg"));
  EXPECT_NE(picture.find("[nm]"), std::string::npos);
  EXPECT_NE(picture.find("step"), std::string::npos) << "the edge has its name";
}

TEST(SectionCommand, StatesNoEdgeWhereNoneStandsOut) {
  const TempFolder folder;
  const std::string flat = folder.file("flat.asc"), noise = folder.file("noise.asc");
  std::ofstream zeros(flat), rough(noise);
  std::mt19937_64 random(4);
  std::normal_distribution<double> normal(0.0, 0.01);
  for (std::ofstream* out : {&zeros, &rough}) {
    *out << "ncols 120\nnrows 20\nxllcenter 0\nyllcenter 0\ncellsize 1\n";
    for (int i = 0; i < 120 * 20; ++i)
      *out << (out == &zeros ? 0.0 : normal(random)) << (i % 120 == 119 ? '\n' : ' ');
    out->close();
  }
  for (const std::string& scan : {flat, noise}) {
    const auto section = [&](const char* option) {
      return fettle({"section", scan, "--unit", "mm", "--start", "0,10", "--end", "119,10", option, "auto"});
    };
    expectRefused(section("--step"), "stands out");
    EXPECT_EQ(
        section("--step").err,
        "fettle: error: no step stands out from the noise of the section, --step auto, give a --width to "
        "average over, or the edge's length as --step A\n");
    expectRefused(section("--groove"), "stands out");
  }
}

// A slip of the hand in a name must not cost a scan.
TEST(SectionCommand, NeverWritesTextOverAScan) {
  const TempFolder folder;
  const std::string scan = folder.file("s.tif"), keep = folder.file("keep.tif");
  ASSERT_EQ(fettle({"synth", scan, "--size", "64x64"}).status, 0);
  ASSERT_EQ(fettle({"synth", keep, "--size", "64x64", "--seed", "2"}).status, 0);
  const auto hash = fettleJson({"measure", keep})["sq"];
  const auto section = [&](const char* option, const std::string& out) {
    return fettle({"section", scan, "--start", "1,1", "--end", "20,20", option, out});
  };
  expectRefused(section("--csv", keep), "keep.tif");
  expectRefused(section("--csv", folder.file("a.asc")), ".asc");
  expectRefused(section("--dxf", keep), ".dxf");
  expectRefused(section("--plot", keep), ".svg");
  expectRefused(fettle({"measure", scan, "--csv", keep}), "keep.tif");
  expectRefused(fettle({"report", scan, keep}), ".html");
  expectRefused(fettle({"report", scan, folder.file("r.svg")}), ".pdf");
  EXPECT_EQ(fettleJson({"measure", keep})["sq"], hash);
}

}  // namespace
}  // namespace fettle::tests
