// fettle remove, as a user types it.

#include <cstdint>
#include <fstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "app/work/height_tool.h"
#include "engine/field/builder.h"
#include "engine/fill/fill.h"
#include "engine/formats/formats.h"
#include "engine/io/raster/marks.h"
#include "engine/remove/remove.h"
#include "engine/session/session.h"
#include "tests/end_to_end/program.h"
#include "tests/support/temp_folder.h"

namespace fettle::tests {
namespace {

constexpr int kWide = 60, kHigh = 50;

// A part of height 1 to 2.475 mm on a table at -0.5, with three samples of 9 and one hole. ESRI ASCII.
void writePartOnTable(const std::string& path) {
  std::ofstream out(path);
  out << "ncols 60\nnrows 50\nxllcenter 0\nyllcenter 0\ncellsize 0.5\nNODATA_value -9999\n";
  for (int r = kHigh - 1; r >= 0; --r) {
    for (int c = 0; c < kWide; ++c) {
      const bool part = c >= 20 && c < 40 && r >= 10 && r < 40;
      const double height = c < 3 && r == 0      ? 9.0
                            : c == 30 && r == 20 ? -9999.0
                            : part               ? 1.0 + 0.025 * c
                                                 : -0.5;
      out << height << ' ';
    }
    out << '\n';
  }
}
constexpr int kPart = 20 * 30 - 1, kSpikes = 3, kHoles = 1, kTable = kWide * kHigh - kPart - kSpikes - kHoles;

// The lower left corner of so many samples is marked.
std::string writeMarks(const TempFolder& folder, int columns, int rows) {
  const std::string path = folder.file("marks.png");
  engine::Grid grid;
  grid.width = kWide;
  grid.height = kHigh;
  std::vector<std::uint8_t> marks;
  for (int r = 0; r < kHigh; ++r)
    for (int c = 0; c < kWide; ++c) marks.push_back(c < columns && r < rows ? 1 : 0);
  EXPECT_TRUE(engine::exportMarks(engine::makeField(grid, std::vector<float>(marks.size()), marks), path));
  return path;
}

TEST(RemoveCommand, MakesHolesBelowAboveBetweenAndOutsideHeights) {
  const TempFolder folder;
  const std::string scan = folder.file("s.asc"), out = folder.file("o.tif");
  writePartOnTable(scan);
  const auto run = [&](std::vector<std::string> more) {
    std::vector<std::string> line{"remove", scan, out, "--unit", "mm"};
    line.insert(line.end(), more.begin(), more.end());
    return fettleJson(line);
  };
  const auto table = run({"--below", "-100um"});
  EXPECT_EQ(table["removed"], kTable);
  EXPECT_EQ(table["no_data"], kTable + kHoles);
  const auto info = fettleJson({"info", out, "--at", "20,20", "--at", "5,5"});
  EXPECT_EQ(info["at"][0]["height"], 1.5);
  EXPECT_TRUE(info["at"][1]["height"].is_null());
  EXPECT_EQ(run({"--above", "3"})["removed"], kSpikes);
  EXPECT_EQ(run({"--below", "0", "--above", "3"})["removed"], kTable + kSpikes);
  EXPECT_EQ(run({"--between", "-0.5,-0.5"})["removed"], kTable);
  EXPECT_EQ(run({"--between=-1mm,5mm"})["removed"], kTable + kPart);
}

TEST(RemoveCommand, MarkedSamplesStayUnlessTheyAreNamed) {
  const TempFolder folder;
  const std::string scan = folder.file("s.asc"), out = folder.file("o.fettle");
  writePartOnTable(scan);
  const std::string marks = writeMarks(folder, 10, 10);
  const auto run = [&](std::vector<std::string> more) {
    std::vector<std::string> line{"remove", scan, out, "--unit", "mm", "--force", "--marks", marks};
    line.insert(line.end(), more.begin(), more.end());
    return fettleJson(line);
  };
  const auto low = run({"--below", "0"});
  EXPECT_EQ(low["removed"], kTable - (100 - kSpikes));
  EXPECT_EQ(low["spared"], 100 - kSpikes);
  const auto markedIn = [&](const std::string& session) {
    return fettleJson({"remove", session, folder.file("m.tif"), "--region", "marked"})["removed"];
  };
  EXPECT_EQ(markedIn(out), 100);
  const auto marked = run({"--region", "marked"});
  EXPECT_EQ(marked["removed"], 100);
  EXPECT_EQ(markedIn(out), 0) << "nothing is left that a mark would protect";
  // The holes are filled like others.
  EXPECT_EQ(fettleJson({"fill", out, folder.file("f.tif"), "--border"})["no_data"], 0);
  EXPECT_EQ(run({"--region", "unmarked"})["no_data"], kWide * kHigh - 100) << "all but what is marked";
  EXPECT_EQ(run({"--region", "all", "--below", "0"})["removed"], kTable);
}

// Wherever a session says what was measured: what was removed and filled was not.
void expectFilled(const TempFolder& folder, const std::string& session, int filled) {
  EXPECT_EQ(fettleJson({"info", session})["filled"], filled);
  const std::string marks = folder.file("filled.png");
  EXPECT_EQ(fettleJson({"mark", session, marks, "--filled"})["marked"], filled);
  EXPECT_EQ(fettleJson({"measure", session, "--only", "height", "--noise-trials", "0", "--region",
                        "measured"})["samples"],
            kWide * kHigh - filled);
}

TEST(RemoveCommand, WhatIsFilledAfterwardsCountsAsFilled) {
  const TempFolder folder;
  const std::string scan = folder.file("s.asc"), removed = folder.file("r.fettle"),
                    filled = folder.file("f.fettle"), smooth = folder.file("m.fettle");
  writePartOnTable(scan);
  ASSERT_EQ(fettleJson({"remove", scan, removed, "--unit", "mm", "--above", "3"})["removed"], kSpikes);
  EXPECT_EQ(fettleJson({"info", removed})["filled"], 0);
  ASSERT_EQ(fettleJson({"fill", removed, filled, "--border"})["filled"], kSpikes + kHoles);
  expectFilled(folder, filled, kSpikes + kHoles);
  ASSERT_EQ(fettle({"filter", filled, smooth, "--filter", "gaussian", "--sigma", "1"}).status, 0);
  expectFilled(folder, smooth, kSpikes + kHoles);
  // A recipe does the same.
  std::ofstream(folder.file("r.toml")) << fettle({"recipe", filled}).out;
  ASSERT_EQ(fettle({"apply", folder.file("r.toml"), scan, folder.file("a.fettle"), "--unit", "mm"}).status,
            0);
  expectFilled(folder, folder.file("a.fettle"), kSpikes + kHoles);
}

// The window's session has both as steps, and its scan as it was.
TEST(RemoveCommand, WhatTheWindowRemovedAndFilledCountsAsFilled) {
  const TempFolder folder;
  const std::string scan = folder.file("s.asc"), file = folder.file("w.fettle");
  writePartOnTable(scan);
  engine::JobControl job;
  engine::ImportOptions reading;
  reading.unit = engine::LengthUnit{};
  const auto imported = engine::importField(scan, reading, job);
  ASSERT_TRUE(imported);
  engine::RemoveOptions high;
  high.heights = engine::RemoveOptions::Heights::kOutside;
  high.high = 3.0;
  const auto removed = engine::removeSamples(imported->field, high, job);
  ASSERT_TRUE(removed);
  engine::FillOptions fill;
  fill.at_border = true;
  const auto filled = engine::fillHoles(removed->field, fill, job);
  ASSERT_TRUE(filled);
  for (const bool by_commands : {false, true}) {
    SCOPED_TRACE(by_commands);
    engine::Session session;
    session.original = imported->field;
    session.history = engine::History(session.original);
    const auto step = [&](const std::string& name, engine::StepKind kind, const engine::Version& after) {
      session.history.push({name, kind, engine::stepTimeNow(), {}, 0}, after);
    };
    if (by_commands)
      step(engine::kByCommands, engine::StepKind::kImport, removed->field);
    else
      step(app::makerName(high, imported->field), engine::StepKind::kFilter, removed->field);
    step(app::makerName(fill, imported->field), engine::StepKind::kFilter, filled->field);
    // A later step: the removal is none of the last two.
    step("Invert", engine::StepKind::kInvert, filled->field.inverted());
    ASSERT_TRUE(engine::saveSession(session, file, job));
    expectFilled(folder, file, kSpikes + kHoles);
  }
}

TEST(RemoveCommand, SaysWhatItCannotDo) {
  const TempFolder folder;
  const std::string scan = folder.file("s.asc"), out = folder.file("o.tif");
  writePartOnTable(scan);
  const auto refused = [&](std::vector<std::string> more, const std::string& names) {
    std::vector<std::string> line{"remove", scan, out, "--unit", "mm"};
    line.insert(line.end(), more.begin(), more.end());
    expectRefused(fettle(line), names);
  };
  refused({}, "--below");
  refused({"--below", "low"}, "--below");
  refused({"--below", "nan"}, "--below");
  refused({"--below", "3", "--above", "2"}, "--below, --above");
  refused({"--between", "3,2"}, "--between");
  refused({"--between", "3"}, "--between");
  refused({"--between", "1,2", "--below", "0"}, "--between");
  refused({"--below", "100"}, "every sample");
  refused({"--region", "all"}, "every sample");
  const Outcome none = fettle({"remove", scan, out, "--unit", "mm", "--above", "10"});
  EXPECT_EQ(none.status, 0) << none.err;
  EXPECT_NE(none.err.find("no sample is removed: none has such a height"), std::string::npos) << none.err;
  EXPECT_EQ(fettleJson({"compare", scan, out, "--unit", "mm"})["max_abs"], 0.0);
  const Outcome unmarked = fettle({"remove", scan, out, "--unit", "mm", "--region", "marked"});
  EXPECT_NE(unmarked.err.find("none is marked"), std::string::npos) << unmarked.err;
}

// The recipe of a session repeats it, with the bits of the command.
TEST(RemoveCommand, IsAStepOfARecipe) {
  const TempFolder folder;
  const std::string scan = folder.file("s.asc"), session = folder.file("o.fettle");
  const std::string recipe = folder.file("r.toml");
  writePartOnTable(scan);
  const auto command =
      fettleJson({"remove", scan, session, "--unit", "mm", "--below", "-0.1mm", "--above", "3"});
  const Outcome printed = fettle({"recipe", session});
  ASSERT_EQ(printed.status, 0) << printed.err;
  EXPECT_NE(printed.out.find("do = \"remove\"\nbelow = \"-0.1mm\"\nabove = 3\n"), std::string::npos)
      << printed.out;
  std::ofstream(recipe) << printed.out;
  const auto applied = fettleJson({"apply", recipe, scan, folder.file("a.tif"), "--unit", "mm"});
  EXPECT_EQ(applied["hash"], command["hash"]);
  EXPECT_EQ(applied["steps"][0]["removed"], kTable + kSpikes);
  for (const char* wrong :
       {"between = [1]", "between = [2, 1]", "below = 3\nabove = 1", "region = \"some\"", "", "low = 1"}) {
    std::ofstream(recipe) << "recipe = 1\n[[step]]\ndo = \"remove\"\n" << wrong << "\n";
    EXPECT_EQ(fettle({"apply", recipe, scan, folder.file("a.tif"), "--unit", "mm"}).status, 2) << wrong;
  }
}

}  // namespace
}  // namespace fettle::tests
