// Every object of --json is as its schema states: no key that the schema lacks, none that it promises missing.

#include <filesystem>
#include <fstream>
#include <functional>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tests/end_to_end/program.h"
#include "tests/end_to_end/report_check.h"
#include "tests/support/source_tree.h"
#include "tests/support/temp_folder.h"

namespace fettle::tests {
namespace {

using Words = std::vector<std::string>;

class Schemas : public testing::Test {
 protected:
  // The report of a run, which is held against its schema; one of several scans may fail.
  nlohmann::json run(Words arguments, int status = 0) {
    arguments.emplace_back("--json");
    const Outcome outcome = fettle(arguments);
    EXPECT_EQ(outcome.status, status) << arguments[0] << ' ' << outcome.err;
    const auto report = nlohmann::json::parse(outcome.out, nullptr, false);
    EXPECT_EQ(problemOf(report), "") << arguments[0];
    if (report.contains("schema")) seen_.insert(report["schema"].get<std::string>());
    return report;
  }
  [[nodiscard]] std::string file(const std::string& name) const { return folder_.file(name); }

  TempFolder folder_;
  std::set<std::string> seen_;  // the schemas of all runs so far
};

TEST_F(Schemas, EveryCommandPrintsWhatItsSchemaStates) {
  const std::string scan = file("s.tif"), out = file("o.tif"), lines = file("l.csv"), marks = file("m.png");
  run({"synth", scan, "--size", "128x96", "--truth", file("t.tif"), "--edges", file("e.png")});
  run({"info", scan, "--at", "3,4"});
  run({"info", scan, file("none.tif")}, 1);
  run({"filter", scan, out, "--filter", "tgv"});
  run({"filter", scan, file("none.tif"), "--filter", "median", "--out-dir", file("d")}, 1);
  run({"filter", scan, out, "--filter", "tgv", "--estimate"});
  run({"convert", scan, file("none.stl"), "--estimate"});
  run({"features", scan, "--labels", file("none.tif"), "--estimate"});
  run({"compare", scan, out, "--estimate"});
  run({"mark", scan, file("none.png"), "--edges", "--estimate"});
  run({"filter", scan, "--suggest", "--tolerance", "15um", "--estimate"});
  run({"level", scan, file("level.tif"), "--robust"});
  run({"level", scan, file("level.tif"), "--rows", "median", "--form", "none"});
  run({"level", scan, file("level.tif"), "--rows", "median", "--keep-form", "3"});
  run({"level", scan, file("layer.fettle"), "--layer", "put"});
  run({"info", file("layer.fettle")});
  run({"level", file("layer.fettle"), file("level.tif"), "--layer", "bake"});
  run({"plan", "convert", scan, file("shared.tif"), "--shards", "1"});
  run({"convert", scan, file("shared.tif"), "--shard", "1"});
  run({"gather", file("shared.tif")});
  run({"plan", "filter", scan, file("shared.tif"), "--filter", "tgv", "--shards", "1", "--result", "files"});
  run({"status", file("shared.tif")});
  run({"filter", scan, file("shared.tif"), "--filter", "tgv", "--shard", "1"});
  run({"submit", file("shared.tif"), "--engine", "slurm"});
  run({"filter", scan, file("turn.tif"), "--filter", "box", "--shards-in-turn"});
  run({"synth", file("die.tif"), "--part", "die", "--size", "96x80"});
  run({"level", file("die.tif"), file("level.tif"), "--form", "sphere"});
  run({"measure", file("die.tif"), "--form", "sphere", "--only", "height"});
  run({"measure", scan, "--form", "poly2", "--at-height", "0,1um", "--at-ratio", "50"});
  run({"measure", scan, "--only", "hybrid", "--s-filter", "3", "--l-filter", "20"});
  run({"fill", scan, file("full.fettle"), "--border"});
  run({"remove", scan, file("fewer.tif"), "--below", "0"});
  run({"info", file("full.fettle")});
  run({"measure", file("full.fettle"), "--only", "hybrid", "--region", "measured"});
  run({"transform", scan, file("turned.tif"), "--turn", "90", "--crop", "0,0,9,9"});
  run({"transform", scan, file("turned.tif"), "--angle", "12", "--method", "linear"});
  run({"report", out, file("r.html"), "--original", scan});
  run({"measure", scan, file("none.tif")}, 1);
  run({"section",   scan,       "--start",    "1,1",   "--end",    "60,50", "--compare", out,
       "--cursors", "1,9",      "--fit-line", "1,9",   "--step",   "auto",  "--groove",  "auto",
       "--angle",   "1,6,8,14", "--arc",      "30,50", "--cutoff", "8",     "--probe",   "5,5"});
  run({"features", scan, "--csv", file("features.csv")});
  run({"fit", scan, "--at", "1,1", "--at", "60,50", "--shape", "plane", "--robust", "--between", "1,2",
       "--csv", file("fits.csv"), "--step", file("fits.step"), "--residuals", file("residuals.tif")});
  run({"align", scan, out, file("moved.tif"), "--moves", "level", "--csv", file("motion.csv")});
  run({"compare", scan, out, "--align", "level"});
  run({"convert", scan, file("n.stl")});
  run({"compare", scan, file("n.stl"), "--tolerance", "1um", "--deviation", file("nd.tif")});
  run({"compare", scan, file("n.stl"), "--align", "level"});
  run({"align", scan, file("n.stl"), file("moved.tif"), "--moves", "level"});
  run({"transform", scan, file("west.tif"), "--crop-samples", "0,0,80,64"});
  run({"transform", scan, file("east.tif"), "--crop-samples", "0,32,80,64"});
  run({"mosaic", file("west.tif"), file("east.tif"), file("both.tif"), "--moves", "level", "--within", "0"});
  run({"filter", scan, "--suggest", "--tolerance", "15um", "--places", "1"});
  run({"mark", scan, marks, "--edges", "--lines-out", lines});
  run({"lines", scan, lines});
  run({"convert", scan, file("s.asc")});
  run({"compare", scan, out, "--truth", file("t.tif"), "--edges", file("e.png"), "--deviation",
       file("d.tif")});
  std::ofstream(file("c.toml"))
      << "recipe = 1\n[[step]]\ndo = \"mark_edges\"\n[[step]]\ndo = \"locate_edges\"\n"
         "[[step]]\ndo = \"invert\"\n[[step]]\ndo = \"filter\"\nfilter = \"tv\"\n";
  run({"apply", file("c.toml"), scan, out});
  std::ofstream(file("form.toml"))
      << "recipe = 1\n[[step]]\ndo = \"form\"\nlayer = \"put\"\nform = \"sphere\"\n"
         "[[step]]\ndo = \"form\"\nlayer = \"bake\"\n";
  run({"apply", file("form.toml"), file("die.tif"), out});
  run({"apply", file("c.toml"), scan, file("none.tif"), "--estimate"});
  run({"render", scan, file("p.png"), "--size", "64x64"});
  run({"devices"});
  run({"reference", file("r")});
  const std::string session = file("j.fettle");
  std::filesystem::copy_file(inSourceTree("tests/haptic/journal/sessions/contact_revision_1.fettle"),
                             session);
  run({"journal", session});
  run({"replay", session, file("j.tif")});
  run({"replay", session, file("none.tif"), "--estimate"});
  run({"demo", file("demo"), "--side", "256"});
  run({"replay", file("demo/scan.tif"), file("demo/strokes.csv"), out, "--certify"});
  run({"replay", file("demo/scan.tif"), file("demo/strokes.csv"), file("none.tif"), "--estimate"});
  run({"record", scan, file("rec.csv"), "--device", "hand:" + file("demo/strokes.csv"), "--seconds", "0.5"});
  run({"accuracy", file("a"), "--only", "energy", "--effort", "0.01"});
  run({"bench", "haptic", "--side", "64", "--ticks", "10", "--repeats", "1"});
  run({"bench", "effects", "--side", "64", "--ticks", "1000", "--repeats", "1"});
  run({"bench", "loop", "--seconds", "0.1"});
  run({"bench", "stability", "--rates", "1000"});
  run({"bench", "growth", "--largest", "256", "--effort", "0.01", "--no-picture"});
  run({"bench", "large", "--side", "256", "--effort", "0.01", "--no-picture", "--folder", file("")});
  run({"bench", "import", "--side", "16", "--repeats", "1"});
  run({"bench", "fill", "--side", "512", "--repeats", "1"});
  run({"bench", "previews", "--side", "256", "--kind", "median"});
  run({"bench", "measure", "--side", "512", "--repeats", "1"});
  run({"bench", "estimate", "--side", "256", "--kind", "box", "--threads", "1", "--repeats", "1"});
  run({"bench", "filters", "--side", "64", "--kind", "box", "--window", "3", "--ground", "plain", "--repeats",
       "1"});
  run({"bench", "render", "--side", "64", "--frames", "10", "--loop", "0.5", "--scene", "moving"});

  run({"--version"});

  std::set<std::string> expected = schemaNames();
  expected.erase("fettle.error/1");   // below
  expected.erase("fettle.view/1");    // tests/end_to_end/window
  expected.erase("fettle.recipe/1");  // recipe_test.cpp
  EXPECT_EQ(seen_, expected);
  // And every command has one.
  const auto tables = nlohmann::json::parse(std::ifstream(file("r/parameters.json")));
  std::set<std::string> commands;
  const std::function<void(const nlohmann::json&)> visit = [&](const nlohmann::json& command) {
    for (const auto& below : command["commands"]) visit(below);
    std::string path = command["path"].get<std::string>();
    for (char& c : path)
      if (c == ' ') c = '.';
    if (command["commands"].empty() && path != "fettle.help") commands.insert(path + "/1");
  };
  visit(tables["program"]);
  commands.insert("fettle.error/1");
  commands.insert("fettle.version/1");
  EXPECT_EQ(commands, schemaNames());
}

TEST_F(Schemas, AnErrorIsAsItsSchemaStates) {
  for (const Words& arguments :
       {Words{"info", file("none.tif")}, {"fitler"}, {"filter", "--nope"}, {"info", ""}}) {
    Words all = arguments;
    all.emplace_back("--json");
    const Outcome outcome = fettle(all);
    const auto object = nlohmann::json::parse(outcome.err, nullptr, false);
    EXPECT_EQ(object["schema"], "fettle.error/1");
    EXPECT_EQ(problemOf(object), "");
  }
}

TEST_F(Schemas, AKeyTooManyTooFewOrOfAnotherTypeIsFound) {
  const std::string scan = file("s.tif");
  run({"synth", scan, "--size", "16x16"});
  const nlohmann::json whole = run({"info", scan});
  const auto changed = [&](const std::function<void(nlohmann::json&)>& change) {
    nlohmann::json report = whole;
    change(report);
    return problemOf(report);
  };
  EXPECT_EQ(changed([](auto&) {}), "");
  EXPECT_NE(changed([](auto& r) { r["widht"] = 3; }), "");
  EXPECT_NE(changed([](auto& r) { r["histogram"]["bins"] = 3; }), "");
  EXPECT_NE(changed([](auto& r) { r.erase("width"); }), "");
  EXPECT_NE(changed([](auto& r) { r["width"] = "3"; }), "");
  EXPECT_NE(changed([](auto& r) { r["width"] = 3.5; }), "");
  EXPECT_NE(changed([](auto& r) { r["warnings"] = {1}; }), "");
  EXPECT_NE(changed([](auto& r) { r["schema"] = "fettle.info/0"; }), "");
  EXPECT_NE(changed([](auto& r) { r.erase("schema"); }), "");
  EXPECT_EQ(changed([](auto& r) { r["noise"] = nullptr; }), "");
}

}  // namespace
}  // namespace fettle::tests
