#include <cmath>
#include <limits>

#include <gtest/gtest.h>
#include <rapidcheck.h>
#include <rapidcheck/gtest.h>

#include "engine/field/builder.h"
#include "engine/field/live_field.h"
#include "engine/session/line_codec.h"
#include "haptic/journal/journal.h"
#include "haptic/journal/mark_codec.h"
#include "haptic/journal/tick_codec.h"
#include "tests/haptic/support/fields.h"

namespace fettle::app {
namespace {

using haptic::StrokeSample;

// Ticks as a loop makes them: times in whole nanoseconds, mostly a period apart, positions that rest now and
// then.
std::vector<StrokeSample> ticks(std::mt19937_64& random, std::size_t count) {
  std::vector<StrokeSample> all;
  std::int64_t ns = 0;
  StrokeSample tick;
  for (std::size_t i = 0; i < count; ++i) {
    tick.t = 1e-9 * static_cast<double>(ns);
    const auto what = random() % 8;
    if (what < 3) tick.tip_mm.x += tests::uniform(random, -1, 1);
    if (what < 2) tick.tip_mm.y = tests::uniform(random, -1e6, 1e6);
    if (what < 4) tick.tip_mm.z *= 0.99;
    if (what == 5) tick.tool = static_cast<haptic::Tool>(random() % 4);
    all.push_back(tick);
    if (what == 7) all.back().tip_mm.x = std::numeric_limits<double>::quiet_NaN();
    ns += what == 6 ? static_cast<std::int64_t>(random() % 4'000'000'000)
                    : 900'000 + static_cast<std::int64_t>(random() % 200'000);
  }
  return all;
}

RC_GTEST_PROP(TickCodec, EveryBitThatATickUsesComesBack, ()) {
  std::mt19937_64 random(*rc::gen::arbitrary<std::uint64_t>());
  const std::vector<StrokeSample> all = ticks(random, *rc::gen::inRange<std::size_t>(0, 400));
  haptic::TickPacker packer;
  for (const StrokeSample& tick : all) packer.add(tick);
  RC_ASSERT(packer.count() == static_cast<std::int64_t>(all.size()));
  const auto back = haptic::unpackTicks(packer.take());
  RC_ASSERT(back.has_value());
  RC_ASSERT(back->size() == all.size());
  for (std::size_t i = 0; i < all.size(); ++i) {
    RC_ASSERT((*back)[i].tool == all[i].tool);
    if (std::isnan(all[i].tip_mm.x))
      RC_ASSERT(std::isnan((*back)[i].tip_mm.x));
    else
      RC_ASSERT((*back)[i] == all[i]);
  }
}

TEST(TickCodec, ARestingHandTakesFewBytes) {
  haptic::TickPacker packer;
  for (int i = 0; i < 10000; ++i)
    packer.add({1e-9 * (i * 1e6 + (i % 7) * 9000.0), {1.0, 2.0, 3.0}, haptic::Tool::kFeel});
  EXPECT_LT(packer.bytes(), 10000U * 5U);
  haptic::TickPacker nothing;
  for (int i = 0; i < 10000; ++i)
    nothing.add({1e-3 * i, {std::numeric_limits<double>::quiet_NaN(), 0.0, 0.0}, haptic::Tool::kFeel});
  EXPECT_LT(nothing.take().size(), 16U);
}

RC_GTEST_PROP(TickCodec, DamagedBytesAreRefusedOrReadNeverWorse, ()) {
  std::mt19937_64 random(*rc::gen::arbitrary<std::uint64_t>());
  haptic::TickPacker packer;
  for (const StrokeSample& tick : ticks(random, 50)) packer.add(tick);
  std::string block = packer.take();
  for (int i = 0; i < 3; ++i) block[random() % block.size()] = static_cast<char>(random());
  block.resize(block.size() - random() % 3);
  const auto back = haptic::unpackTicks(block);
  if (back)
    for (const StrokeSample& tick : *back) RC_ASSERT(std::isfinite(tick.t));
}

haptic::Scene anyScene(std::mt19937_64& random) {
  haptic::Scene scene;
  scene.tip = random() % 2 == 0 ? haptic::TipShape::kPoint : haptic::TipShape::kSphere;
  scene.tip_radius_mm = tests::uniform(random, 1e-9, 100);
  scene.level = static_cast<haptic::ContactLevel>(random() % 3);
  scene.certified_radius_cells = 1 + static_cast<int>(random() % 64);
  if (scene.tip == haptic::TipShape::kSphere || scene.level != haptic::ContactLevel::kPaper)
    scene.search_rounds = 2 + static_cast<int>(random() % 2047);
  scene.ball_searches = static_cast<int>(random() % 4097);
  scene.ball_work = static_cast<int>(random() % 1000);
  scene.ball_minima = static_cast<haptic::BallMinima>(random() % 2);
  scene.stiffness_n_per_mm = tests::uniform(random, 1e-12, random() % 2 == 0 ? 1000 : 1e9);
  scene.force_limit_n = tests::uniform(random, 1e-12, 1000);
  scene.brush_radius_samples = tests::uniform(random, 0, 64);
  scene.mark_radius_samples = static_cast<double>(random() % 64);
  scene.brush_falloff = static_cast<haptic::Falloff>(random() % static_cast<int>(haptic::Falloff::kCount));
  if (random() % 2 == 0) scene.brush_spacing = tests::uniform(random, 0, 2);
  if (random() % 2 == 0) scene.max_change = tests::uniform(random, 0, 1e9);
  scene.invert = random() % 2 == 0;
  scene.params.friction = {0.9, tests::uniform(random, 0, 0.9), tests::uniform(random, 1e-9, 1000)};
  scene.params.viscosity.medium =
      random() % 2 == 0 ? haptic::ViscousMedium::kContact : haptic::ViscousMedium::kEverywhere;
  scene.params.texture.wavelength_mm = tests::uniform(random, 1e-9, random() % 2 == 0 ? 100 : 1e9);
  if (random() % 2 == 0) scene.params.velocity.fastest_mm_per_s = tests::uniform(random, 1e-12, 1e13);
  scene.params.texture.pattern =
      random() % 2 == 0 ? haptic::TexturePattern::kNoise : haptic::TexturePattern::kGrating;
  scene.effects = {haptic::EffectKind::kSpring};
  for (int e = 1; e < haptic::kEffectKinds; ++e)
    if (random() % 2 == 0) scene.effects.push_back(static_cast<haptic::EffectKind>(e));
  return scene;
}

RC_GTEST_PROP(SceneText, ReadsBackToTheVerySameScene, ()) {
  std::mt19937_64 random(*rc::gen::arbitrary<std::uint64_t>());
  const haptic::Scene scene = anyScene(random);
  RC_PRE(!haptic::sceneProblem(scene).has_value());
  const auto back = haptic::parseScene(haptic::sceneText(scene), "text");
  RC_ASSERT(back.has_value());
  RC_ASSERT(*back == scene);
}

TEST(Journal, EveryEntryReadsBackToTheSameText) {
  std::mt19937_64 random(1);
  engine::FilterSpec spec;
  spec.kind = engine::FilterKind::kGaussian;
  spec.window = 31;
  spec.sigma = 0.1 + 0.2;
  spec.passes = 7;
  spec.scope = engine::FilterScope::kOnlyMarks;
  spec.max_change = 1.0 / 3.0;
  engine::FilterSpec edge_preserving;
  edge_preserving.kind = engine::FilterKind::kTotalVariation;
  edge_preserving.window = 21;
  edge_preserving.range_sigma = 0.1 + 0.7;
  edge_preserving.nesting_mm = 1.0 / 7.0;
  engine::FilterSpec rolling;
  rolling.kind = engine::FilterKind::kClosing;
  rolling.nesting_mm = 0.7;
  rolling.element = engine::Element::kSquare;
  const haptic::LoopPlace there{1234567890123, true}, before{7, false};
  haptic::journal::StepMade filled{11, "Fill holes: curvature", engine::StepKind::kFilter, there},
      levelled = filled;
  engine::FillOptions fill;
  fill.most_extent_mm = 1.0 / 3.0;
  fill.at_border = true;
  filled.maker = fill;
  levelled.maker = engine::LineOptions{engine::LineMethod::kPolynomial, 2, engine::ScanAxis::kY,
                                       engine::Region::kUnmarked, true};
  haptic::journal::StepMade levelled_but_form = levelled;
  levelled_but_form.maker = engine::LineOptions{.form_degree = 3};
  haptic::journal::StepMade removed{12, "Remove samples", engine::StepKind::kFilter, there};
  removed.maker = engine::RemoveOptions{engine::RemoveOptions::Heights::kOutside, -1.0 / 3.0,
                                        std::numeric_limits<double>::infinity(), engine::Region::kMarked};
  const std::vector<haptic::journal::Entry> all = {
      haptic::journal::Begin{3, anyScene(random)},
      haptic::journal::Ticks{17},
      haptic::journal::Lost{4},
      haptic::journal::SceneSet{there, anyScene(random)},
      haptic::journal::StepMade{5, "Median \"5 x 5\"", engine::StepKind::kFilter, before, false},
      haptic::journal::StepMade{6, "Lasso", engine::StepKind::kMark, there, true},
      haptic::journal::StepMade{7, "Edge line", engine::StepKind::kLines, there, false, true},
      haptic::journal::StepMade{8, "Edge suggestion", engine::StepKind::kMark, there, true, false,
                                haptic::journal::EdgesSuggested{0.1 + 0.2, 1.0 / 3.0, 2.0}},
      haptic::journal::RestoreRequested{8, 2},
      haptic::journal::Restored{8, there},
      haptic::journal::FilterBase{1, before},
      haptic::journal::FilterBegun{1, spec},
      haptic::journal::Snapshot{there},
      haptic::journal::Offered{there, true},
      haptic::journal::StateRead{4},
      haptic::journal::Begin{3, anyScene(random), true},
      haptic::journal::StepMade{9, "Form out: plane", engine::StepKind::kForm, there, false, false, {}, true},
      haptic::journal::StepMade{10, "Heights", engine::StepKind::kForm, there, false, false, {}, false, true},
      filled,
      levelled,
      levelled_but_form,
      removed,
      haptic::journal::FilterBegun{2, edge_preserving},
      haptic::journal::FilterBegun{3, rolling},
  };
  for (const haptic::journal::Entry& entry : all) {
    const std::string text = haptic::journalText(entry);
    EXPECT_EQ(text.find('\n'), std::string::npos);
    const auto back = haptic::journalEntry(text);
    ASSERT_TRUE(back) << back.error().line();
    EXPECT_EQ(back->index(), entry.index());
    EXPECT_EQ(haptic::journalText(*back), text);
  }
  const auto back = haptic::journalEntry(haptic::journalText(all[11]));
  ASSERT_TRUE(back);
  EXPECT_EQ(std::get<haptic::journal::FilterBegun>(*back).spec.sigma, spec.sigma);
  EXPECT_EQ(std::get<haptic::journal::FilterBegun>(*back).spec.max_change, spec.max_change);
  const auto last = haptic::journalEntry(haptic::journalText(all.back()));
  ASSERT_TRUE(last);
  EXPECT_EQ(std::get<haptic::journal::FilterBegun>(*last).spec.element, rolling.element);
  const auto other = haptic::journalEntry(haptic::journalText(all[all.size() - 2]));
  ASSERT_TRUE(other);
  EXPECT_EQ(std::get<haptic::journal::FilterBegun>(*other).spec.kind, edge_preserving.kind);
  EXPECT_EQ(std::get<haptic::journal::FilterBegun>(*other).spec.range_sigma, edge_preserving.range_sigma);
  EXPECT_EQ(std::get<haptic::journal::FilterBegun>(*other).spec.nesting_mm, edge_preserving.nesting_mm);
}

// Limits come back to the same bits, those that are infinite too; programs before them refuse the action, and do not replay something else.
TEST(JournalText, OfComputedHeightsHasTheirNumbers) {
  haptic::journal::StepMade step{4, "Fill holes: membrane", engine::StepKind::kFilter, {9, true}};
  engine::FillOptions fill;
  fill.method = engine::FillMethod::kMembrane;
  fill.most_area_mm2 = 0.1;
  step.maker = fill;
  const std::string text = haptic::journalText(step);
  EXPECT_NE(text.find("\"do\":\"computed\""), std::string::npos) << text;
  const auto back = haptic::journalEntry(text);
  ASSERT_TRUE(back) << back.error().line();
  const auto& read = std::get<haptic::journal::StepMade>(*back);
  ASSERT_TRUE(read.maker);
  const auto& options = std::get<engine::FillOptions>(*read.maker);
  EXPECT_EQ(options.method, engine::FillMethod::kMembrane);
  EXPECT_EQ(options.most_area_mm2, 0.1);
  EXPECT_TRUE(std::isinf(options.most_extent_mm));
  EXPECT_EQ(read.kind, engine::StepKind::kFilter);
  EXPECT_FALSE(haptic::journalEntry(
      R"({"do":"computed","state":4,"name":"x","tick":1,"by":{"fill":"glue","border":false}})"));
  EXPECT_FALSE(haptic::journalEntry(
      R"({"do":"computed","state":4,"name":"x","tick":1,"by":{"remove":"everything","region":"all"}})"));
  const engine::RemoveOptions remove{engine::RemoveOptions::Heights::kBetween, -0.1, 0.7,
                                     engine::Region::kAll};
  step.maker = remove;
  const auto again = haptic::journalEntry(haptic::journalText(step));
  ASSERT_TRUE(again) << again.error().line();
  EXPECT_EQ(std::get<engine::RemoveOptions>(*std::get<haptic::journal::StepMade>(*again).maker), remove);
  EXPECT_FALSE(haptic::journalEntry(R"({"do":"computed","state":4,"name":"x","tick":1})"));
}

TEST(Journal, AStepOfBeforeHasNoNumbersOfASuggestionAndKeepsItsText) {
  const std::string old =
      R"({"answered":true,"do":"step","kind":"mark","marks":true,"name":"Edge suggestion","state":2,"tick":71})";
  const auto entry = haptic::journalEntry(old);
  ASSERT_TRUE(entry) << entry.error().line();
  EXPECT_FALSE(std::get<haptic::journal::StepMade>(*entry).suggested);
  EXPECT_EQ(haptic::journalText(*entry), old);
  std::string half = old;
  half.insert(1, R"("suggested":{"scale":1.5},)");
  EXPECT_FALSE(haptic::journalEntry(half));
}

TEST(Journal, AFormKeepsHowItWasFound) {
  haptic::journal::StepMade step{3, "Form out: sphere", engine::StepKind::kForm, {71, true}};
  step.form = true;
  step.fitted = {"sphere", "unmarked", true};
  const auto entry = haptic::journalEntry(haptic::journalText(step));
  ASSERT_TRUE(entry) << entry.error().line();
  const auto& read = std::get<haptic::journal::StepMade>(*entry);
  ASSERT_TRUE(read.fitted);
  EXPECT_EQ(read.fitted->form, "sphere");
  EXPECT_EQ(read.fitted->region, "unmarked");
  EXPECT_TRUE(read.fitted->robust);
  EXPECT_FALSE(read.fitted->through);
  // Three points to their bits, with a radius that was said and without.
  for (const double radius : {0.0, 0.1 + 0.2}) {
    step.fitted = {"plane", "all", false,
                   engine::ThreePoints{{{{0.1, 2}, {1.0 / 3.0, 5e-7}, {-7, 8}}}, radius}};
    const auto again = haptic::journalEntry(haptic::journalText(step));
    ASSERT_TRUE(again) << again.error().line();
    EXPECT_EQ(std::get<haptic::journal::StepMade>(*again).fitted->through, step.fitted->through);
  }
  std::string two = haptic::journalText(step);
  two.replace(two.find(",[-7.0,8.0]"), std::string(",[-7.0,8.0]").size(), "");
  EXPECT_FALSE(haptic::journalEntry(two));
  // As programs before wrote it.
  const std::string old =
      R"({"answered":true,"do":"step","form":true,"kind":"form","name":"Form out: plane","state":2,"tick":71})";
  const auto before = haptic::journalEntry(old);
  ASSERT_TRUE(before) << before.error().line();
  EXPECT_FALSE(std::get<haptic::journal::StepMade>(*before).fitted);
  EXPECT_EQ(haptic::journalText(*before), old);
  EXPECT_FALSE(haptic::journalEntry(std::string(old).insert(1, R"("fitted":{"form":"plane"},)")));
}

TEST(Journal, ALevelKeepsTheSearchThatItNamedWhenItWasWritten) {
  const auto levelOf = [](const char* text) {
    const auto entry = haptic::journalEntry(text);
    EXPECT_TRUE(entry) << text;
    return entry ? std::get<haptic::journal::Begin>(*entry).scene.level : haptic::ContactLevel::kCertified;
  };
  const char* const fewer =
      R"({"do":"begin","state":0,"scene":"[contact]\nlevel = \"paper\"\nsearch_rounds = 5"})";
  EXPECT_EQ(levelOf(R"({"do":"begin","state":0,"scene":""})"), haptic::ContactLevel::kDescent);
  EXPECT_EQ(levelOf(fewer), haptic::ContactLevel::kDescent);
  EXPECT_EQ(levelOf(R"({"do":"begin","state":0,"contact":1,"scene":""})"), haptic::ContactLevel::kDescent);
  EXPECT_EQ(levelOf(R"({"do":"begin","state":0,"contact":2,"scene":""})"), haptic::ContactLevel::kPaper);
  EXPECT_EQ(levelOf(R"({"do":"begin","state":0,"scene":"contact = { level = \"certified\" }"})"),
            haptic::ContactLevel::kCertified);
}

TEST(Journal, ABallHasNoBoundOfItsSearchesWhereThereWasNoneWhenItWasWritten) {
  const auto searchesOf = [](const char* text) {
    const auto entry = haptic::journalEntry(text);
    EXPECT_TRUE(entry) << text;
    return entry ? std::get<haptic::journal::Begin>(*entry).scene.ball_searches : -1;
  };
  EXPECT_EQ(searchesOf(R"({"do":"begin","state":0,"scene":"tip = \"sphere\""})"), 0);
  EXPECT_EQ(searchesOf(R"({"do":"begin","state":0,"contact":2,"scene":"tip = \"sphere\""})"), 0);
  EXPECT_EQ(searchesOf(R"({"do":"begin","state":0,"contact":3,"scene":"tip = \"sphere\""})"), 64);
  EXPECT_EQ(searchesOf(R"({"do":"begin","state":0,"contact":4,"scene":"tip = \"sphere\""})"),
            haptic::kBallSearches);
  // Written again by this version, it still has none.
  haptic::Scene scene;
  scene.ball_searches = 0;
  EXPECT_EQ(haptic::parseScene(haptic::sceneText(scene), "again")->ball_searches, 0);
}

TEST(Journal, ABallTakesTheStepsAndMinimaThatItHadWhenItWasWritten) {
  const auto sceneOf = [](const char* text) {
    const auto entry = haptic::journalEntry(text);
    EXPECT_TRUE(entry) << text;
    return entry ? std::get<haptic::journal::Begin>(*entry).scene : haptic::Scene{};
  };
  for (const char* before : {R"({"do":"begin","state":0,"scene":"tip = \"sphere\""})",
                             R"({"do":"begin","state":0,"contact":3,"scene":"tip = \"sphere\""})"}) {
    const haptic::Scene scene = sceneOf(before);
    EXPECT_EQ(scene.ball_steps, haptic::BallSteps::kInSpace);
    EXPECT_EQ(scene.ball_minima, haptic::BallMinima::kPieces);
    // Written again by this version, it still has them.
    EXPECT_EQ(*haptic::parseScene(haptic::sceneText(scene), "again"), scene);
  }
  const haptic::Scene now = sceneOf(R"({"do":"begin","state":0,"contact":4,"scene":"tip = \"sphere\""})");
  EXPECT_EQ(now.ball_steps, haptic::BallSteps::kInPlan);
  EXPECT_EQ(now.ball_minima, haptic::BallMinima::kAll);
}

TEST(Journal, ABallHasNoBoundOfItsWorkWhereThereWasNoneWhenItWasWritten) {
  const auto workOf = [](const char* text) {
    const auto entry = haptic::journalEntry(text);
    EXPECT_TRUE(entry) << text;
    return entry ? std::get<haptic::journal::Begin>(*entry).scene.ball_work : -1;
  };
  EXPECT_EQ(workOf(R"({"do":"begin","state":0,"scene":"tip = \"sphere\""})"), 0);
  EXPECT_EQ(workOf(R"({"do":"begin","state":0,"contact":4,"scene":"tip = \"sphere\""})"), 0);
  EXPECT_EQ(workOf(R"({"do":"begin","state":0,"contact":5,"scene":"tip = \"sphere\""})"), haptic::kBallWork);
  // Written again by this version, it still has none.
  haptic::Scene scene;
  scene.ball_work = 0;
  EXPECT_EQ(haptic::parseScene(haptic::sceneText(scene), "again")->ball_work, 0);
}

TEST(Journal, WhatIsNoEntryIsRefusedByName) {
  for (const char* text :
       {"", "{", "[]", "{}", R"({"do":"dance"})", R"({"do":"ticks"})", R"({"do":"ticks","count":"x"})",
        R"({"do":"filter","id":1,"filter":"blur","window":3,"passes":1,"marks":"keep"})",
        R"({"do":"begin","state":0,"scene":"tip = 3"})", R"({"do":"begin","state":0,"scene":"","contact":6})",
        R"({"do":"begin","state":0,"scene":"","contact":0})", R"({"do":7})", "3"}) {
    const auto entry = haptic::journalEntry(text);
    ASSERT_FALSE(entry) << text;
    EXPECT_EQ(entry.error().kind, engine::ErrorKind::kInput) << text;
  }
}

RC_GTEST_PROP(MarkCodec, ChangesPutOnTheFieldBeforeGiveTheOneAfter, ()) {
  std::mt19937_64 random(*rc::gen::arbitrary<std::uint64_t>());
  const int width = *rc::gen::inRange(1, 200), height = *rc::gen::inRange(1, 200);
  const auto scattered = [&](const engine::Version& start, int count) {
    engine::LiveField field(start, engine::Growth::kAllowed);
    for (int i = 0; i < count; ++i)
      RC_ASSERT(field.setMark(static_cast<int>(random() % width), static_cast<int>(random() % height),
                              random() % 3 != 0));
    return field.snapshot();
  };
  const engine::Version plain = tests::randomField(random, width, height, 1, 1, 1, 0.1);
  const engine::Version before = scattered(plain, 300);
  const engine::Version after = scattered(before, 200);
  const std::string changes = haptic::packMarkChanges(before, after);
  const auto back = haptic::applyMarkChanges(before, changes);
  RC_ASSERT(back.has_value());
  RC_ASSERT(engine::contentHash(*back) == engine::contentHash(after));
  // Put twice they change nothing more.
  const auto twice = haptic::applyMarkChanges(*back, changes);
  RC_ASSERT(twice.has_value() && engine::contentHash(*twice) == engine::contentHash(after));
  RC_ASSERT(!haptic::applyMarkChanges(before, changes + "x").has_value());
}

// Locating an edge line and undoing it: lines and marks, to the bit.
TEST(LineChange, LeadsFromOneVersionToTheOtherAndCutAnywhereToNone) {
  engine::Grid grid;
  grid.width = 200;
  grid.height = 90;
  std::vector<std::uint8_t> marks(200 * 90, 0), other(marks);
  marks[4000] = other[17] = other[9000] = 1;
  const std::vector<float> z(marks.size(), 1.0F);
  const auto lines = [](double y) {
    engine::EdgeLine line;
    line.id = 4;
    for (int i = 0; i < 20; ++i) {
      engine::EdgePoint p;
      p.position = {10.0 + i, y};
      p.located = i % 3 != 0;
      line.points.push_back(p);
    }
    return std::make_shared<const std::vector<engine::EdgeLine>>(1, line);
  };
  const engine::Version before = engine::makeField(grid, z, marks).withLines(lines(30.0));
  const engine::Version after = engine::makeField(grid, z, other).withLines(lines(41.5));
  for (const auto& [from, to] : {std::pair{before, after}, {after, before}, {before, before}}) {
    const std::string change = haptic::packLineChange(from, to);
    const auto made = haptic::applyLineChange(from, change);
    ASSERT_TRUE(made) << made.error().line();
    EXPECT_EQ(engine::contentHash(*made), engine::contentHash(to));
    ASSERT_NE(made->lines(), nullptr);
    EXPECT_EQ(engine::packLines(made->lines()), engine::packLines(to.lines()));
    for (std::size_t size = 0; size < change.size(); ++size)
      EXPECT_FALSE(haptic::applyLineChange(from, change.substr(0, size))) << size;
  }
}

}  // namespace
}  // namespace fettle::app
