// A recipe does to other scans what the commands of its steps do one by one.

#include <filesystem>
#include <fstream>
#include <initializer_list>
#include <iterator>
#include <sstream>
#include <string>
#include <tuple>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "engine/filter/filter.h"
#include "engine/formats/formats.h"
#include "engine/marks/edge_suggestion.h"
#include "engine/session/session.h"
#include "tests/end_to_end/program.h"
#include "tests/support/source_tree.h"
#include "tests/support/temp_folder.h"

namespace fettle::tests {
namespace {

TEST(Recipes, AScanHasTheBitsOfTheStepsOneByOne) {
  const TempFolder folder;
  const auto file = [&](const char* name) { return folder.file(name); };
  std::ofstream(file("clean.toml"))
      << "recipe = 1\n"
         "[[step]]\ndo = \"filter\"\nfilter = \"median\"\nwindow = 5\n"
         "[[step]]\ndo = \"mark_edges\"\n"
         "[[step]]\ndo = \"filter\"\nfilter = \"tgv\"\nmax_change = \"40um\"\n"
         "[[step]]\ndo = \"filter\"\nfilter = \"bilateral\"\nrange_sigma = \"20um\"\n";
  for (const std::string seed : {"1", "2"})
    ASSERT_EQ(
        fettle({"synth", file(("s" + seed + ".tif").c_str()), "--size", "160x128", "--seed", seed}).status,
        0);
  const auto report =
      fettleJson({"apply", file("clean.toml"), file("s1.tif"), file("s2.tif"), "--out-dir", file("out")});
  ASSERT_EQ(report["done"], 2);
  for (const std::string seed : {"1", "2"}) {
    const std::string scan = file(("s" + seed + ".tif").c_str());
    ASSERT_EQ(fettle({"filter", scan, file("a.tif"), "--filter", "median", "--window", "5"}).status, 0);
    ASSERT_EQ(fettle({"mark", file("a.tif"), file("m.png"), "--edges"}).status, 0);
    ASSERT_EQ(fettle({"filter", file("a.tif"), file("b.tif"), "--filter", "tgv", "--keep", file("m.png"),
                      "--max-change", "40um", "--original", scan})
                  .status,
              0);
    const auto last = fettleJson({"filter", file("b.tif"), file("c.tif"), "--filter", "bilateral",
                                  "--range-sigma", "20um", "--keep", file("m.png")});
    EXPECT_EQ(report["files"][seed == "1" ? 0 : 1]["hash"], last["hash"]);
    const auto difference = fettleJson({"compare", file("c.tif"), folder.file("out/s" + seed + ".tif")});
    EXPECT_EQ(difference["max_abs"], 0.0);
  }
}

TEST(Recipes, SuggestedLinesHaveTheBitsOfTheCommandsOneByOne) {
  const TempFolder folder;
  const std::string scan = folder.file("s.tif"), recipe = folder.file("clean.toml");
  std::ofstream(recipe) << "recipe = 1\n"
                           "[[step]]\ndo = \"locate_edges\"\nsensitivity = 0.6\n"
                           "[[step]]\ndo = \"filter\"\nfilter = \"tgv\"\n"
                           "[[step]]\ndo = \"filter\"\nfilter = \"median\"\nwindow = 5\n";
  ASSERT_EQ(fettle({"synth", scan, "--size", "200x160", "--seed", "4"}).status, 0);
  const auto report = fettleJson({"apply", recipe, scan, folder.file("o.tif")});
  const std::string lines = folder.file("l.csv"), marks = folder.file("m.png");
  const auto marked = fettleJson(
      {"mark", scan, marks, "--edges", "--sensitivity", "0.6", "--as-lines", "--lines-out", lines});
  EXPECT_GT(marked["lines"], 2);
  EXPECT_EQ(report["steps"][0]["lines"], marked["lines"]);
  ASSERT_EQ(
      fettle({"filter", scan, folder.file("a.tif"), "--filter", "tgv", "--lines", lines, "--keep", marks})
          .status,
      0);
  const auto last = fettleJson({"filter", folder.file("a.tif"), folder.file("b.tif"), "--filter", "median",
                                "--window", "5", "--lines", lines, "--keep", marks});
  EXPECT_EQ(report["hash"], last["hash"]);
  const auto plain = fettleJson({"filter", scan, folder.file("p.tif"), "--filter", "tgv"});
  EXPECT_NE(report["hash"], plain["hash"]);
  expectRefused(fettle({"mark", scan, marks, "--edges", "--as-lines"}), "give --edges and --lines-out");
}

// What is refused of a recipe with this one step, before the scan is read.
void expectRefusedStep(const TempFolder& folder, const std::string& keys, const std::string& part) {
  const std::string recipe = folder.file("refused.toml");
  std::ofstream(recipe) << "recipe = 1\n[[step]]\n" << keys;
  expectRefused(fettle({"apply", recipe, folder.file("none.tif"), folder.file("o.tif")}), part);
}

TEST(Recipes, LinesOfAScannerAreLevelledAsByTheCommand) {
  const TempFolder folder;
  const std::string scan = folder.file("s.tif"), recipe = folder.file("clean.toml");
  ASSERT_EQ(fettle({"synth", scan, "--size", "160x128", "--seed", "3"}).status, 0);
  for (const auto& [rows, axis, form, keep] :
       {std::tuple{"median", "y", "none", ""}, std::tuple{"matching", "x", "poly2", ""},
        std::tuple{"poly1", "x", "plane", ""}, std::tuple{"matching", "y", "none", "4"}}) {
    std::ofstream(recipe) << fmt::format(
        "recipe = 1\n[[step]]\ndo = \"level\"\nrows = \"{}\"\nscan_axis = \"{}\"\nform = \"{}\"\n{}", rows,
        axis, form, *keep == '\0' ? std::string() : fmt::format("keep_form = {}\n", keep));
    const auto report = fettleJson({"apply", recipe, scan, folder.file("o.tif")});
    std::vector<std::string> command = {
        "level", scan, folder.file("l.tif"), "--rows", rows, "--scan-axis", axis, "--form", form};
    if (*keep != '\0') command.insert(command.end(), {"--keep-form", keep});
    const auto level = fettleJson(command);
    EXPECT_EQ(level.contains("keep_form"), *keep != '\0');
    for (const char* key :
         {"rows", "scan_axis", "rows_rms", "rows_empty", "keep_form", "rows_form_rms", "form", "rms"})
      if (level.contains(key)) {
        EXPECT_EQ(report["steps"][0][key], level[key]) << rows << " " << key;
      }
    EXPECT_GT(level["rows_rms"], 0.0);
    EXPECT_EQ(report["hash"], level["hash"]) << rows;
  }
}

TEST(Recipes, FillAndTransformHaveTheBitsOfTheCommandsOneByOne) {
  const TempFolder folder;
  const auto file = [&](const char* name) { return folder.file(name); };
  ASSERT_EQ(fettle({"synth", file("s.tif"), "--size", "200x160", "--seed", "3"}).status, 0);
  std::ofstream(file("r.toml"))
      << "recipe = 1\n"
         "[[step]]\ndo = \"transform\"\ncrop_samples = [10, 5, 140, 180]\nmirror = \"x\"\n"
         "turn = 90\nto_spacing = [1.5, \"2mm\"]\nmethod = \"area\"\n"
         "[[step]]\ndo = \"fill\"\nmethod = \"membrane\"\nmax_extent = \"40mm\"\nborder = true\n"
         "[[step]]\ndo = \"filter\"\nfilter = \"median\"\nmax_change = \"15um\"\n";
  const auto report = fettleJson({"apply", file("r.toml"), file("s.tif"), file("o.tif")});
  const auto moved =
      fettleJson({"transform", file("s.tif"), file("t.tif"), "--crop-samples", "10,5,140,180", "--mirror",
                  "x", "--turn", "90", "--to-spacing", "1.5,2mm", "--method", "area"});
  const auto filled = fettleJson(
      {"fill", file("t.tif"), file("f.tif"), "--method", "membrane", "--max-extent", "40mm", "--border"});
  const auto last = fettleJson({"filter", file("f.tif"), file("m.tif"), "--filter", "median", "--max-change",
                                "15um", "--original", file("t.tif")});
  for (const char* key : {"width", "height"}) EXPECT_EQ(report["steps"][0][key], moved[key]) << key;
  for (const char* key : {"method", "holes", "filled_holes", "filled"})
    EXPECT_EQ(report["steps"][1][key], filled[key]) << key;
  EXPECT_GT(filled["filled"], 0);
  EXPECT_EQ(report["hash"], last["hash"]);
}

TEST(Recipes, ATransformIsRepeatedFromASessionThatBeginsWithIt) {
  const TempFolder folder;
  const auto file = [&](const char* name) { return folder.file(name); };
  ASSERT_EQ(fettle({"synth", file("s.tif"), "--size", "200x160", "--seed", "3"}).status, 0);
  const auto moved = fettleJson({"transform", file("s.tif"), file("t.fettle"), "--crop", "5,5,100,90.5",
                                 "--turn", "180", "--to-spacing", "1.25mm"});
  const auto level = fettleJson({"level", file("t.fettle"), file("l.fettle"), "--form", "poly2"});
  const Outcome recipe = fettle({"recipe", file("l.fettle")});
  ASSERT_EQ(recipe.status, 0) << recipe.err;
  EXPECT_NE(recipe.out.find("crop = [5, 5, 100, 90.5]  # mm\nturn = 180\nto_spacing = \"1.25mm\"\n"),
            std::string::npos)
      << recipe.out;
  std::ofstream(file("r.toml")) << recipe.out;
  const auto again = fettleJson({"apply", file("r.toml"), file("s.tif"), file("o.fettle")});
  EXPECT_EQ(again["hash"], level["hash"]);
  // A session of a session's recipe has the same recipe.
  EXPECT_EQ(fettle({"recipe", file("o.fettle")}).out, recipe.out);
}

// What commands did one after the other is one recipe, in which order ever they came, and the recipe of its result is itself.
TEST(Recipes, OfSessionsThatCommandsWroteHaveAllTheirSteps) {
  const TempFolder folder;
  const auto file = [&](const char* name) { return folder.file(name); };
  ASSERT_EQ(fettle({"synth", file("s.tif"), "--size", "160x128", "--seed", "3"}).status, 0);
  ASSERT_EQ(fettle({"filter", file("s.tif"), file("a.fettle"), "--filter", "bilateral", "--range-sigma",
                    "20um", "--max-change", "0.1"})
                .status,
            0);
  ASSERT_EQ(fettle({"fill", file("a.fettle"), file("b.fettle"), "--method", "membrane"}).status, 0);
  ASSERT_EQ(fettle({"transform", file("b.fettle"), file("c.fettle"), "--mirror", "y"}).status, 0);
  ASSERT_EQ(fettle({"level", file("c.fettle"), file("d.fettle"), "--form", "poly2"}).status, 0);
  ASSERT_EQ(fettle({"level", file("d.fettle"), file("e.fettle"), "--layer", "put", "--form", "mean"}).status,
            0);
  const auto last = fettleJson({"filter", file("e.fettle"), file("f.fettle"), "--filter", "tv"});
  const auto recipe = fettleJson({"recipe", file("f.fettle")});
  EXPECT_EQ(recipe["steps"], 6);
  EXPECT_TRUE(recipe["left_out"].empty()) << recipe["left_out"];
  std::ofstream(file("r.toml")) << recipe["recipe"].get<std::string>();
  const auto again = fettleJson({"apply", file("r.toml"), file("s.tif"), file("g.fettle")});
  EXPECT_EQ(again["hash"], last["hash"]);
  EXPECT_EQ(fettleJson({"recipe", file("g.fettle")})["recipe"], recipe["recipe"]);
  // A command keeps no journal: whoever asks for one is referred to the recipe.
  const Outcome replayed = fettle({"replay", file("f.fettle"), file("p.tif")});
  expectRefused(replayed, "has no journal, which only the window keeps");
  EXPECT_NE(replayed.err.find("fettle recipe prints the steps of commands"), std::string::npos)
      << replayed.err;
  // Through a pipe, and in another format and back, what is known goes along or is said to be missing.
  ProcessOptions from;
  from.input = file("a.fettle");
  const Outcome piped = fettle({"filter", "-", file("h.fettle"), "--filter", "box"}, from);
  ASSERT_EQ(piped.status, 0) << piped.err;
  EXPECT_EQ(fettleJson({"recipe", file("h.fettle")})["steps"], 2);
  ASSERT_EQ(fettle({"mark", file("s.tif"), file("m.png"), "--edges"}).status, 0);
  ASSERT_EQ(
      fettle({"filter", file("a.fettle"), file("i.fettle"), "--filter", "median", "--keep", file("m.png")})
          .status,
      0);
  const auto by_marks = fettleJson({"recipe", file("i.fettle")});
  EXPECT_EQ(by_marks["steps"], 2);
  ASSERT_EQ(by_marks["left_out"].size(), 1U);
  EXPECT_NE(by_marks["left_out"][0].get<std::string>().find("the marks of --keep"), std::string::npos);
}

// A crop cuts lines into several, which a session keeps.
TEST(Recipes, ACroppedSessionWithLinesCanBeRead) {
  const TempFolder folder;
  const std::string scan = folder.file("s.tif"), recipe = folder.file("r.toml"),
                    out = folder.file("o.fettle");
  std::ofstream(recipe) << "recipe = 1\n[[step]]\ndo = \"locate_edges\"\n"
                           "[[step]]\ndo = \"transform\"\ncrop = [5, 5, 45, 40]\n";
  ASSERT_EQ(fettle({"synth", scan, "--size", "256x200", "--seed", "5"}).status, 0);
  ASSERT_EQ(fettle({"apply", recipe, scan, out}).status, 0);
  EXPECT_GT(fettleJson({"info", out})["lines"], 0);
}

TEST(Recipes, WrongFillsAndTransformsAreRefusedWithTheirLine) {
  const TempFolder folder;
  const auto refused = [&](const std::string& keys, const std::string& part) {
    expectRefusedStep(folder, keys, part);
  };
  refused("do = \"fill\"\nmethod = \"spline\"\n", "line 4: method is not one of curvature, membrane");
  refused("do = \"fill\"\nmax_extent = \"wide\"\n", "line 4: max_extent is no length");
  refused("do = \"fill\"\nborder = 1\n", "line 4: border is neither true nor false");
  refused("do = \"transform\"\n", "line 2: the step changes nothing");
  refused("do = \"transform\"\nturn = 45\n", "line 4: turn is not one of 90, 180, 270");
  refused("do = \"transform\"\ncrop = [1, 2, 3]\n", "line 4: crop is not a list of four numbers");
  refused("do = \"transform\"\ncrop_samples = [1, 2, 3.5, 4]\n",
          "line 4: crop_samples is not a list of four");
  refused("do = \"transform\"\nto_spacing = [1, 2, 3]\n", "line 4: to_spacing is not one length");
  refused("do = \"transform\"\nto_spacing = -1\n", "line 4: to_spacing is below");
  refused("do = \"transform\"\nturn = 90\nmethod = \"cubic\"\n", "line 5: method is that of new samples");
}

TEST(Recipes, ALevelIsThatOfTheCommandAndChangesAreLimitedFromThere) {
  const TempFolder folder;
  const std::string scan = folder.file("s.tif"), recipe = folder.file("clean.toml");
  ASSERT_EQ(fettle({"synth", scan, "--size", "160x128", "--seed", "3"}).status, 0);
  std::ofstream(recipe) << "recipe = 1\n[[step]]\ndo = \"level\"\nform = \"poly2\"\nrobust = true\n"
                           "[[step]]\ndo = \"filter\"\nfilter = \"box\"\nwindow = 5\nmax_change = \"15um\"\n";
  const auto report = fettleJson({"apply", recipe, scan, folder.file("o.tif")});
  const auto level = fettleJson({"level", scan, folder.file("l.tif"), "--form", "poly2", "--robust"});
  for (const char* key : {"form", "robust", "region", "tilt_x", "tilt_y", "rms", "rms_counted"})
    EXPECT_EQ(report["steps"][0][key], level[key]) << key;
  const auto filtered = fettleJson({"filter", folder.file("l.tif"), folder.file("f.tif"), "--filter", "box",
                                    "--window", "5", "--max-change", "15um"});
  EXPECT_EQ(report["hash"], filtered["hash"]);
  expectRefusedStep(folder, "do = \"level\"\nrows = \"medium\"\n", "rows is not one of median, mean");
  expectRefusedStep(folder, "do = \"level\"\nscan_axis = \"y\"\n", "scan_axis is that of lines: add rows");
  expectRefusedStep(folder, "do = \"level\"\nkeep_form = 3\n", "keep_form is that of lines: add rows");
  expectRefusedStep(folder, "do = \"level\"\nform = \"none\"\n", "form is not one of mean, plane");
  std::ofstream(recipe) << "recipe = 1\n[[step]]\ndo = \"level\"\nform = \"torus\"\n";
  expectRefused(fettle({"apply", recipe, scan, folder.file("o.tif")}), "form is not one of mean, plane");
  std::ofstream(recipe) << "recipe = 1\n[[step]]\ndo = \"level\"\nrobust = 1\n";
  expectRefused(fettle({"apply", recipe, scan, folder.file("o.tif")}), "neither true nor false");
}

TEST(Recipes, OfALevelledSessionBeginsWithTheLevelAndDoesItAgain) {
  const TempFolder folder;
  const auto file = [&](const char* name) { return folder.file(name); };
  const auto recipeOf = [&](const char* session) {
    const Outcome printed = fettle({"recipe", file(session)});
    EXPECT_EQ(printed.status, 0) << printed.err;
    std::ofstream(file("again.toml")) << printed.out;
    return printed.out;
  };
  ASSERT_EQ(fettle({"synth", file("s.tif"), "--size", "160x128", "--seed", "3"}).status, 0);
  const auto once = fettleJson({"level", file("s.tif"), file("a.fettle"), "--form", "poly3", "--robust"});
  EXPECT_NE(recipeOf("a.fettle").find("form = \"poly3\"\nrobust = true\nregion = \"all\""),
            std::string::npos);
  EXPECT_EQ(fettleJson({"apply", file("again.toml"), file("s.tif"), file("o.tif")})["hash"], once["hash"]);
  // A second one, with lines, on top; and through commands that keep what a session begins with.
  const auto twice = fettleJson({"level", file("a.fettle"), file("b.fettle"), "--form", "none", "--rows",
                                 "median", "--keep-form", "2"});
  ASSERT_EQ(fettle({"convert", file("b.fettle"), file("c.fettle")}).status, 0);
  const std::string text = recipeOf("c.fettle");
  EXPECT_LT(text.find("poly3"),
            text.find("rows = \"median\"\nscan_axis = \"x\"\nkeep_form = 2\nform = \"none\""));
  EXPECT_EQ(fettleJson({"apply", file("again.toml"), file("s.tif"), file("d.fettle")})["hash"],
            twice["hash"]);
  EXPECT_EQ(recipeOf("d.fettle"), text);
  ASSERT_EQ(fettle({"filter", file("d.fettle"), file("e.fettle"), "--filter", "median"}).status, 0);
  const auto filtered = fettleJson({"recipe", file("e.fettle")});
  EXPECT_EQ(filtered["steps"], 3);
  EXPECT_EQ(filtered["left_out"].size(), 0U);
  const auto after = fettleJson({"level", file("e.fettle"), file("f.fettle")});
  (void)recipeOf("f.fettle");
  EXPECT_EQ(fettleJson({"apply", file("again.toml"), file("s.tif"), file("f2.fettle")})["hash"],
            after["hash"]);
  // A form laid over a session is one more step, and what is seen under it is levelled again.
  const auto put = fettleJson({"level", file("b.fettle"), file("g.fettle"), "--layer", "put"});
  (void)recipeOf("g.fettle");
  EXPECT_EQ(fettleJson({"recipe", file("g.fettle")})["steps"], 3);
  EXPECT_EQ(fettleJson({"apply", file("again.toml"), file("s.tif"), file("g2.fettle")})["hash"], put["hash"]);
  const auto rows = fettleJson({"level", file("g.fettle"), file("h.fettle"), "--rows", "mean"});
  (void)recipeOf("h.fettle");
  EXPECT_EQ(fettleJson({"recipe", file("h.fettle")})["steps"], 4);
  EXPECT_EQ(fettleJson({"apply", file("again.toml"), file("s.tif"), file("h2.fettle")})["hash"],
            rows["hash"]);
}

// put, filters under the form, bake, put and remove: as the commands one by one, and the same recipe from their sessions.
TEST(Recipes, FormsArePutBakedAndRemovedAsByTheCommands) {
  const TempFolder folder;
  const auto file = [&](const char* name) { return folder.file(name); };
  ASSERT_EQ(fettle({"synth", file("s.tif"), "--part", "die", "--size", "160x128", "--seed", "3"}).status, 0);
  for (const char* form : {"poly2", "sphere"}) {
    const auto put = fettleJson(
        {"level", file("s.tif"), file("a.fettle"), "--layer", "put", "--form", form, "--robust", "--force"});
    std::ofstream(file("put.toml")) << fettle({"recipe", file("a.fettle")}).out;
    const auto applied = fettleJson({"apply", file("put.toml"), file("s.tif"), file("b.fettle"), "--force"});
    EXPECT_EQ(applied["hash"], put["hash"]);
    for (const char* key : {"form", "robust", "region", "rms", "rms_counted"})
      EXPECT_EQ(applied["steps"][0][key], put[key]) << key;
    EXPECT_EQ(fettleJson({"info", file("b.fettle")})["form"], form);
    EXPECT_EQ(fettle({"recipe", file("b.fettle")}).out, fettle({"recipe", file("a.fettle")}).out);
    // Another format holds the heights with the form; the layer of a session goes in and out.
    EXPECT_EQ(fettleJson({"apply", file("put.toml"), file("s.tif"), file("b.tif")})["hash"], put["hash"]);
    EXPECT_EQ(fettleJson({"info", file("b.tif")})["min"], fettleJson({"info", file("s.tif")})["min"]);
    // Under the form, and baked.
    ASSERT_EQ(fettle({"filter", file("a.fettle"), file("c.fettle"), "--filter", "median", "--window", "5",
                      "--force"})
                  .status,
              0);
    const auto baked =
        fettleJson({"level", file("c.fettle"), file("d.fettle"), "--layer", "bake", "--force"});
    std::ofstream(file("bake.toml"))
        << "recipe = 1\n[[step]]\ndo = \"form\"\nlayer = \"put\"\nform = \"" << form
        << "\"\nrobust = true\n[[step]]\ndo = \"filter\"\nfilter = \"median\"\nwindow = 5\n"
           "[[step]]\ndo = \"form\"\nlayer = \"bake\"\n";
    EXPECT_EQ(fettleJson({"apply", file("bake.toml"), file("s.tif"), file("e.fettle"), "--force"})["hash"],
              baked["hash"]);
    EXPECT_FALSE(fettleJson({"info", file("e.fettle")}).contains("form"));
    // Baked at once it is what fettle level takes out, with a recipe of two steps.
    ASSERT_EQ(fettle({"level", file("a.fettle"), file("f.fettle"), "--layer", "bake", "--force"}).status, 0);
    EXPECT_EQ(fettleJson({"recipe", file("f.fettle")})["steps"], 2);
    ASSERT_EQ(
        fettle({"level", file("s.tif"), file("l.fettle"), "--form", form, "--robust", "--force"}).status, 0);
    EXPECT_EQ(fettleJson({"info", file("f.fettle")})["max"], fettleJson({"info", file("l.fettle")})["max"]);
    // Removed.
    std::ofstream(file("out.toml")) << "recipe = 1\n[[step]]\ndo = \"form\"\nlayer = \"put\"\nform = \""
                                    << form << "\"\n[[step]]\ndo = \"form\"\nlayer = \"remove\"\n";
    const auto removed = fettleJson({"apply", file("out.toml"), file("s.tif"), file("g.fettle"), "--force"});
    EXPECT_EQ(removed["steps"][1]["form"], form);
    EXPECT_FALSE(fettleJson({"info", file("g.fettle")}).contains("form"));
    EXPECT_EQ(fettleJson({"info", file("g.fettle")})["max"], fettleJson({"info", file("s.tif")})["max"]);
  }
  std::ofstream(file("bad.toml")) << "recipe = 1\n[[step]]\ndo = \"form\"\nlayer = \"remove\"\n";
  expectRefused(fettle({"apply", file("bad.toml"), file("s.tif"), file("h.tif")}),
                "no form lies over the scan");
}

TEST(Recipes, ALevelByMarksBelongsToItsScan) {
  const TempFolder folder;
  const std::string scan = folder.file("s.tif"), marks = folder.file("m.png"),
                    session = folder.file("s.fettle");
  ASSERT_EQ(fettle({"synth", scan, "--size", "160x128", "--seed", "3"}).status, 0);
  ASSERT_EQ(fettle({"mark", scan, marks, "--edges"}).status, 0);
  ASSERT_EQ(fettle({"level", scan, session, "--region", "unmarked", "--marks", marks}).status, 0);
  expectRefused(fettle({"recipe", session}), "which these are belongs to this scan");
}

// The next state of a session, with the entries of the journal that made it.
void addStep(engine::Session& session, engine::StepKind kind, const engine::Version& after,
             std::initializer_list<const char*> actions) {
  engine::StepInfo info;
  info.name = "step";
  info.kind = kind;
  ASSERT_TRUE(session.history.push(info, after));
  for (const char* action : actions) {
    engine::JournalEntry entry;
    entry.action = action;
    entry.state = session.history.number();
    session.journal.push_back(entry);
  }
}

TEST(Recipes, OfASessionDoesItsSuggestedEdgesAndFiltersAgain) {
  const TempFolder folder;
  const std::string scan = folder.file("s.tif"), session = folder.file("work.fettle");
  ASSERT_EQ(fettle({"synth", scan, "--size", "160x128"}).status, 0);
  engine::JobControl job;
  const auto imported = engine::importField(scan, {}, job);
  ASSERT_TRUE(imported) << imported.error().line();
  engine::Session made;
  made.original = imported->field;
  made.history = engine::History(imported->field);
  const auto map = engine::findEdges(imported->field, 2.0, job);
  ASSERT_TRUE(map);
  const auto marked = engine::suggestMarks(imported->field, *map, {0.6, 1.5, 0}, job);
  ASSERT_TRUE(marked);
  addStep(made, engine::StepKind::kMark, marked->field,
          {R"({"do":"step","kind":"mark","marks":true,"name":"Edge suggestion","state":1,"tick":7,)"
           R"("suggested":{"scale":2.0,"sensitivity":0.6,"thickness":1.5}})"});
  engine::FilterSpec spec;
  spec.kind = engine::FilterKind::kMedian;
  spec.window = 5;
  const auto filtered = engine::applyFilter(marked->field, imported->field, spec, job);
  ASSERT_TRUE(filtered);
  addStep(made, engine::StepKind::kFilter, filtered->field,
          {R"({"do":"filter","id":1,"filter":"median","window":5,"passes":1,"marks":"keep"})",
           R"({"do":"step","kind":"filter","name":"Median 5 x 5","state":2,"tick":9})"});
  ASSERT_TRUE(engine::saveSession(made, session, job));

  const auto report = fettleJson({"recipe", session});
  EXPECT_EQ(report["steps"], 2);
  EXPECT_EQ(report["left_out"].size(), 0U);
  std::ofstream(folder.file("clean.toml")) << fettle({"recipe", session, "-q"}).out;
  const auto applied = fettleJson({"apply", folder.file("clean.toml"), scan, folder.file("o.fettle")});
  EXPECT_EQ(applied["hash"], fmt::format("{:016x}", engine::contentHash(filtered->field)));
}

// The window goes on where a command ended, and may undo what it did.
TEST(Recipes, StepsOfTheWindowFollowThoseOfCommands) {
  const TempFolder folder;
  const std::string scan = folder.file("s.tif"), session = folder.file("work.fettle");
  ASSERT_EQ(fettle({"synth", scan, "--size", "96x80"}).status, 0);
  ASSERT_EQ(fettle({"level", scan, folder.file("l.fettle")}).status, 0);
  ASSERT_EQ(fettle({"filter", folder.file("l.fettle"), session, "--filter", "box"}).status, 0);
  engine::JobControl job;
  engine::SessionOpenOptions open;
  open.history_bytes = engine::History::kNoBound;
  for (const bool undone : {false, true}) {
    auto made = engine::openSession(session, open, engine::importField, job);
    ASSERT_TRUE(made) << made.error().line();
    ASSERT_EQ(made->history.number(), 1);
    if (undone) {
      ASSERT_TRUE(made->history.undo());
    }
    engine::FilterSpec spec;
    spec.kind = engine::FilterKind::kMedian;
    spec.window = 5;
    const auto filtered = engine::applyFilter(made->history.current(), made->original, spec, job);
    ASSERT_TRUE(filtered);
    const std::string step =
        fmt::format(R"({{"do":"step","kind":"filter","name":"Median","state":{},"tick":9}})", undone ? 1 : 2);
    addStep(
        *made, engine::StepKind::kFilter, filtered->field,
        {R"({"do":"filter","id":1,"filter":"median","window":5,"passes":1,"marks":"keep"})", step.c_str()});
    const std::string worked = folder.file(undone ? "undone.fettle" : "on.fettle");
    ASSERT_TRUE(engine::saveSession(*made, worked, job));
    const auto recipe = fettleJson({"recipe", worked});
    EXPECT_EQ(recipe["steps"], undone ? 2 : 3) << recipe;
    EXPECT_TRUE(recipe["left_out"].empty()) << recipe;
    // A command that reads it adds its own.
    const auto filled =
        fettleJson({"filter", worked, folder.file("next.fettle"), "--filter", "tv", "--force"});
    const auto next = fettleJson({"recipe", folder.file("next.fettle")});
    EXPECT_EQ(next["steps"], undone ? 3 : 4) << next;
    std::ofstream(folder.file("next.toml")) << next["recipe"].get<std::string>();
    EXPECT_EQ(
        fettleJson({"apply", folder.file("next.toml"), scan, folder.file("o.fettle"), "--force"})["hash"],
        filled["hash"]);
  }
}

// A form that a command laid over a scan, and that the window took back, is no step of what came after.
TEST(Recipes, AnUndoneFormOfACommandIsNoStep) {
  const TempFolder folder;
  const std::string session = folder.file("form.fettle"), worked = folder.file("undone.fettle");
  ASSERT_EQ(fettle({"synth", folder.file("s.tif"), "--size", "96x80"}).status, 0);
  ASSERT_EQ(fettle({"level", folder.file("s.tif"), session, "--layer", "put"}).status, 0);
  EXPECT_EQ(fettleJson({"recipe", session})["steps"], 1);
  engine::JobControl job;
  auto made = engine::openSession(session, {}, engine::importField, job);
  ASSERT_TRUE(made) << made.error().line();
  ASSERT_TRUE(made->history.undo());
  engine::FilterSpec spec;
  spec.kind = engine::FilterKind::kMedian;
  spec.window = 5;
  const auto filtered = engine::applyFilter(made->history.current(), made->original, spec, job);
  ASSERT_TRUE(filtered);
  addStep(*made, engine::StepKind::kFilter, filtered->field,
          {R"({"do":"filter","id":1,"filter":"median","window":5,"passes":1,"marks":"keep"})",
           R"({"do":"step","kind":"filter","name":"Median","state":1,"tick":9})"});
  ASSERT_TRUE(engine::saveSession(*made, worked, job));
  const auto recipe = fettleJson({"recipe", worked});
  EXPECT_EQ(recipe["steps"], 1) << recipe;
  EXPECT_EQ(recipe["recipe"].get<std::string>().find("layer"), std::string::npos) << recipe;
}

// A history that cannot be read costs what is known of it, not the work of a command.
TEST(Recipes, ADamagedJournalIsSaidToBeMissingAndRefusesNoFilter) {
  const TempFolder folder;
  const std::string session = folder.file("s.fettle"), out = folder.file("o.fettle");
  ASSERT_EQ(fettle({"synth", folder.file("s.tif"), "--size", "96x80"}).status, 0);
  ASSERT_EQ(fettle({"convert", folder.file("s.tif"), session}).status, 0);
  engine::JobControl job;
  {
    auto made = engine::openSession(session, {}, engine::importField, job);
    ASSERT_TRUE(made) << made.error().line();
    engine::FilterSpec spec;
    spec.window = 3;
    const auto filtered = engine::applyFilter(made->history.current(), made->original, spec, job);
    ASSERT_TRUE(filtered);
    addStep(*made, engine::StepKind::kFilter, filtered->field,
            {R"({"do":"filter","id":1,"filter":"box","window":3,"passes":1,"marks":"keep"})",
             R"({"do":"step","kind":"filter","name":"Box","state":1,"tick":9})"});
    ASSERT_TRUE(engine::saveSession(*made, session, job));
  }
  std::fstream file(session, std::ios::in | std::ios::out | std::ios::binary);
  const std::string bytes{std::istreambuf_iterator<char>(file), {}};
  const std::string row = R"("filter":"box","window":3)";
  const std::size_t at = bytes.find(row);
  ASSERT_NE(at, std::string::npos);
  file.seekp(static_cast<std::streamoff>(at + row.size() - 1));
  file.put('5');
  file.close();
  const Outcome filtered = fettle({"filter", session, out, "--filter", "median"});
  ASSERT_EQ(filtered.status, 0) << filtered.err;
  const auto recipe = fettleJson({"recipe", out});
  EXPECT_EQ(recipe["steps"], 1) << recipe;
  ASSERT_EQ(recipe["left_out"].size(), 1U) << recipe;
  EXPECT_NE(recipe["left_out"][0].get<std::string>().find("what was done before"), std::string::npos);
}

TEST(Recipes, AWrongRecipeIsRefusedBeforeAScanIsRead) {
  const TempFolder folder;
  std::ofstream(folder.file("clean.toml"))
      << "recipe = 1\n[[step]]\ndo = \"filter\"\nfilter = \"tv\"\nrange_sigma = \"20parsec\"\n";
  const std::string scan = folder.file("none.tif"), out = folder.file("o.tif");
  expectRefused(fettle({"apply", folder.file("clean.toml"), scan, out}), "line 5: range_sigma is no length");
  expectRefused(fettle({"apply", folder.file("none.toml"), scan, out}), "none.toml");
  expectRefused(fettle({"apply", folder.path().string(), scan, out}), "the recipe cannot be read");
  expectRefused(fettle({"apply", "/dev/zero", scan, out}), "too long for a recipe");
  expectRefused(fettle({"apply", "-", "-", out}), "cannot both be standard input");
}

TEST(Recipes, AStepThatFailsIsNamedAndNoFileIsLeft) {
  const TempFolder folder;
  std::ofstream(folder.file("clean.toml"))
      << "recipe = 1\n[[step]]\ndo = \"invert\"\n[[step]]\ndo = \"filter\"\nfilter = \"tv\"\n";
  // A plane: there is no noise to be seen.
  std::ofstream(folder.file("s.asc")) << "ncols 2\nnrows 2\nxllcorner 0\nyllcorner 0\ncellsize 1\n"
                                         "1 1\n1 1\n";
  expectRefused(fettle({"apply", folder.file("clean.toml"), folder.file("s.asc"), folder.file("o.tif"),
                        "--unit", "mm"}),
                "step 2 of the recipe: ");
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "o.tif"));
}

TEST(Recipes, AFilterOfMarkedSamplesWarnsWhereNoneIsMarked) {
  const TempFolder folder;
  std::ofstream(folder.file("clean.toml"))
      << "recipe = 1\n[[step]]\ndo = \"filter\"\nfilter = \"median\"\nmarks = \"only\"\n";
  ASSERT_EQ(fettle({"synth", folder.file("s.tif"), "--size", "64x64"}).status, 0);
  const Outcome done =
      fettle({"apply", folder.file("clean.toml"), folder.file("s.tif"), folder.file("o.tif")});
  EXPECT_EQ(done.status, 0);
  EXPECT_NE(done.err.find("step 1 filters marked samples only, and none is marked"), std::string::npos)
      << done.err;
}

TEST(Recipes, ASessionWithoutStepsHasNone) {
  const TempFolder folder;
  ASSERT_EQ(fettle({"synth", folder.file("s.tif"), "--size", "64x64"}).status, 0);
  ASSERT_EQ(fettle({"convert", folder.file("s.tif"), folder.file("s.fettle")}).status, 0);
  expectRefused(fettle({"recipe", folder.file("s.fettle")}), "the session has no steps");
  EXPECT_EQ(fettle({"journal", folder.file("s.fettle")}).out, "");
  expectRefused(fettle({"journal", folder.file("s.tif")}), "s.tif");
}

TEST(Recipes, AJournalIsAJsonObjectPerLineAlsoWithQuiet) {
  const TempFolder folder;  // opening a session may write beside it
  const std::string session = folder.file("work.fettle");
  std::filesystem::copy_file(inSourceTree("tests/haptic/journal/sessions/contact_revision_1.fettle"),
                             session);
  const auto report = fettleJson({"journal", session});
  std::istringstream lines(fettle({"journal", session, "--quiet"}).out);
  std::size_t read = 0;
  for (std::string line; std::getline(lines, line); ++read)
    EXPECT_EQ(nlohmann::json::parse(line), report["entries"].at(read));
  EXPECT_EQ(read, report["entries"].size());
  EXPECT_EQ(report["entries"].at(0)["action"]["do"], "begin");
  EXPECT_GT(read, 5U);
  expectRefused(fettle({"recipe", session}), "it belongs to this scan");
}

}  // namespace
}  // namespace fettle::tests
