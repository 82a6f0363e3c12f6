// Scans on which there is little or nothing to be measured, by the command line: each figure is a number or "-", and a
// refusal is one line. Never a NaN in a table.

#include <cctype>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <filesystem>
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

// A page without its pictures, whose letters are no text.
std::string withoutPictures(std::string page) {
  for (std::size_t at = page.find("base64,"); at != std::string::npos; at = page.find("base64,", at + 1))
    page.erase(at + 7, page.find_first_of("\"')", at) - at - 7);
  return page;
}

// The triangles of a binary STL have numbers alone.
void expectFinite(const std::string& stl, const std::string& typed) {
  ASSERT_GE(stl.size(), 84U) << typed;
  std::uint32_t triangles = 0;
  std::memcpy(&triangles, stl.data() + 80, 4);
  ASSERT_EQ(stl.size(), 84U + 50U * triangles) << typed;
  for (std::uint32_t k = 0; k < triangles; ++k)
    for (int i = 0; i < 12; ++i) {
      float value = 0.0F;
      std::memcpy(&value, stl.data() + 84 + 50U * k + 4U * static_cast<unsigned>(i), 4);
      ASSERT_TRUE(std::isfinite(value)) << typed << " triangle " << k;
    }
}

// What each command prints and writes has no word for what is no number, and a refusal says what to do.
void expectNumbers(std::vector<std::string> line, const std::string& name,
                   const std::vector<std::string>& written) {
  for (const std::string& path : written) std::filesystem::remove(path);
  line.insert(line.end(), {"--unit", "mm"});
  const Outcome outcome = fettle(line);
  std::string typed = name + ":";
  for (const std::string& word : line) typed += " " + word;
  EXPECT_TRUE(outcome.status == 0 || outcome.status == 2) << typed << "\n" << outcome.err;
  EXPECT_FALSE(outcome.err.empty() && outcome.out.empty()) << typed;
  EXPECT_EQ(noNumberIn(outcome.out), "") << typed << "\n" << outcome.out;
  EXPECT_EQ(noNumberIn(outcome.err), "") << typed << "\n" << outcome.err;
  for (const std::string& path : written) {
    EXPECT_EQ(std::filesystem::exists(path), outcome.status == 0) << typed;
    if (!std::filesystem::exists(path) || path.ends_with(".fettle")) continue;  // a session packs its numbers
    if (path.ends_with(".stl"))
      expectFinite(bytesOf(path), typed);
    else
      EXPECT_EQ(noNumberIn(withoutPictures(bytesOf(path))), "") << typed;
  }
}

TEST(HardCases, PagesShapesAndPiecesHaveNumbersAlone) {
  const TempFolder folder;
  const std::string csv = folder.file("table.csv"), out = folder.file("out.asc"),
                    page = folder.file("page.html"), stl = folder.file("shape.stl"),
                    session = folder.file("work.fettle"), lines = folder.file("lines.csv");
  for (const HardScan& scan : hardScans()) {
    const std::string path = folder.file("scan.asc"), nominal = folder.file("nominal.stl");
    write(scan, path);
    const double wide = (scan.columns - 1) * scan.spacing_x, high = (scan.rows - 1) * scan.spacing_y;
    const std::string x = fmt::format("{}", wide), y = fmt::format("{}", high / 2.0);
    const std::string part = fmt::format("rectangle 0.35,0,{},{}", 0.5 + 0.5 * wide, 0.55 + 0.5 * high);
    const std::vector<std::string> section{"section", path, "--start", "0," + y, "--end", x + "," + y};
    const auto with = [](std::vector<std::string> line, const std::vector<std::string>& more) {
      line.insert(line.end(), more.begin(), more.end());
      return line;
    };
    const auto expect = [&](const std::vector<std::string>& line, const std::vector<std::string>& written) {
      expectNumbers(line, scan.name, written);
    };
    expect({"report", path, page}, {page});
    expect({"report", path, page, "--form", "poly2", "--robust", "--s-filter", "0.3", "--l-filter", "2"},
           {page});
    expect({"report", path, page, "--region", part}, {page});
    for (const std::vector<std::string>& how :
         std::vector<std::vector<std::string>>{{"--crop", "0.1,0,0.6,1"},
                                               {"--turn", "90", "--mirror", "x"},
                                               {"--angle", "30"},
                                               {"--to-spacing", "0.25", "--method", "area"},
                                               {"--to-spacing", "0.07,0.3", "--method", "cubic"}})
      expect(with({"transform", path, out}, how), {out});
    expect({"mosaic", path, path, out}, {out});
    expect({"mosaic", path, path, out, "--layout", "2x1", "--overlap", "50", "--moves", "shift"}, {out});
    expect({"convert", path, stl}, {stl});
    expect({"convert", path, stl, "--max-error", "0.01"}, {stl});
    std::filesystem::remove(nominal);
    if (fettle({"convert", path, nominal, "--unit", "mm"}).status == 0) {
      expect({"compare", path, nominal, "--tolerance", "0.1"}, {});
      expect({"compare", path, nominal, "--distance", "shortest", "--deviation", out}, {out});
      expect({"compare", path, nominal, "--region", part}, {});
      expect({"align", path, nominal, out, "--csv", csv}, {out, csv});
    }
    expect({"measure", path, "--region", part, "--csv", csv, "--surface", out}, {csv, out});
    expect({"measure", path, "--form", "cylinder", "--s-filter", "0.4", "--surface", out}, {out});
    expect({"measure", path, "--l-filter", "1.5", "--l-filter-kind", "spline", "--surface", out}, {out});
    expect({"level", path, out, "--region", part, "--form", "poly2"}, {out});
    expect({"level", path, session, "--layer", "put", "--region", part}, {session});
    expect({"level", path, out, "--through", "0.2,0.1:0.6,0.1:0.4,0.4"}, {out});
    expect({"compare", path, path, "--region", part, "--deviation", out}, {out});
    expect({"compare", path, path, "--align", "level", "--align-region", part}, {});
    expect({"align", path, path, out, "--region", part, "--csv", csv}, {out, csv});
    expect({"fit", path, "--region", part, "--shape", "plane", "--csv", csv, "--residuals", out}, {csv, out});
    expect({"features", path, "--region", part, "--csv", csv}, {csv});
    expect(with(section, {"--region", part, "--csv", csv}), {csv});
    expect(with(section, {"--cutoff", "0.8", "--lambda-s", "0.4"}), {});
    expect(with(section, {"--compare", path, "--groove", "auto"}), {});
    expect(with(section,
                {"--width", "0.5", "--cursors", "0.2,0.5", "--fit-line", "0.1,0.6", "--arc", "0.1,0.6"}),
           {});
    expect({"remove", path, out, "--region", part}, {out});
    expect({"mark", path, folder.file("marks.png"), "--edges", "--lines-out", lines}, {lines});
    for (const char* filter : {"gaussian", "median"})
      expect({"filter", path, out, "--filter", filter}, {out});
    for (const char* filter : {"areal-gaussian", "spline"})
      expect({"filter", path, out, "--filter", filter, "--cutoff", "0.5"}, {out});
  }
}

TEST(HardCases, WhatHasNoHeightHasNoFigure) {
  const TempFolder folder;
  const std::string path = folder.file("holes.asc");
  write(hardScans()[0], path);
  for (const char* json : {"", "--json"}) {
    std::vector<std::string> words{"compare", path, path, "--truth", path, "--unit", "mm"};
    if (*json != 0) words.emplace_back(json);
    const Outcome outcome = fettle(words);
    EXPECT_EQ(outcome.status, 2) << outcome.err;
    EXPECT_EQ(outcome.out, "");
    EXPECT_NE(outcome.err.find("nothing to compare, both scans have only holes"), std::string::npos)
        << outcome.err;
    EXPECT_NE(outcome.err.find("fettle fill"), std::string::npos) << outcome.err;
  }
}

}  // namespace
}  // namespace fettle::tests
