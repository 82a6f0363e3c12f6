// fettle compare and align with a nominal mesh, as an inspector types them.

#include <cmath>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tests/end_to_end/program.h"
#include "tests/support/temp_folder.h"

namespace fettle::tests {
namespace {

double domes(double x, double y) {
  return 0.4 * std::sin(0.9 * x + 0.3) * std::cos(0.7 * y) + 0.25 * std::sin(1.7 * x - 1.3 * y + 1.0);
}

// `up` above the domes, moved by (x, y) mm; ESRI ASCII, 0.1 mm apart, one hole. `origin` of the world.
void writePart(const std::string& path, double x, double y, double up, double origin = 0.0, int side = 80) {
  std::ofstream out(path);
  out.precision(9);
  out << "ncols " << side << "\nnrows " << side << "\nxllcenter " << origin << "\nyllcenter " << -origin
      << "\ncellsize 0.1\nNODATA_value -9999\n";
  for (int r = side - 1; r >= 0; --r) {
    for (int c = 0; c < side; ++c)
      out << (r == 7 && c == 9 ? -9999.0 : domes(0.1 * c - x, 0.1 * r - y) + up) << ' ';
    out << '\n';
  }
}

// The domes from -1 to 9 mm, finer than the part, from `corner` on; in units of `unit` mm.
void writeNominal(const std::string& path, double corner = -1.0, double unit = 1.0) {
  std::ofstream out(path);
  out.precision(9);
  out << "solid domes\n";
  const auto corner_at = [&](int c, int r) {
    const double x = 0.0625 * c - 1.0, y = 0.0625 * r - 1.0;
    std::ostringstream text;
    text.precision(9);
    text << "vertex " << (x + 1.0 + corner) / unit << ' ' << (y + 1.0 + corner) / unit << ' '
         << domes(x, y) / unit << '\n';
    return text.str();
  };
  for (int r = 0; r < 160; ++r)
    for (int c = 0; c < 160; ++c) {
      out << "facet normal 0 0 1\nouter loop\n"
          << corner_at(c, r) << corner_at(c + 1, r) << corner_at(c + 1, r + 1) << "endloop\nendfacet\n";
      out << "facet normal 0 0 1\nouter loop\n"
          << corner_at(c, r) << corner_at(c + 1, r + 1) << corner_at(c, r + 1) << "endloop\nendfacet\n";
    }
  out << "endsolid domes\n";
}

// A triangle of 0.0625 mm is off by 0.0625^2 / 4 of the second derivatives, together at most 1.8 / mm: 1.8e-3 mm.
constexpr double kFlat = 2e-3;

TEST(NominalCommand, MeasuresAPartWhereTheFilesPlaceIt) {
  const TempFolder folder;
  const std::string part = folder.file("part.asc"), nominal = folder.file("nominal.stl"),
                    out = folder.file("d.tif");
  writePart(part, 0.0, 0.0, 0.3);
  writeNominal(nominal);
  const auto report =
      fettleJson({"compare", part, nominal, "--unit", "mm", "--tolerance", "250um", "--deviation", out});
  EXPECT_EQ(report["samples"], 80 * 80 - 1);
  EXPECT_EQ(report["unmeasured"], 1);
  EXPECT_EQ(report["no_nominal"], 0);
  EXPECT_NEAR(report["mean"], 0.3, kFlat);
  EXPECT_NEAR(report["min"], 0.3, kFlat);
  EXPECT_NEAR(report["max"], 0.3, kFlat);
  EXPECT_EQ(report["above"], 80 * 80 - 1);
  EXPECT_EQ(report["within"], 0);
  EXPECT_EQ(report["nominal"]["triangles"], 2 * 160 * 160);
  const auto shortest = fettleJson({"compare", part, nominal, "--unit", "mm", "--distance", "shortest"});
  EXPECT_LT(shortest["mean"].get<double>(), report["mean"].get<double>());
  EXPECT_GT(shortest["min"].get<double>(), 0.1);
  const auto written = fettleJson({"info", out});
  EXPECT_NEAR(written["mean"], report["mean"], 1e-6);
  EXPECT_EQ(written["no_data"], 1);
  // The same in inches, where that is said, and from standard input.
  const std::string inches = folder.file("in.stl");
  writeNominal(inches, -1.0, 25.4);
  const auto same = fettleJson({"compare", part, inches, "--unit", "mm", "--nominal-unit", "in"});
  EXPECT_NEAR(same["mean"], report["mean"], 1e-5);
  EXPECT_EQ(same["nominal"]["unit"], "in");
  EXPECT_NE(fettle({"compare", part, inches, "--unit", "mm"}).err.find("are its numbers mm?"),
            std::string::npos);
  // 5e6 from zero the mesh counts from the part's corner, and that is said.
  const std::string far = folder.file("far.asc");
  writePart(far, 0.0, 0.0, 0.3, 5e6);
  const Outcome away = fettle({"compare", far, nominal, "--unit", "mm", "--json"});
  EXPECT_EQ(away.status, 0) << away.err;
  EXPECT_NE(away.out.find("\"samples\": 6399"), std::string::npos) << away.out;
  EXPECT_NE(away.out.find("from the part's lower left sample"), std::string::npos) << away.out;
  EXPECT_EQ(away.out.find("null"), std::string::npos) << away.out;
}

// A PLY may be a scan: it is a nominal where its unit is stated, and measures as the same mesh in an STL does.
// A mesh that Fettle wrote lies where its scan lay: at half a cell, where both worlds overlap and only the header tells them apart, far
// away, and of a part of the scan.
TEST(NominalCommand, AMeshOfAScanLiesWhereTheScanLay) {
  const TempFolder folder;
  const std::string part = folder.file("part.asc"), mesh = folder.file("part.stl"),
                    cut = folder.file("cut.tif");
  for (const double origin : {0.0, 0.05, -3.0, 5e6}) {
    writePart(part, 0.0, 0.0, 0.0, origin);
    ASSERT_EQ(fettle({"convert", part, mesh, "--unit", "mm", "--force"}).status, 0);
    const Outcome said = fettle({"compare", part, mesh, "--unit", "mm", "--json"});
    ASSERT_EQ(said.status, 0) << said.err;
    const auto report = nlohmann::json::parse(said.out);
    // Sampled at its own corners, with seven digits.
    EXPECT_LT(report["max_abs"].get<double>(), 1e-6) << origin;
    EXPECT_LE(report["no_nominal"].get<int>(), 1) << origin;
    EXPECT_EQ(report["warnings"].dump().find("triangle"), std::string::npos) << report["warnings"].dump();
    EXPECT_EQ(report["warnings"].dump().find("beside"), std::string::npos) << report["warnings"].dump();
    ASSERT_EQ(fettle({"transform", part, cut, "--crop", "2,3,7.9,7.9", "--unit", "mm", "--force"}).status, 0);
    EXPECT_LT(fettleJson({"compare", cut, mesh})["max_abs"].get<double>(), 1e-6) << origin;
  }
  // Micrometres say so themselves.
  ASSERT_EQ(fettle({"convert", part, mesh, "--unit", "um", "--force"}).status, 0);
  const auto small = fettleJson({"compare", part, mesh, "--unit", "um"});
  EXPECT_EQ(small["nominal"]["unit"], "um");
  EXPECT_LT(small["max_abs"].get<double>(), 1e-6);
}

TEST(NominalCommand, SaysWhereMostOfThePartLiesBeside) {
  const TempFolder folder;
  const std::string part = folder.file("part.asc"), nominal = folder.file("nominal.stl");
  writePart(part, 0.0, 0.0, 0.0);
  writeNominal(nominal, 6.0);
  const Outcome said = fettle({"compare", part, nominal, "--unit", "mm"});
  ASSERT_EQ(said.status, 0) << said.err;
  EXPECT_NE(said.err.find("samples lie over no triangle"), std::string::npos) << said.err;
}

TEST(NominalCommand, TakesThePlyOfAMeshWhoseUnitIsStated) {
  const TempFolder folder;
  const std::string part = folder.file("part.tif"), truth = folder.file("truth.tif"),
                    stl = folder.file("n.stl"), ply = folder.file("n.ply"),
                    points = folder.file("points.ply");
  ASSERT_EQ(fettle({"synth", part, "--part", "steps", "--size", "90x70", "--truth", truth}).status, 0);
  ASSERT_EQ(fettle({"convert", truth, stl}).status, 0);
  ASSERT_EQ(fettle({"convert", truth, ply, "--mesh"}).status, 0);
  ASSERT_EQ(fettle({"convert", truth, points}).status, 0);
  const auto of_ply = fettleJson({"compare", part, ply, "--nominal-unit", "mm"}),
             of_stl = fettleJson({"compare", part, stl});
  EXPECT_EQ(of_ply["nominal"], of_stl["nominal"]);
  EXPECT_EQ(of_ply["samples"], of_stl["samples"]);
  // An STL rounds the places of its corners to float, some 1e-6 of 20 mm, on faces as steep as the noise of 0.02 per sample.
  for (const char* key : {"min", "max", "mean", "rms"})
    EXPECT_NEAR(of_ply[key].get<double>(), of_stl[key].get<double>(), 1e-5) << key;
  EXPECT_FALSE(fettleJson({"compare", part, ply}).contains("nominal")) << "a scan without";
  expectRefused(fettle({"compare", part, points, "--nominal-unit", "mm"}), "it holds points and no faces");
}

TEST(NominalCommand, AlignsFirstWhereAsked) {
  const TempFolder folder;
  const std::string part = folder.file("part.asc"), nominal = folder.file("nominal.stl"),
                    out = folder.file("n.tif");
  writePart(part, 0.33, -0.27, 0.5);
  writeNominal(nominal, 40.0);
  const auto report =
      fettleJson({"align", part, nominal, out, "--unit", "mm", "--csv", folder.file("m.csv")});
  // The mesh begins 1 mm lower left of the domes' zero.
  EXPECT_NEAR(report["shift_x_mm"], 0.33 - 1.0, 1e-3);
  EXPECT_NEAR(report["shift_y_mm"], -0.27 - 1.0, 1e-3);
  EXPECT_NEAR(report["shift_z_mm"], 0.5, 1e-3);
  EXPECT_GT(report["shift_x_error_mm"].get<double>(), 0.0);
  EXPECT_EQ(report["nominal"]["triangles"], 2 * 160 * 160);
  EXPECT_TRUE(std::filesystem::exists(folder.file("m.csv")));
  EXPECT_LT(fettleJson({"compare", part, out, "--unit", "mm"})["max_abs"].get<double>(), 2.0 * kFlat);
  const auto at_once =
      fettleJson({"compare", part, nominal, "--unit", "mm", "--align", "all", "--distance", "shortest"});
  EXPECT_LT(at_once["max_abs"].get<double>(), 2.0 * kFlat);
  EXPECT_EQ(at_once["align"]["shift_x_mm"], report["shift_x_mm"]);
  EXPECT_EQ(at_once["samples"], 80 * 80 - 1);
}

TEST(NominalCommand, SaysWhatItCannotDo) {
  const TempFolder folder;
  const std::string part = folder.file("part.asc"), nominal = folder.file("nominal.stl"),
                    far = folder.file("far.stl"), damaged = folder.file("damaged.stl"),
                    out = folder.file("o.tif");
  writePart(part, 0.0, 0.0, 0.0);
  writeNominal(nominal);
  writeNominal(far, 40.0);
  std::ofstream(damaged, std::ios::binary)
      << std::string(80, ' ') << std::string("\x05\0\0\0", 4) << std::string(120, '\0');
  struct Refusal {
    std::vector<std::string> words;
    const char* text;
  };
  for (const Refusal& one :
       {Refusal{{"compare", part, far, "--deviation", out}, "lies nowhere over or under the part"},
        {{"compare", part, damaged, "--deviation", out}, "too short for 5 triangles"},
        {{"align", part, damaged, out}, "too short for 5 triangles"},
        {{"compare", part, folder.file("none.stl")}, "none.stl"},
        {{"compare", part, nominal, "--truth", part}, "is a nominal mesh"},
        {{"compare", part, nominal, "--rotation", "5"}, "nothing is aligned"},
        {{"compare", part, nominal, "--tolerance", "-1"}, "--tolerance"},
        {{"compare", part, nominal, "--nominal-unit", "ell"}, "unknown unit ell"},
        {{"compare", part, part, "--distance", "shortest"}, "is no nominal mesh"},
        {{"compare", part, part, "--tolerance", "1"}, "is no nominal mesh"},
        {{"align", part, part, "--nominal-unit", "mm"}, "is no nominal mesh"},
        {{"compare", part, nominal, "--deviation", nominal}, "would replace an input"}}) {
    std::vector<std::string> words = one.words;
    words.insert(words.end(), {"--unit", "mm"});
    const Outcome outcome = fettle(words);
    EXPECT_EQ(outcome.status, 2) << one.text;
    EXPECT_NE(outcome.err.find(one.text), std::string::npos) << outcome.err;
    EXPECT_FALSE(std::filesystem::exists(out)) << one.text;
  }
}

}  // namespace
}  // namespace fettle::tests
