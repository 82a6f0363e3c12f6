// fettle level --layer, and what other commands make of a session with a form over it.

#include <cmath>
#include <filesystem>
#include <fstream>
#include <random>
#include <sstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "engine/formats/formats.h"
#include "tests/end_to_end/program.h"
#include "tests/support/temp_folder.h"

namespace fettle::tests {
namespace {

engine::Version fieldOf(const std::string& path) {
  engine::JobControl job;
  auto imported = engine::importField(path, {}, job);
  EXPECT_TRUE(imported) << path;
  return imported->field;
}

// A ball of 40 mm radius with a groove and some noise.
std::string ballGrid() {
  std::ostringstream text;
  text << "ncols 200\nnrows 160\nxllcorner 0\nyllcorner 0\ncellsize 0.1\n";
  std::mt19937 random(1);
  for (int r = 0; r < 160; ++r)
    for (int c = 0; c < 200; ++c) {
      const double x = 0.1 * c - 10.0, y = 0.1 * r - 8.0;
      const double noise = 1e-3 * (static_cast<double>(random()) * 0x1p-32 - 0.5);
      text << std::sqrt(1600.0 - x * x - y * y) + noise - (r > 60 && r < 64 ? 0.01 : 0.0)
           << (c < 199 ? ' ' : '\n');
    }
  return text.str();
}

std::string textOf(const std::string& path) {
  std::ostringstream text;
  text << std::ifstream(path, std::ios::binary).rdbuf();
  return text.str();
}

// Every row of a table, the heading too, ends so.
void expectRowsEnd(const std::string& path, const std::string& heading, const std::string& cells) {
  std::istringstream in(textOf(path));
  std::string line;
  ASSERT_TRUE(std::getline(in, line));
  EXPECT_TRUE(line.ends_with(heading)) << line;
  int rows = 0;
  for (; std::getline(in, line); ++rows) ASSERT_TRUE(line.ends_with(cells)) << line;
  EXPECT_GT(rows, 0) << path;
}

class Layer : public testing::Test {
 protected:
  void SetUp() override {
    // A tilted plate with steps and holes, far from its origin.
    runWhole({"synth", scan_, "--size", "150x100", "--noise", "0.002", "--dropouts", "0.01", "--seed", "4"});
    runWhole({"level", scan_, session_, "--layer", "put", "--form", "poly2"});
  }

  void runWhole(const std::vector<std::string>& arguments) {
    const Outcome outcome = fettle(arguments);
    ASSERT_EQ(outcome.status, 0) << outcome.err;
  }
  std::string file(const char* name) { return folder_.file(name); }

  const TempFolder folder_;
  const std::string scan_ = folder_.file("scan.tif");
  const std::string session_ = folder_.file("work.fettle");
};

TEST_F(Layer, GoesInAndOutAndChangesNoSample) {
  const std::uint64_t hash = engine::contentHash(fieldOf(scan_));
  EXPECT_NE(engine::contentHash(fieldOf(session_)), hash);
  EXPECT_EQ(fettleJson({"info", session_})["form"], "poly2");
  EXPECT_FALSE(fettleJson({"info", scan_}).contains("form"));
  const auto removed = fettleJson({"level", session_, file("back.fettle"), "--layer", "remove"});
  EXPECT_EQ(removed["form"], "poly2");
  EXPECT_EQ(engine::contentHash(fieldOf(file("back.fettle"))), hash);
  EXPECT_FALSE(fettleJson({"info", file("back.fettle")}).contains("form"));
  EXPECT_FALSE(fettleJson({"info", scan_}).contains("form_figures"));
  const auto put = fettleJson({"level", scan_, file("tilted.fettle"), "--layer", "put"});
  const auto figures = fettleJson({"info", file("tilted.fettle")})["form_figures"];
  EXPECT_EQ(figures["tilt_x"], put["tilt_x"]);
  EXPECT_EQ(figures["tilt_y"], put["tilt_y"]);
  runWhole({"level", scan_, file("mean.fettle"), "--layer", "put", "--form", "mean"});
  EXPECT_NEAR(fettleJson({"info", file("mean.fettle")})["form_figures"]["level"].get<double>(),
              fettleJson({"info", scan_})["mean"].get<double>(), 1e-6);
  // Another form instead, of the samples and not of what is seen.
  const auto again = fettleJson({"level", session_, file("plane.fettle"), "--layer", "put"});
  EXPECT_EQ(again["rms"], fettleJson({"level", scan_, file("plane.tif")})["rms"]);
  EXPECT_EQ(fettleJson({"info", file("plane.fettle")})["form"], "plane");
  // In another format the samples, with a word about it.
  const Outcome converted = fettle({"convert", session_, file("out.tif")});
  EXPECT_NE(converted.err.find("with the form"), std::string::npos) << converted.err;
  EXPECT_EQ(engine::contentHash(fieldOf(file("out.tif"))), hash);
}

// A sphere, a cylinder and a cone in place of the polynomial, over a part that has none of them: of the die's waves the robust
// fit is refused or not, but never anything else than exact in and out.
TEST_F(Layer, ShapesGoInAndOutAndChangeNoSample) {
  const std::uint64_t hash = engine::contentHash(fieldOf(scan_));
  std::ofstream(file("ball.asc")) << ballGrid();
  runWhole({"convert", file("ball.asc"), file("ball.tif"), "--unit", "mm"});
  const std::uint64_t ball = engine::contentHash(fieldOf(file("ball.tif")));
  EXPECT_NE(ball, hash);
  for (const char* form : {"sphere", "cylinder", "cone"}) {
    const Outcome put = fettle(
        {"level", file("ball.tif"), file("s.fettle"), "--layer", "put", "--form", form, "--force", "--json"});
    if (put.status != 0) {
      // A ball is no cylinder and no cone; the refusal says what is not determined, and where.
      EXPECT_EQ(put.status, 2) << put.err;
      EXPECT_NE(put.err.find("do not determine"), std::string::npos) << put.err;
      EXPECT_NE(form, std::string("sphere"));
      continue;
    }
    EXPECT_EQ(fettleJson({"info", file("s.fettle")})["form"], form);
    EXPECT_NE(engine::contentHash(fieldOf(file("s.fettle"))), ball);
    runWhole({"level", file("s.fettle"), file("back.fettle"), "--layer", "remove", "--force"});
    EXPECT_EQ(engine::contentHash(fieldOf(file("back.fettle"))), ball);
    runWhole({"convert", file("s.fettle"), file("back.tif")});
    EXPECT_EQ(engine::contentHash(fieldOf(file("back.tif"))), ball);
    runWhole({"level", file("s.fettle"), file("baked.tif"), "--layer", "bake"});
    runWhole({"level", file("ball.tif"), file("level.tif"), "--form", form});
    EXPECT_EQ(engine::contentHash(fieldOf(file("baked.tif"))),
              engine::contentHash(fieldOf(file("level.tif"))));
  }
  const auto level =
      fettleJson({"level", file("ball.tif"), file("level.tif"), "--form", "sphere", "--robust"});
  EXPECT_NEAR(level["radius_mm"].get<double>(), 40.0, 0.01);
  EXPECT_NEAR(level["point_mm"][0].get<double>(), 10.0, 0.01);
  EXPECT_EQ(level["hollow"], false);
  EXPECT_EQ(level["beyond"], 0);
  EXPECT_FALSE(level.contains("tilt_x"));
  // The session states at any time what was printed when the form was put over it.
  runWhole({"level", file("ball.tif"), file("s.fettle"), "--layer", "put", "--form", "sphere", "--robust",
            "--force"});
  const auto figures = fettleJson({"info", file("s.fettle")})["form_figures"];
  EXPECT_NEAR(figures["radius_mm"].get<double>(), level["radius_mm"].get<double>(), 1e-9);
  for (std::size_t k = 0; k < 3; ++k)
    EXPECT_NEAR(figures["point_mm"][k].get<double>(), level["point_mm"][k].get<double>(), 1e-9);
  EXPECT_EQ(figures["hollow"], false);
  EXPECT_NE(fettle({"info", file("s.fettle")}).out.find("sphere, radius 40"), std::string::npos);
  // As fettle fit has it.
  const auto fit = fettleJson({"fit", file("ball.tif"), "--shape", "sphere", "--robust"});
  EXPECT_EQ(fit["fits"][0]["radius_mm"], level["radius_mm"]);
  EXPECT_EQ(fettleJson({"measure", file("ball.tif"), "--form", "sphere", "--robust", "--only",
                        "height"})["radius_mm"],
            level["radius_mm"]);
  // A flat plate has no radius.
  runWhole({"synth", file("plate.tif"), "--part", "plate", "--size", "100x80"});
  const Outcome flat = fettle({"level", file("plate.tif"), file("x.tif"), "--form", "sphere"});
  EXPECT_EQ(flat.status, 2);
  EXPECT_NE(flat.err.find("the samples do not determine a radius, "), std::string::npos) << flat.err;
  EXPECT_FALSE(std::filesystem::exists(file("x.tif")));
}

TEST_F(Layer, BakedIsWhatLevelWrites) {
  runWhole({"level", scan_, file("level.tif"), "--form", "poly2"});
  const auto baked = fettleJson({"level", session_, file("baked.tif"), "--layer", "bake"});
  EXPECT_EQ(baked["form"], "poly2");
  EXPECT_EQ(engine::contentHash(fieldOf(file("baked.tif"))), engine::contentHash(fieldOf(file("level.tif"))));
  // What is seen is what is measured.
  const auto seen = fettleJson({"measure", session_, "--form", "none"});
  const auto level = fettleJson({"measure", file("level.tif"), "--form", "none"});
  for (const char* key : {"sq", "sa", "sz", "sdq", "sk"}) EXPECT_EQ(seen[key], level[key]) << key;
}

// Changes are limited from the scan, both without the form; samples that are not changed keep their bits.
TEST_F(Layer, AFilterChangesWhatIsSeenAndKeepsTheSamplesOfMarks) {
  const std::string marks = file("marks.png"), out = file("out.fettle"), tif = file("out.tif");
  runWhole({"mark", session_, marks, "--edges"});
  const auto done = fettleJson({"filter", session_, out, "--filter", "gaussian", "--sigma", "2", "--keep",
                                marks, "--max-change", "3um"});
  EXPECT_EQ(fettleJson({"info", out})["form"], "poly2");
  runWhole({"convert", out, tif});
  const engine::Version before = fieldOf(scan_), after = fieldOf(tif);
  engine::JobControl job;
  const engine::Version marked = fieldOf(out), seen = fieldOf(session_);
  std::int64_t kept = 0, changed = 0;
  for (int r = 0; r < 100; ++r)
    for (int c = 0; c < 150; ++c) {
      const float a = before.reader().heightAt(c, r), b = after.reader().heightAt(c, r);
      ASSERT_EQ(std::isnan(a), std::isnan(b));
      if (std::isnan(a)) continue;
      // The limit, and what two heights are rounded by as they are seen, and two as they are stored.
      constexpr double kHalfUnit = 0x1p-24;
      ASSERT_LE(std::abs(double{a} - b),
                0.003 + 2.0 * kHalfUnit * (std::abs(a) + std::abs(seen.reader().heightAt(c, r)) + 0.006));
      if (marked.reader().markedAt(c, r)) {
        ASSERT_EQ(a, b);
        ++kept;
      }
      changed += a != b ? 1 : 0;
    }
  EXPECT_GT(kept, 100);
  EXPECT_GT(changed, 5000);
  EXPECT_EQ(done["hash"], fettleJson({"level", out, file("o2.fettle"), "--layer", "remove"})["hash"]);
  // Deviation means the samples: nothing is said of the form.
  EXPECT_LT(fettleJson({"compare", scan_, out})["max_abs"].get<double>(), 0.00301);
}

// Touch: what is felt has no form; the sample under the brush alone is another one.
TEST_F(Layer, StrokesAreFeltWithoutTheForm) {
  const engine::Version seen = fieldOf(session_);
  const engine::Grid& grid = seen.grid();
  std::ofstream strokes(file("s.csv"));
  strokes << "t,x,y,z,tool\n";
  strokes.precision(17);
  const int c = 40, r = 30;
  ASSERT_FALSE(std::isnan(seen.reader().heightAt(c, r)));
  for (int k = 0; k < 200; ++k)
    strokes << k * 1e-3 << ',' << (c + 0.5) * grid.spacingXMm() << ',' << (r + 0.5) * grid.spacingYMm() << ','
            << seen.reader().heightAt(c, r) * grid.height_unit.mm + 2.0 - 0.02 * k << ",smooth\n";
  strokes.close();
  const auto report = fettleJson({"replay", session_, file("s.csv"), file("out.fettle")});
  EXPECT_GT(report["contact_ticks"], 20);
  EXPECT_GT(report["samples_changed"], 0);
  runWhole({"convert", file("out.fettle"), file("out.tif")});
  const engine::Version before = fieldOf(scan_), after = fieldOf(file("out.tif"));
  std::int64_t changed = 0;
  for (int row = 0; row < 100; ++row)
    for (int column = 0; column < 150; ++column) {
      const float a = before.reader().heightAt(column, row), b = after.reader().heightAt(column, row);
      changed += a != b && !std::isnan(a) ? 1 : 0;
    }
  EXPECT_LE(changed, report["samples_changed"].get<std::int64_t>());
  EXPECT_GT(changed, 0);
}

TEST_F(Layer, FilledSamplesLieOnWhatIsSeenAndStayKnown) {
  const auto filled = fettleJson({"fill", session_, file("full.fettle")});
  EXPECT_GT(filled["filled"], 0);
  EXPECT_EQ(fettleJson({"info", file("full.fettle")})["filled"], filled["filled"]);
  const auto compared = fettleJson({"compare", scan_, file("full.fettle")});
  EXPECT_EQ(compared["max_abs"], 0.0);
  EXPECT_EQ(compared["only_b"], filled["filled"]);
}

// Heights of two files, `bound` apart at most; holes at the same places.
void expectHeights(const std::string& path_a, const std::string& path_b, double bound) {
  const engine::Version a = fieldOf(path_a), b = fieldOf(path_b);
  ASSERT_EQ(a.grid().width, b.grid().width);
  ASSERT_EQ(a.grid().height, b.grid().height);
  for (int r = 0; r < a.grid().height; ++r)
    for (int c = 0; c < a.grid().width; ++c) {
      const float x = a.reader().heightAt(c, r), y = b.reader().heightAt(c, r);
      ASSERT_EQ(std::isnan(x), std::isnan(y)) << c << ' ' << r;
      if (!std::isnan(x)) {
        ASSERT_NEAR(x, y, bound) << c << ' ' << r;
      }
    }
}

// What is levelled and then transformed, and what is transformed and then levelled by the form that went along, are one.
TEST_F(Layer, GoesAlongWithATransform) {
  runWhole({"level", session_, file("level.tif"), "--layer", "bake"});
  const std::vector<std::vector<std::string>> moves = {{"--crop-samples", "10,20,60,90"},
                                                       {"--turn", "90"},
                                                       {"--mirror", "x", "--crop", "1,1,4,3"},
                                                       {"--angle", "20"},
                                                       {"--to-spacing", "0.13mm"}};
  for (const std::vector<std::string>& move : moves) {
    SCOPED_TRACE(move.front());
    const auto run = [&](const std::string& in, const char* out) {
      std::vector<std::string> words{"transform", in, file(out), "--force"};
      words.insert(words.end(), move.begin(), move.end());
      const Outcome outcome = fettle(words);
      ASSERT_EQ(outcome.status, 0) << outcome.err;
      EXPECT_EQ(outcome.err.find("form"), std::string::npos) << outcome.err;
    };
    run(session_, "t.fettle");
    run(file("level.tif"), "level_t.tif");
    EXPECT_EQ(fettleJson({"info", file("t.fettle")})["form"], "poly2");
    // Heights of some mm, rounded to float twice.
    expectHeights(file("t.fettle"), file("level_t.tif"), 1e-6);
    if (move.front() == "--angle" || move.front() == "--to-spacing") continue;
    // Where no height is made, the samples are those of the scan, bit by bit, and the session begins with them.
    run(scan_, "t.tif");
    runWhole({"level", file("t.fettle"), file("back.fettle"), "--layer", "remove", "--force"});
    EXPECT_EQ(engine::contentHash(fieldOf(file("back.fettle"))), engine::contentHash(fieldOf(file("t.tif"))));
  }
  // A recipe does the same.
  std::ofstream(file("turn.toml"))
      << "recipe = 1\n[[step]]\ndo = \"form\"\nlayer = \"put\"\nform = \"poly2\"\n"
         "[[step]]\ndo = \"transform\"\nturn = 90\n";
  runWhole({"apply", file("turn.toml"), scan_, file("applied.fettle")});
  runWhole({"transform", session_, file("turned.fettle"), "--turn", "90"});
  EXPECT_EQ(fettleJson({"info", file("applied.fettle")})["form"], "poly2");
  EXPECT_EQ(engine::contentHash(fieldOf(file("applied.fettle"))),
            engine::contentHash(fieldOf(file("turned.fettle"))));
}

TEST_F(Layer, GoesAlongWithAnAlignment) {
  const auto lifted = [&](const char* out) {
    const Outcome moved = fettle({"align", scan_, session_, file(out), "--moves", "level"});
    EXPECT_EQ(moved.status, 0) << moved.err;
    return moved.err;
  };
  EXPECT_EQ(lifted("moved.fettle").find("form"), std::string::npos);
  EXPECT_EQ(fettleJson({"info", file("moved.fettle")})["form"], "poly2");
  // The scan lies on itself: what is seen is what was seen, by a motion of its error.
  runWhole({"level", session_, file("level.tif"), "--layer", "bake"});
  expectHeights(file("moved.fettle"), file("level.tif"), 2e-3);
  EXPECT_NE(lifted("moved.tif").find("written with the form"), std::string::npos);
  const Outcome alone = fettle({"align", scan_, session_, "--moves", "level"});
  EXPECT_NE(alone.err.find("heights are taken with the form"), std::string::npos) << alone.err;
}

TEST_F(Layer, OfPiecesLiesOverTheirMosaic) {
  runWhole({"synth", file("one.tif"), "--size", "200x150", "--noise", "0.002", "--seed", "4"});
  runWhole({"level", file("one.tif"), file("one.fettle"), "--layer", "put", "--form", "poly3"});
  runWhole({"transform", file("one.fettle"), file("west.fettle"), "--crop-samples", "0,0,150,130"});
  runWhole({"transform", file("one.fettle"), file("east.fettle"), "--crop-samples", "0,70,150,130"});
  const Outcome joined = fettle({"mosaic", file("west.fettle"), file("east.fettle"), file("both.fettle")});
  ASSERT_EQ(joined.status, 0) << joined.err;
  EXPECT_EQ(joined.err.find("form"), std::string::npos) << joined.err;
  EXPECT_EQ(fettleJson({"info", file("both.fettle")})["form"], "poly3");
  // Another form over one of them, or none: the heights, and what to do.
  runWhole({"level", file("east.fettle"), file("other.fettle"), "--layer", "put", "--form", "plane"});
  runWhole({"level", file("east.fettle"), file("none.fettle"), "--layer", "remove"});
  for (const char* second : {"other.fettle", "none.fettle"}) {
    const Outcome without =
        fettle({"mosaic", file("west.fettle"), file(second), file("both.fettle"), "--force"});
    ASSERT_EQ(without.status, 0) << without.err;
    EXPECT_NE(without.err.find("put one over it (fettle level --layer put)"), std::string::npos)
        << without.err;
    EXPECT_FALSE(fettleJson({"info", file("both.fettle")}).contains("form"));
  }
}

// Who has a figure must see that it is of what is left when the form is taken out.
TEST_F(Layer, FiguresSayThatAFormLiesOverTheScan) {
  const std::string said = "without the form poly2 that lies over the scan";
  const std::vector<std::vector<std::string>> commands = {
      {"measure", "--only", "height", "--noise-trials", "0", "--csv"},
      {"features", "--csv"},
      {"fit", "--shape", "plane", "--csv"},
      {"section", "--start", "1,1", "--end", "4,1", "--csv"}};
  for (const std::vector<std::string>& command : commands) {
    SCOPED_TRACE(command.front());
    for (const bool layered : {true, false}) {
      std::vector<std::string> arguments = command;
      arguments.insert(arguments.begin() + 1, layered ? session_ : scan_);
      const std::string table = file((command.front() + (layered ? "_layer.csv" : ".csv")).c_str());
      arguments.push_back(table);
      const Outcome text = fettle(arguments);
      ASSERT_EQ(text.status, 0) << text.err;
      EXPECT_EQ(text.out.find(said) != std::string::npos, layered) << text.out;
      arguments = command;
      arguments.pop_back();  // --csv
      arguments.insert(arguments.begin() + 1, layered ? session_ : scan_);
      const auto report = fettleJson(arguments);
      EXPECT_EQ(report.contains("layer"), layered);
      if (layered) {
        EXPECT_EQ(report["layer"], "poly2");
      }
      expectRowsEnd(table, ",layer", layered ? ",poly2" : ",");
    }
  }
}

TEST_F(Layer, ASectionStatesWhatLiesOverBothScansAndItsInterpolation) {
  for (const std::string how : {"bilinear", "nearest"}) {
    const std::string csv = file("s.csv"), plot = file("s.svg");
    std::vector<std::string> arguments = {
        "section", scan_,   "--compare", session_,  "--start",         "1,1", "--end",
        "4,1",     "--csv", csv,         "--force", "--interpolation", how};
    const auto report = fettleJson(arguments);
    EXPECT_EQ(report["interpolation"], how);
    EXPECT_FALSE(report.contains("layer"));
    EXPECT_EQ(report["other_layer"], "poly2");
    expectRowsEnd(csv, ",interpolation,layer,other_layer", "," + how + ",,poly2");
    arguments.insert(arguments.end(), {"--plot", plot});
    const Outcome text = fettle(arguments);
    ASSERT_EQ(text.status, 0) << text.err;
    const std::string said = how + " between samples, without the form poly2 that lies over the other scan";
    EXPECT_NE(text.out.find("heights " + said), std::string::npos) << text.out;
    EXPECT_NE(textOf(plot).find(said), std::string::npos);
  }
}

TEST_F(Layer, AReportStatesItInItsTablesAndCaptions) {
  const std::string page = file("page.html");
  const auto report = fettleJson({"report", session_, page, "--noise-trials", "0", "--section", "1,1:4,1"});
  EXPECT_EQ(report["layer"], "poly2");
  const std::string html = textOf(page);
  for (const char* said :
       {"Form over the scan, left out of all figures", "; without the form poly2 that lies over the scan.",
        "long, bilinear between samples, without the form poly2 that lies over the scan"})
    EXPECT_NE(html.find(said), std::string::npos) << said;
}

TEST_F(Layer, WhatHasNoEffectIsRefused) {
  const std::string out = file("never.fettle");
  const auto refused = [&](const std::vector<std::string>& arguments, const char* what) {
    const Outcome outcome = fettle(arguments);
    EXPECT_EQ(outcome.status, 2) << what;
    EXPECT_NE(outcome.err.find(what), std::string::npos) << outcome.err;
    EXPECT_FALSE(std::filesystem::exists(out));
  };
  refused({"level", scan_, file("x.tif"), "--layer", "put"}, "only a session stores");
  refused({"level", session_, file("x.tif"), "--layer", "remove"}, "only a session stores");
  refused({"level", scan_, out, "--layer", "bake"}, "no form lies over the scan");
  refused({"level", scan_, out, "--layer", "remove"}, "no form lies over the scan");
  refused({"level", scan_, out, "--layer", "put", "--form", "none"}, "no form to lay over");
  refused({"level", scan_, out, "--layer", "put", "--rows", "median"}, "--rows");
  refused({"level", session_, out, "--layer", "bake", "--robust"}, "--robust");
  refused({"level", session_, out, "--layer", "remove", "--form", "poly3"}, "--form");
  refused({"level", session_, out, "--layer", "remove", "--region", "marked"}, "--region");
  refused({"level", session_, out, "--layer", "off"}, "--layer");
  EXPECT_FALSE(std::filesystem::exists(file("x.tif")));
}

TEST_F(Layer, ASessionGoesToStandardOutput) {
  const Outcome put = fettle({"level", scan_, "-", "--layer", "put", "--to", "fettle"});
  ASSERT_EQ(put.status, 0) << put.err;
  std::ofstream(file("piped.fettle"), std::ios::binary) << put.out;
  EXPECT_EQ(fettleJson({"info", file("piped.fettle")})["form"], "plane");
  const Outcome filled = fettle({"fill", scan_, "-", "--to", "fettle"});
  EXPECT_EQ(filled.err.find("only a session stores"), std::string::npos) << filled.err;
}

}  // namespace
}  // namespace fettle::tests
