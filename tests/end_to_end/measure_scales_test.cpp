// S- and L-filters of fettle measure, and the surface between them.

#include <algorithm>
#include <cmath>
#include <fstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tests/end_to_end/measured_scans.h"
#include "tests/end_to_end/program.h"
#include "tests/support/temp_folder.h"

namespace fettle::tests {
namespace {

// What lies beyond a region is as good as holes for the filters, too: figures are those of the part alone.
TEST(Measure, FiltersOfARegionKnowNothingBeyondIt) {
  const TempFolder folder;
  const std::string scan = folder.file("step.asc"), part = folder.file("part.tif");
  const std::string marks = folder.file("marks.png"), marked = folder.file("marked.tif");
  writeHeights(scan, 80, 50, [](int c, int r) {
    return 1e-3 * std::sin(1.3 * c) * std::cos(0.9 * r) + (c > 40 ? 0.2 : 0.0);
  });
  ASSERT_EQ(fettle({"transform", scan, part, "--unit", "mm", "--crop-samples", "0,0,50,41"}).status, 0);
  const std::vector<std::string> filters{"--s-filter", "0.12", "--l-filter", "0.8", "--noise-trials", "0"};
  const auto figures = [&](std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), "measure");
    arguments.insert(arguments.end(), filters.begin(), filters.end());
    return fettleJson(arguments);
  };
  const auto of_part = figures({part});
  const auto of_region = figures({scan, "--unit", "mm", "--region", "rectangle 0,0,2.01,2.5"});
  EXPECT_EQ(of_region["samples"], of_part["samples"]);
  for (const char* key : {"sq", "sz", "sdq", "sal", "sk"})
    EXPECT_NEAR(of_region[key], of_part[key], 1e-3 * of_part[key].get<double>()) << key;
}

// A bow is bent up at its ends by what it is filtered with, unless it is filtered about its form.
TEST(Measure, AnSFilterOfABentSurfaceKeepsItsEnds) {
  const TempFolder folder;
  const std::string scan = folder.file("bow.asc"), level = folder.file("level.tif");
  writeHeights(scan, 80, 60, [](int c, int r) {
    const double x = 0.05 * (c - 39.5);
    return std::sqrt(25.0 - x * x) - 5.0 + 2e-4 * std::sin(0.4 * c + 0.3 * r);
  });
  ASSERT_EQ(fettle({"level", scan, level, "--unit", "mm", "--form", "cylinder"}).status, 0);
  const std::vector<std::string> s{"--s-filter", "0.15", "--noise-trials", "0", "--only", "height"};
  const auto sz = [&](std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), "measure");
    arguments.insert(arguments.end(), s.begin(), s.end());
    return fettleJson(arguments)["sz"].get<double>();
  };
  const double alone = sz({level, "--form", "none"});
  EXPECT_NEAR(sz({scan, "--unit", "mm", "--form", "cylinder"}) / alone, 1.0, 0.02);
  EXPECT_GT(sz({scan, "--unit", "mm", "--form", "plane"}) / alone, 10.0) << "it has a bow to filter";
}

// The surface that is written has, measured as it is, the parameters that were stated, its holes, and no sample outside of the
// region. Heights are rounded to float once more: 6e-8 of the greatest, of parameters of small differences a thousand times that.
TEST(Measure, TheSurfaceThatIsWrittenHasTheParameters) {
  const TempFolder folder;
  const std::string scan = folder.file("scan.asc"), surface = folder.file("surface.tif");
  {
    std::ofstream out(scan);
    out << "ncols 120\nnrows 90\nxllcenter 0\nyllcenter 0\ndx 0.1\ndy 0.2\nNODATA_value -9999\n";
    for (int r = 89; r >= 0; --r) {
      for (int c = 0; c < 120; ++c)
        out << ((c - 40) * (c - 40) + (r - 30) * (r - 30) < 30
                    ? -9999.0
                    : 0.01 * c - 0.02 * r + 0.05 * std::sin(0.8 * c) * std::cos(0.5 * r) +
                          0.2 * std::sin(0.06 * c))
            << ' ';
      out << '\n';
    }
  }
  for (const std::vector<std::string>& how : std::vector<std::vector<std::string>>{
           {},
           {"--form", "poly2", "--robust"},
           {"--s-filter", "0.6"},
           {"--s-filter", "0.6", "--l-filter", "4"},
           {"--l-filter", "4", "--l-filter-kind", "spline", "--form", "poly3"},
           {"--s-filter", "0.6", "--l-filter", "4", "--region", "rectangle 1,2,9,15"}}) {
    std::vector<std::string> line{"measure",   scan,    "--unit",         "mm",
                                  "--surface", surface, "--noise-trials", "0"};
    line.insert(line.end(), how.begin(), how.end());
    const std::string typed = how.empty() ? "" : how.back();
    const auto stated = fettleJson(line);
    EXPECT_EQ(stated["surface"], surface);
    const auto again = fettleJson({"measure", surface, "--form", "none", "--noise-trials", "0"});
    EXPECT_EQ(again["samples"], stated["samples"]) << typed;
    EXPECT_EQ(again["cells"], stated["cells"]) << typed;
    int compared = 0;
    for (const char* key :
         {"sq",  "ssk", "sku", "sp",  "sv",    "sz",    "sa",  "sal", "str", "std", "ssw", "sdq",
          "sdr", "sk",  "spk", "svk", "smrk1", "smrk2", "vmp", "vmc", "vvc", "vvv", "sxp", "spd",
          "svd", "spc", "svc", "s5p", "s5v",   "s10z",  "sha", "sda", "shv", "sdv"}) {
      ASSERT_EQ(again[key].is_null(), stated[key].is_null()) << typed << " " << key;
      if (again[key].is_null()) continue;
      const double value = stated[key];
      EXPECT_NEAR(again[key], value, 2e-5 * std::max(std::abs(value), 0.1)) << typed << " " << key;
      ++compared;
    }
    EXPECT_GT(compared, 18) << typed;
  }
  expectRefused(fettle({"measure", scan, scan, "--unit", "mm", "--surface", surface}), "one scan");
  expectRefused(fettle({"measure", scan, "--unit", "mm", "--surface", folder.file("s.what")}), "what");
}

// The wave of 1.2 mm: half of it is left by an S-filter of its length, and half by an L-filter of its length.
TEST(Measure, FiltersLimitTheScales) {
  const TempFolder folder;
  const std::string scan = folder.file("wave.asc");
  writeWave(scan);
  const auto sq = [&](const std::vector<std::string>& more) {
    std::vector<std::string> arguments = {"measure", scan, "--unit", "mm", "--only", "height"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return fettleJson(arguments)["sq"].get<double>();
  };
  const double all = sq({});
  // Borders within a wave of a field of five: what they add is seen beside the closed formula.
  EXPECT_NEAR(sq({"--s-filter", "1.2"}) / all, 0.5, 0.06);
  EXPECT_NEAR(sq({"--l-filter", "1200um"}) / all, 0.5, 0.06);
  EXPECT_NEAR(sq({"--s-filter", "0.2", "--l-filter", "5"}) / all, 1.0, 0.08);
  const auto report = fettleJson({"measure", scan, "--unit", "mm", "--s-filter", "0.2", "--l-filter", "5"});
  EXPECT_EQ(report["s_filter"], 0.2);
  EXPECT_EQ(report["l_filter"], 5.0);
  // Of a smooth wave the robust filters leave more than the linear ones, whose half is not theirs.
  EXPECT_NEAR(sq({"--l-filter", "5", "--l-filter-kind", "robust-gaussian"}) / all, 1.0, 0.1);
  EXPECT_NEAR(sq({"--s-filter", "0.2", "--s-filter-kind", "robust-gaussian"}) / all, 1.0, 0.05);
  // A wave of the cut-off along an axis keeps half in a spline as well; balls much larger than its arcs take all of it
  // away, and smaller ones nothing.
  EXPECT_NEAR(sq({"--s-filter", "1.2", "--s-filter-kind", "spline"}) / all, 0.5, 0.06);
  EXPECT_NEAR(sq({"--l-filter", "1.2", "--l-filter-kind", "spline"}) / all, 0.5, 0.06);
  EXPECT_LT(sq({"--s-filter", "1e5", "--s-filter-kind", "closing"}) / all, 0.05);
  EXPECT_LT(sq({"--l-filter", "0.12", "--l-filter-kind", "opening"}) / all, 0.05);
  EXPECT_NE(fettle({"measure", scan, "--unit", "mm", "--s-filter", "7"}).err.find("longer than the field"),
            std::string::npos);
  expectRefused(fettle({"measure", scan, "--unit", "mm", "--s-filter", "0"}), "--s-filter");
  // A radius is no wavelength: neither has to be the longer.
  EXPECT_GT(sq({"--s-filter", "5", "--s-filter-kind", "closing", "--l-filter", "2"}), 0.0);
  expectRefused(fettle({"measure", scan, "--unit", "mm", "--l-filter-kind", "robust-gaussian"}),
                "--l-filter");
  expectRefused(fettle({"measure", scan, "--unit", "mm", "--s-filter", "0.1"}), "--s-filter");
  expectRefused(fettle({"measure", scan, "--unit", "mm", "--s-filter", "5", "--l-filter", "2"}),
                "--l-filter");
}

}  // namespace
}  // namespace fettle::tests
