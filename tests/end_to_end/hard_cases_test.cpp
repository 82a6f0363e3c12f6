// Scans on which there is little or nothing to be measured, by the command line: each figure is a number or "-", and a
// refusal is one line. Never a NaN in a table.

#include <cctype>
#include <cmath>
#include <fstream>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "tests/end_to_end/program.h"
#include "tests/support/temp_folder.h"

namespace fettle::tests {
namespace {

struct HardScan {
  std::string name;
  int columns, rows;
  double spacing_x, spacing_y, origin;
  std::function<double(int, int)> z;
};

const double kHole = std::numeric_limits<double>::quiet_NaN();

double rough(int c, int r) {
  return 0.2 * std::sin(0.3 * c) + 0.1 * std::cos(0.2 * r) + 0.01 * std::sin(12.9898 * c + 78.233 * r);
}

std::vector<HardScan> hardScans() {
  return {
      {"holes", 40, 30, 0.1, 0.1, 0.0, [](int, int) { return kHole; }},
      {"one row", 90, 1, 0.1, 0.1, 0.0, rough},
      {"one sample", 1, 1, 0.1, 0.1, 0.0, [](int, int) { return 5.0; }},
      {"flat", 60, 50, 0.1, 0.1, 0.0, [](int, int) { return 3.0; }},
      {"three samples", 60, 50, 0.1, 0.1, 0.0,
       [](int c, int r) {
         return (c == 5 && r == 5) || (c == 6 && r == 5) || (c == 5 && r == 6) ? rough(c, r) : kHole;
       }},
      {"spikes", 60, 50, 0.1, 0.1, 0.0,
       [](int c, int r) { return (7 * c + 13 * r) % 97 == 0 ? 1e6 : rough(c, r); }},
      {"far origin", 60, 50, 0.1, 0.1, 5e6, rough},
      {"spacing 1:4", 60, 50, 0.1, 0.4, 0.0, rough},
  };
}

void write(const HardScan& scan, const std::string& path) {
  std::ofstream out(path);
  out << fmt::format("ncols {}\nnrows {}\nxllcorner {}\nyllcorner {}\n", scan.columns, scan.rows, scan.origin,
                     scan.origin);
  out << (scan.spacing_x == scan.spacing_y ? fmt::format("cellsize {}\n", scan.spacing_x)
                                           : fmt::format("dx {}\ndy {}\n", scan.spacing_x, scan.spacing_y));
  out << "NODATA_value -9999\n";
  for (int r = scan.rows - 1; r >= 0; --r) {
    for (int c = 0; c < scan.columns; ++c) {
      const double z = scan.z(c, r);
      out << fmt::format("{:.9g} ", std::isnan(z) ? -9999.0 : z);
    }
    out << '\n';
  }
}

// The first word of a text that is no number where one belongs: "nan", "inf" by itself.
std::string noNumberIn(const std::string& text) {
  std::string word;
  for (const char c : text + " ") {
    if (std::isalpha(static_cast<unsigned char>(c)) != 0) {
      word += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
      continue;
    }
    if (word == "nan" || word == "inf" || word == "infinity") return word;
    word.clear();
  }
  return {};
}

TEST(HardCases, EveryFigureIsANumberOrADash) {
  const TempFolder folder;
  const std::string csv = folder.file("table.csv"), out = folder.file("out.asc");
  for (const HardScan& scan : hardScans()) {
    const std::string path = folder.file("scan.asc");
    write(scan, path);
    const std::string x = fmt::format("{}", (scan.columns - 1) * scan.spacing_x);
    const std::string y = fmt::format("{}", (scan.rows - 1) * scan.spacing_y / 2.0);
    for (std::vector<std::string> line : std::vector<std::vector<std::string>>{
             {"info", path},
             {"compare", path, path, "--truth", path},
             {"compare", path, path, "--align", "all"},
             {"measure", path, "--csv", csv},
             {"measure", path, "--form", "sphere", "--robust", "--s-filter", "0.3", "--l-filter", "2",
              "--csv", csv},
             {"level", path, out, "--form", "poly5"},
             {"level", path, out, "--rows", "matching", "--form", "none"},
             {"fill", path, out, "--border"},
             {"remove", path, out, "--between=-1,0.5"},
             {"fit", path, "--csv", csv},
             {"fit", path, "--shape", "cylinder", "--robust", "--csv", csv},
             {"align", path, path, out, "--csv", csv},
             {"features", path, "--csv", csv},
             {"section", path, "--start", "0," + y, "--end", x + "," + y, "--csv", csv},
             {"section", path, "--start", "0," + y, "--end", x + "," + y, "--step", "auto"},
             {"section", path, "--start", "0," + y, "--end", x + "," + y, "--cutoff", "0.8"},
             {"section", path, "--start", "0," + y, "--end", x + "," + y, "--probe", "0.5," + y}}) {
      std::ofstream(csv) << "";
      std::ofstream(out) << "";
      line.insert(line.end(), {"--unit", "mm"});
      const Outcome outcome = fettle(line);
      std::string typed = scan.name + ":";
      for (const std::string& word : line) typed += " " + word;
      EXPECT_LE(outcome.status, 2) << typed << "\n" << outcome.err;
      EXPECT_FALSE(outcome.err.empty() && outcome.out.empty()) << typed;
      EXPECT_EQ(noNumberIn(outcome.out), "") << typed << "\n" << outcome.out;
      EXPECT_EQ(noNumberIn(outcome.err), "") << typed << "\n" << outcome.err;
      EXPECT_EQ(noNumberIn(bytesOf(csv)), "") << typed;
      EXPECT_EQ(noNumberIn(bytesOf(out)), "") << typed;
    }
  }
}

TEST(HardCases, WhatHasNoHeightHasNoFigure) {
  const TempFolder folder;
  const std::string path = folder.file("holes.asc");
  write(hardScans()[0], path);
  const Outcome outcome = fettle({"compare", path, path, "--truth", path, "--unit", "mm"});
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_NE(outcome.out.find("rms         -\n"), std::string::npos) << outcome.out;
  EXPECT_NE(outcome.err.find("no sample in common"), std::string::npos) << outcome.err;
}

}  // namespace
}  // namespace fettle::tests
