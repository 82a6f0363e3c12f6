// What commands say of heights that floats hold badly.

#include <fstream>
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tests/end_to_end/program.h"
#include "tests/support/temp_folder.h"

namespace fettle::tests {
namespace {

// A plate of 60 x 60 samples 1 mm apart with 0.3 mm of noise, at a height: 4e6 mm, where floats are 0.25 mm apart, or 0.
void writePlate(const std::string& path, double height) {
  std::mt19937 random(2);
  std::normal_distribution<double> noise(0.0, 0.3);
  std::ofstream out(path);
  out.precision(12);
  out << "ncols 60\nnrows 60\nxllcenter 0\nyllcenter 0\ncellsize 1\n";
  for (int r = 0; r < 60; ++r) {
    for (int c = 0; c < 60; ++c) out << height + 0.01 * c + noise(random) << ' ';
    out << '\n';
  }
}

TEST(Rounding, IsSaidByEachCommandWhoseRmsHasIt) {
  const TempFolder folder;
  const std::string high = folder.file("high.asc"), low = folder.file("low.asc");
  writePlate(high, 4e6);
  writePlate(low, 0.0);
  for (const std::string& scan : {high, low}) {
    const std::string smooth = folder.file("smooth.tif");
    ASSERT_EQ(fettle({"filter", scan, smooth, "--filter", "box", "--window", "3", "--unit", "mm"}).status, 0);
    const std::vector<std::vector<std::string>> commands = {
        {"fit", scan, "--shape", "plane", "--unit", "mm"},
        {"compare", scan, smooth, "--unit", "mm"},
        {"section", scan, "--start", "5,5", "--end", "50,50", "--cutoff", "8", "--unit", "mm"},
        {"section", scan, "--start", "5,5", "--end", "50,50", "--fit-line", "5,50", "--unit", "mm"}};
    for (const std::vector<std::string>& command : commands) {
      const Outcome outcome = fettle(command);
      ASSERT_EQ(outcome.status, 0) << outcome.err;
      EXPECT_EQ(outcome.err.find("are floats 0.25 mm apart") != std::string::npos, scan == high)
          << command.front() << ' ' << outcome.err;
    }
    // Nothing is left of a scan beside itself, and nothing is said.
    EXPECT_EQ(fettle({"compare", scan, scan, "--unit", "mm"}).err.find("are floats"), std::string::npos);
  }
  // Of a form over the scan the heights count that were rounded, not those that are seen.
  const std::string formed = folder.file("formed.fettle");
  ASSERT_EQ(fettle({"level", high, formed, "--layer", "put", "--unit", "mm"}).status, 0);
  const Outcome seen = fettle({"fit", formed, "--shape", "plane"});
  ASSERT_EQ(seen.status, 0) << seen.err;
  EXPECT_NE(seen.err.find("are floats 0.25 mm apart"), std::string::npos) << seen.err;
}

}  // namespace
}  // namespace fettle::tests
