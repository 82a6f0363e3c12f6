// Recipes: the steps of a session as text, and that text read again.

#include "app/commands/recipe_file.h"
#include "app/commands/recipe_of_session.h"

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include <gtest/gtest.h>

#include "engine/field/live_field.h"
#include "engine/field/nominal_form.h"
#include "engine/filter/noise_range.h"
#include "engine/scanner/scanner.h"
#include "haptic/journal/journal.h"

namespace fettle::app {
namespace {

using engine::FilterKind;
using engine::StepKind;

engine::Version scan() {
  engine::ScannerSpec spec;
  spec.width = spec.height = 128;
  engine::JobControl job;
  return engine::simulateScan(spec, job)->scan;
}

// A session that is worked on as in the window: a journal entry for each step, and a history.
class Work {
 public:
  explicit Work(const engine::Version& field) {
    session_.original = field;
    session_.history = engine::History(field);
  }

  void filter(const engine::FilterSpec& spec, const std::string& name) {
    engine::JobControl job;
    note(haptic::journal::FilterBegun{1, spec});
    step(name, StepKind::kFilter, engine::applyFilter(field(), session_.original, spec, job)->field);
  }
  void step(const std::string& name, StepKind kind, const engine::Version& after,
            std::optional<haptic::journal::EdgesSuggested> suggested = {}) {
    engine::StepInfo info;
    info.name = name;
    info.kind = kind;
    ASSERT_TRUE(session_.history.push(info, after));
    note(haptic::journal::StepMade{session_.history.number(), name, kind, {}, false, false, suggested});
  }
  // As LoopClient::changeHeights() makes it; what becomes of the heights is no matter here.
  void made(const std::string& name, const haptic::HeightsMaker& maker) {
    engine::StepInfo info;
    info.name = name;
    info.kind = StepKind::kFilter;
    ASSERT_TRUE(session_.history.push(info, field().inverted()));
    haptic::journal::StepMade step{session_.history.number(), name, StepKind::kFilter, {}};
    step.maker = maker;
    note(step);
  }
  // As LoopClient::changeForm() makes it: under a form, or under none.
  void form(const std::string& name, const engine::Version& after,
            std::optional<haptic::journal::FormFitted> fitted = {}, bool heights = false) {
    engine::StepInfo info;
    info.name = name;
    info.kind = StepKind::kForm;
    ASSERT_TRUE(session_.history.push(info, after));
    haptic::journal::StepMade made{session_.history.number(), name, StepKind::kForm, {}};
    made.form = !heights;
    made.heights = heights;
    made.fitted = std::move(fitted);
    note(made);
  }
  void noted(const std::string& recipe) { session_.notes[engine::kRecipeNote] = recipe; }
  void withoutJournal(const std::string& name, const engine::Version& after,
                      StepKind kind = StepKind::kFilter) {
    engine::StepInfo info;
    info.name = name;
    info.kind = kind;
    ASSERT_TRUE(session_.history.push(info, after));
  }
  void undo() { ASSERT_TRUE(session_.history.undo().has_value()); }

  [[nodiscard]] const engine::Version& field() const { return session_.history.current(); }
  [[nodiscard]] Recipe recipe() const {
    engine::JobControl job;
    return recipeOf(session_, job).value();
  }

 private:
  void note(const haptic::journal::Entry& entry) {
    engine::JournalEntry row;
    row.action = haptic::journalText(entry);
    session_.journal.push_back(row);
  }

  engine::Session session_;
};

engine::FilterSpec specOf(FilterKind kind, int window = 3) {
  engine::FilterSpec spec;
  spec.kind = kind;
  spec.window = window;
  return spec;
}

TEST(Recipe, HasTheFiltersThatLedToThePresentStateAndNamesWhatItLeavesOut) {
  Work work(scan());
  work.filter(specOf(FilterKind::kMedian, 5), "Median 5");
  work.filter(specOf(FilterKind::kBox, 9), "Box 9");
  work.undo();
  engine::JobControl job;
  engine::FilterSpec limited = specOf(FilterKind::kGaussian, 7);
  limited.max_change = 0.05;
  limited.passes = 2;
  work.filter(limited, "Gaussian 7");
  work.step("Smooth", StepKind::kStroke, work.field().inverted());
  work.step("Upside down", StepKind::kInvert, work.field().inverted());

  const Recipe recipe = work.recipe();
  ASSERT_EQ(recipe.steps.size(), 3U);
  EXPECT_EQ(std::get<RecipeFilter>(recipe.steps[0]).spec.kind, FilterKind::kMedian);
  EXPECT_EQ(std::get<RecipeFilter>(recipe.steps[0]).spec.window, 5);
  const auto& gaussian = std::get<RecipeFilter>(recipe.steps[1]);
  EXPECT_EQ(gaussian.spec.kind, FilterKind::kGaussian);
  EXPECT_EQ(gaussian.spec.passes, 2);
  EXPECT_EQ(gaussian.max_change->value, 0.05);
  EXPECT_EQ(gaussian.max_change->unit->name, "mm");
  EXPECT_TRUE(std::holds_alternative<RecipeInvert>(recipe.steps[2]));
  ASSERT_EQ(recipe.left_out.size(), 1U);
  EXPECT_EQ(recipe.left_out[0], "step 3, Smooth: it belongs to this scan");
}

TEST(Recipe, HasTheSuggestedEdgesAndLeavesOutThoseOfAHand) {
  Work work(scan());
  const auto marked = [&](std::int32_t column) {
    engine::LiveField live(work.field(), engine::Growth::kAllowed);
    EXPECT_TRUE(live.setMark(column, 7, true));
    return live.snapshot();
  };
  const haptic::journal::EdgesSuggested numbers{2.25, 0.1 + 0.2, 3.0};
  work.step("Edge suggestion", StepKind::kMark, marked(3), numbers);
  work.step("Lasso", StepKind::kMark, marked(4));
  work.step("Edge lines", StepKind::kLines, marked(5), numbers);
  const Recipe recipe = work.recipe();
  ASSERT_EQ(recipe.steps.size(), 2U);
  for (const std::size_t k : {0U, 1U}) {
    const auto& edges = std::get<RecipeEdges>(recipe.steps[k]);
    EXPECT_EQ(edges.become, k == 0 ? EdgesBecome::kMarks : EdgesBecome::kLines);
    EXPECT_EQ(edges.scale, numbers.scale);
    EXPECT_EQ(edges.choice.sensitivity, numbers.sensitivity);
    EXPECT_EQ(edges.choice.thickness, numbers.thickness);
  }
  EXPECT_EQ(recipe.left_out, std::vector<std::string>{"step 2, Lasso: it belongs to this scan"});
}

TEST(Recipe, ARangeThatIsTheNoisesIsLeftToTheNoiseOfEachScan) {
  Work work(scan());
  engine::JobControl job;
  work.filter(*engine::withMeasuredRange(specOf(FilterKind::kTotalVariation, 31), work.field(), job), "TV");
  engine::FilterSpec chosen = specOf(FilterKind::kTotalVariation, 31);
  chosen.range_sigma = 0.0625;
  work.filter(chosen, "TV");
  const Recipe recipe = work.recipe();
  EXPECT_FALSE(std::get<RecipeFilter>(recipe.steps.at(0)).range_sigma);
  ASSERT_TRUE(std::get<RecipeFilter>(recipe.steps.at(1)).range_sigma);
  EXPECT_EQ(std::get<RecipeFilter>(recipe.steps.at(1)).range_sigma->value, 0.0625);
}

// As the window takes it after other filters.
TEST(Recipe, ARangeThatIsOfTheNoiseOfTheScanIsLeftToThatOfEachScan) {
  Work work(scan());
  engine::JobControl job;
  const auto ready = engine::withMeasuredRange(specOf(FilterKind::kTotalVariation, 31), work.field(), job);
  work.filter(specOf(FilterKind::kGaussian, 5), "Gaussian");
  work.filter(*ready, "TV");
  work.filter(*engine::withMeasuredRange(specOf(FilterKind::kTotalVariation, 31), work.field(), job), "TV");
  const std::string text = recipeText(work.recipe());
  const auto read = parseRecipe(text, "recipe");
  ASSERT_TRUE(read) << read.error().line() << text;
  const auto& of_scan = std::get<RecipeFilter>(read->steps.at(1));
  const auto& of_field = std::get<RecipeFilter>(read->steps.at(2));
  EXPECT_FALSE(of_scan.range_sigma);
  EXPECT_EQ(of_scan.noise_of, NoiseOf::kOriginal);
  EXPECT_FALSE(of_field.range_sigma);
  EXPECT_EQ(of_field.noise_of, NoiseOf::kField);
  const std::string step = "recipe = 1\n[[step]]\ndo = \"filter\"\nnoise_of = \"original\"\n";
  EXPECT_TRUE(parseRecipe(step + "filter = \"planes\"\n", "r"));
  EXPECT_FALSE(parseRecipe(step + "filter = \"box\"\n", "r"));
  EXPECT_FALSE(parseRecipe(step + "filter = \"planes\"\nrange_sigma = \"20um\"\n", "r"));
}

TEST(Recipe, HasRemovedSamplesButNotThoseOfMarks) {
  Work work(scan());
  const engine::RemoveOptions below{.heights = engine::RemoveOptions::Heights::kOutside, .low = 0.1 + 0.2};
  const engine::RemoveOptions between{.low = -1.0, .high = 0.5, .region = engine::Region::kAll};
  work.made("Remove", below);
  work.made("Remove", between);
  work.made("Remove", engine::RemoveOptions{.region = engine::Region::kMarked});
  const Recipe recipe = work.recipe();
  ASSERT_EQ(recipe.steps.size(), 2U);
  EXPECT_EQ(recipe.left_out,
            std::vector<std::string>{"step 3, Remove: which samples were marked belongs to this scan"});
  const auto read = parseRecipe(recipeText(recipe), "recipe");
  ASSERT_TRUE(read) << read.error().line();
  const engine::Grid& grid = work.field().grid();
  EXPECT_EQ(*removeOptionsOf(std::get<RecipeRemove>(read->steps.at(0)).what, grid), below);
  EXPECT_EQ(*removeOptionsOf(std::get<RecipeRemove>(read->steps.at(1)).what, grid), between);
}

TEST(Recipe, AFilterOfACommandIsLeftOutSinceNoSessionStoresItsNumbers) {
  Work work(scan());
  engine::JobControl job;
  work.withoutJournal(
      "median", engine::applyFilter(work.field(), work.field(), specOf(FilterKind::kMedian), job)->field);
  const Recipe recipe = work.recipe();
  EXPECT_TRUE(recipe.steps.empty());
  EXPECT_EQ(recipe.left_out.size(), 1U);
}

engine::Version under(const engine::Version& field, double height) {
  const engine::Grid& grid = field.grid();
  return field.withForm(std::make_shared<const engine::NominalForm>(
      engine::PolynomialForm{0, grid.width, grid.height, height, {0.0}}));
}

TEST(Recipe, HasTheFormsThatWerePutRemovedAndMadeHeights) {
  Work work(scan());
  work.form("Form out: sphere", under(work.field(), 1.0), {{"sphere", "all", true}});
  work.filter(specOf(FilterKind::kMedian, 5), "Median 5");
  work.form("Form out: plane", under(work.field(), 2.0), {{"plane", "unmarked", false}});
  work.form("Form back: plane", work.field().withForm(nullptr));
  const engine::ThreePoints points{{{{0.5, 1.0 / 3.0}, {4.0, 1.0}, {2.0, 5.0}}}, 0.25};
  work.form("Form out: plane", under(work.field(), 2.5), {{"plane", "all", false, points}});
  work.form("Form back: plane", work.field().withForm(nullptr));
  work.form("Form out: cone", under(work.field(), 3.0), {{"cone", "all", false}});
  work.form("Heights without cone", work.field().withForm(nullptr), {}, true);
  const Recipe recipe = work.recipe();
  EXPECT_TRUE(recipe.left_out.empty());
  ASSERT_EQ(recipe.steps.size(), 8U);
  const auto step = [&](std::size_t k) { return std::get<RecipeForm>(recipe.steps[k]); };
  EXPECT_EQ(step(0).layer, "put");
  EXPECT_EQ(step(0).form.form, "sphere");
  EXPECT_TRUE(step(0).form.robust);
  EXPECT_TRUE(std::holds_alternative<RecipeFilter>(recipe.steps[1]));
  EXPECT_EQ(step(2).form.region, "unmarked");
  EXPECT_EQ(step(3).layer, "remove");
  EXPECT_EQ(formChoiceOf(step(4).form).through, points);
  EXPECT_EQ(step(6).form.form, "cone");
  EXPECT_EQ(step(7).layer, "bake");
  // What is written is read to the same.
  const auto read = parseRecipe(recipeText(recipe), "a.toml");
  ASSERT_TRUE(read) << read.error().line();
  EXPECT_EQ(recipeText(*read), recipeText(recipe));
}

TEST(Recipe, LeavesOutFormsThatBelongToTheScanAndWhatIsDoneToThem) {
  Work work(scan());
  engine::LiveField live(work.field(), engine::Growth::kAllowed);
  ASSERT_TRUE(live.setMark(3, 7, true));
  work.step("Lasso", StepKind::kMark, live.snapshot());
  work.form("Form out: plane", under(work.field(), 2.0), {{"plane", "marked", false}});
  work.form("Form back: plane", work.field().withForm(nullptr));
  // A session of a program that did not note how forms are found.
  work.form("Form out: plane", under(work.field(), 2.0));
  work.form("Heights without plane", work.field().withForm(nullptr), {}, true);
  work.form("Form out: mean height", under(work.field(), 4.0), {{"mean", "all", false}});
  const Recipe recipe = work.recipe();
  ASSERT_EQ(recipe.steps.size(), 1U);
  EXPECT_EQ(std::get<RecipeForm>(recipe.steps[0]).form.form, "mean");
  EXPECT_EQ(recipe.left_out,
            (std::vector<std::string>{
                "step 1, Lasso: it belongs to this scan",
                "step 2, Form out: plane: which samples it was fitted to belongs to this scan",
                "step 3, Form back: plane: the form that was over the field is left out",
                "step 4, Form out: plane: the session stores the form, not how it was fitted",
                "step 5, Heights without plane: the form that was over the field is left out"}));
}

TEST(Recipe, OfACommandsLayerIsThatOfItsNoteWhileItIsAStep) {
  const auto noteOf = [](std::vector<RecipeStep> steps) {
    return recipeText(Recipe{.steps = std::move(steps), .left_out = {}});
  };
  const RecipeForm poly{"put", {{}, "poly2", true}}, by_marks{"put", {{"marked"}, "plane", false}};
  const std::string put = noteOf({poly});
  EXPECT_TRUE(putsForm(put));
  EXPECT_FALSE(putsForm(noteOf({poly, RecipeForm{"remove", {}}})));
  EXPECT_FALSE(putsForm(""));
  Work work(scan());
  work.noted(put);
  EXPECT_TRUE(work.recipe().steps.empty());
  work.withoutJournal("Form", under(work.field(), 1.0), StepKind::kForm);
  work.filter(specOf(FilterKind::kMedian, 5), "Median 5");
  EXPECT_EQ(work.recipe().steps.size(), 2U);
  EXPECT_EQ(std::get<RecipeForm>(work.recipe().steps.at(0)).form.form, "poly2");
  work.undo();
  work.undo();
  EXPECT_TRUE(work.recipe().steps.empty());
  // What was baked is among the heights of step 0, and by marks it is not repeated.
  work.noted(noteOf({poly, RecipeForm{"bake", {}}}));
  EXPECT_EQ(work.recipe().steps.size(), 2U);
  work.noted(noteOf({by_marks, RecipeForm{"bake", {}}}));
  EXPECT_TRUE(work.recipe().steps.empty());
  EXPECT_EQ(work.recipe().left_out.size(), 2U);
}

TEST(Recipe, WhatIsWrittenIsReadToTheSameText) {
  Recipe recipe;
  RecipeFilter filter;
  filter.spec = specOf(FilterKind::kBilateral, 7);
  filter.spec.sigma = 0.1 + 0.2;  // 17 digits
  filter.spec.scope = engine::FilterScope::kOnlyMarks;
  filter.spec.passes = 3;
  filter.range_sigma = RecipeLength{20.0, engine::LengthUnit{"um", 1e-3}};
  filter.max_change = RecipeLength{0.3, std::nullopt};
  RecipeEdges edges;
  edges.scale = 2.25;
  edges.choice.thickness = 3.0;
  RecipeEdges lines = edges;
  lines.become = EdgesBecome::kLines;
  lines.choice.sensitivity = 0.1 + 0.7;
  recipe.steps = {filter, edges, RecipeInvert{}, lines};
  recipe.left_out = {"step 2, Smooth: it belongs to this scan"};
  const std::string text = recipeText(recipe);
  const auto read = parseRecipe(text, "clean.toml");
  ASSERT_TRUE(read) << read.error().line();
  const auto& filtered = std::get<RecipeFilter>(read->steps.at(0));
  EXPECT_EQ(filtered.spec.sigma, filter.spec.sigma);
  engine::Grid grid;  // in millimetres
  EXPECT_EQ(filtered.range_sigma->in(grid), 0.02);
  EXPECT_EQ(filtered.max_change->in(grid), 0.3);
  EXPECT_EQ(std::get<RecipeEdges>(read->steps.at(1)).scale, 2.25);
  EXPECT_EQ(std::get<RecipeEdges>(read->steps.at(3)).become, EdgesBecome::kLines);
  EXPECT_EQ(std::get<RecipeEdges>(read->steps.at(3)).choice.sensitivity, lines.choice.sensitivity);
  Recipe again = *read;
  again.left_out = recipe.left_out;
  EXPECT_EQ(recipeText(again), text);
}

TEST(Recipe, WhatIsWrongIsNamedWithItsLine) {
  const auto problem = [](const std::string& text) {
    const auto read = parseRecipe(text, "clean.toml");
    return read ? std::string() : read.error().line();
  };
  EXPECT_NE(problem("recipe = 2").find("no recipe of version 1"), std::string::npos);
  EXPECT_NE(problem("recipe = 1").find("has no steps"), std::string::npos);
  EXPECT_NE(problem("recipe = 1\n[[step]]\ndo = \"fitler\"").find("line 3: do is not one of"),
            std::string::npos);
  EXPECT_NE(problem("recipe = 1\n[[step]]\ndo = \"fitler\"").find("did you mean filter?"), std::string::npos);
  EXPECT_NE(problem("recipe = 1\n[[step]]\ndo = \"form\"").find("line 2: the step has no \"layer\""),
            std::string::npos);
  EXPECT_NE(problem("recipe = 1\n[[step]]\ndo = \"form\"\nlayer = \"put\"\nform = \"none\"")
                .find("line 5: form is not one of mean, plane"),
            std::string::npos);
  EXPECT_NE(problem("recipe = 1\n[[step]]\ndo = \"form\"\nlayer = \"bake\"\nrobust = true")
                .find("line 5: robust is that of a form that is put"),
            std::string::npos);
  EXPECT_NE(problem("recipe = 1\n[[step]]\ndo = \"filter\"").find("line 2: the step has no \"filter\""),
            std::string::npos);
  EXPECT_NE(problem("recipe = 1\n[[step]]\ndo = \"filter\"\nfilter = \"median\"\nwindow = 4")
                .find("line 5: a filter window of 4 samples"),
            std::string::npos);
  EXPECT_NE(problem("recipe = 1\n[[step]]\ndo = \"filter\"\nfilter = \"median\"\nwindow = \"x\"")
                .find("line 5: window is not a number from 1 to 1001"),
            std::string::npos);
  EXPECT_NE(problem("recipe = 1\n[[step]]\ndo = \"filter\"\nfilter = \"median\"\nwidow = 3")
                .find("line 5: filter has no key \"widow\""),
            std::string::npos);
  const std::string tv = "recipe = 1\n[[step]]\ndo = \"filter\"\nfilter = \"tv\"\n";
  for (const char* length : {"\"20parsec\"", "\"\"", "\"0.02\"", "\"um\"", "true"})
    EXPECT_NE(problem(tv + "range_sigma = " + length).find("line 5: range_sigma is no length"),
              std::string::npos)
        << length;
  EXPECT_EQ(problem(tv + "range_sigma = \"0.02 mm\""), "") << "as people write it";
  for (const char* length : {"\"-1um\"", "0", "inf", "nan", "\"infmm\""})
    EXPECT_NE(problem(tv + "range_sigma = " + length).find("line 5: range_sigma is"), std::string::npos)
        << length;
  EXPECT_NE(problem(tv + "max_change = -0.1").find("line 5: max_change is below 0"), std::string::npos);
  EXPECT_EQ(problem(tv + "max_change = 0\nrange_sigma = 0.02"), "");
  EXPECT_NE(problem("recipe = 1\n[[step]]\ndo = \"filter\"\nfiltr = \"median\"").find("did you mean filter?"),
            std::string::npos);
  EXPECT_NE(problem("recipe = 1\n[[step]]\ndo = \"filter\"\nfilter = \"median\"\nwindow = \"5\"")
                .find("without quotes"),
            std::string::npos);
  EXPECT_NE(problem("recipe = true\n[[step]]\ndo = \"invert\"").find("no recipe of version 1"),
            std::string::npos);
  EXPECT_NE(problem("recipe = 1\nstep = 3").find("line 2: step is no list: write [[step]]"),
            std::string::npos);
  EXPECT_NE(problem("recipe = 1\nsteps = []\n[[step]]\ndo = \"invert\"").find("no key \"steps\""),
            std::string::npos);
  EXPECT_NE(problem("recipe = = 1").find("line 1"), std::string::npos);
  EXPECT_EQ(problem("recipe = 1\n[[step]]\ndo = \"invert\""), "");
}

}  // namespace
}  // namespace fettle::app
