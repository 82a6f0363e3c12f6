#include "render/plan/plan.h"

#include <algorithm>
#include <cmath>
#include <map>

#include <gtest/gtest.h>

#include "engine/field/grid.h"
#include "render/config.h"
#include "render/plan/colour_map.h"
#include "render/plan/number_text.h"
#include "tests/render/support/fields.h"

namespace fettle::render {
namespace {

TEST(ValueRange, OneSpikeDoesNotEatTheColours) {
  const ValueSpan span =
      heightSpan(fieldOf(gridOf(200, 200), [](int c, int r) { return c == 7 && r == 9 ? 1e6 : c * 0.01; }));
  EXPECT_EQ(span.extreme.high, 1e6F);
  EXPECT_LT(span.robust.high, 2.3);
  EXPECT_GE(span.robust.high, 1.98);
}

TEST(ValueRange, TheTrueExtremesAreKeptWhenNothingIsWild) {
  const ValueSpan span = heightSpan(fieldOf(gridOf(100, 30), [](int c, int r) { return c - r; }));
  EXPECT_EQ(span.robust, (ValueRange{-29, 99}));
}

TEST(ValueRange, AllHolesIsEmptyAndAConstantIsAPoint) {
  EXPECT_TRUE(heightSpan(fieldOf(gridOf(5, 5), [](int, int) { return kNan; })).empty);
  EXPECT_EQ(heightSpan(fieldOf(gridOf(90, 90), [](int, int) { return 4; })).robust, (ValueRange{4, 4}));
}

TEST(ValueRange, DeviationIsSymmetricAboutZeroAndIgnoresUntouchedSamples) {
  const auto base = [](int c, int r) { return c * 0.5 + r; };
  const engine::Version a = fieldOf(gridOf(300, 300), base);
  const engine::Version b = fieldOf(gridOf(300, 300), [&](int c, int r) {
    return base(c, r) + (c < 40 && r < 40 ? -0.25 : 0.0) + (c == 200 && r == 200 ? 50.0 : 0.0);
  });
  const ValueSpan span = deviationSpan(b, a);
  EXPECT_EQ(span.extreme, (ValueRange{-0.25, 50}));
  EXPECT_EQ(span.robust, (ValueRange{-0.25, 0.25}));
  EXPECT_EQ(deviationSpan(a, a).robust, (ValueRange{0, 0}));
}

TEST(ValueRange, ChangesAreSeenBesideAnEdgeThatMoved) {
  // Twenty samples in a hundred moved by 3, the rest by some hundredths.
  const engine::Version a = fieldOf(gridOf(200, 200), [](int, int) { return 0.0; });
  const engine::Version b = fieldOf(gridOf(200, 200), [](int c, int r) {
    return c % 5 == 0 ? 3.0 : 0.01 + 0.02 * ((r * 37 + c * 11) % 100) / 100.0;
  });
  const ValueSpan span = deviationSpan(b, a);
  EXPECT_EQ(span.extreme.high, 3.0);
  // The median is 0.0225 or so: of a hundred values 62.5 in the middle of those below 3.
  EXPECT_NEAR(span.robust.high, kUsualChanges * 0.0225, 0.01);
  EXPECT_NEAR(span.share, 0.8, 0.01);
}

TEST(ValueSample, SharesAndQuantilesAreThoseOfAllSamples) {
  const engine::Version field =
      fieldOf(gridOf(200, 100), [](int c, int r) { return c < 3 && r < 3 ? kNan : c + 200.0 * r; });
  const ValueSample heights = heightSample(field);
  EXPECT_EQ(heights.extreme, (ValueRange{3, 19999}));
  EXPECT_NEAR(heights.quantile(0.25), 5000, 100);
  EXPECT_NEAR(heights.middle(0.9).low, 1000, 100);
  EXPECT_NEAR(heights.within(5000, 15000), 0.5, 0.01);
  EXPECT_EQ(heights.within(2, 1), 0.0);
  // Only what changed counts, and by its size.
  const engine::Version changed = fieldOf(gridOf(200, 100), [](int c, int r) {
    return c < 3 && r < 3 ? kNan : c + 200 * r + (c < 100 ? 0.0 : c < 150 ? -1.0 : 2.0);
  });
  const ValueSample changes = deviationSample(changed, field);
  EXPECT_EQ(changes.extreme, (ValueRange{-1, 2}));
  EXPECT_NEAR(changes.symmetric(0.4).high, 1.0, 1e-9);
  EXPECT_NEAR(changes.symmetric(1.0).high, 2.0, 1e-9);
  EXPECT_TRUE(deviationSample(field, field).empty());
  EXPECT_TRUE(heightSample(fieldOf(gridOf(5, 5), [](int, int) { return kNan; })).empty());
}

TEST(ValueRange, OfInvertedFieldsTheEndsChangePlacesAndSigns) {
  const engine::Version a = fieldOf(gridOf(130, 70), [](int c, int r) { return 0.1 * c + 0.03 * r; });
  const engine::Version b =
      fieldOf(gridOf(130, 70), [](int c, int r) { return 0.1 * c + 0.03 * r + (c < 9 ? 0.5 : 0.0); });
  const auto expectEqual = [](const ValueSpan& x, const ValueSpan& y) {
    EXPECT_EQ(x.robust, y.robust);
    EXPECT_EQ(x.extreme, y.extreme);
    EXPECT_EQ(x.empty, y.empty);
  };
  expectEqual(negated(heightSpan(a)), heightSpan(a.inverted()));
  expectEqual(negated(negated(heightSpan(a))), heightSpan(a));
  expectEqual(negated(deviationSpan(b, a)), deviationSpan(b.inverted(), a.inverted()));
  expectEqual(negated(heightSpan(fieldOf(gridOf(5, 5), [](int, int) { return kNan; }))), {});
}

TEST(Plan, ExaggerationIsOneForReadableReliefAndRoundOtherwise) {
  EXPECT_EQ(chooseExaggeration(10, 100), 1.0);
  EXPECT_EQ(chooseExaggeration(0, 100), 1.0);
  EXPECT_EQ(chooseExaggeration(0.01, 100), 1000.0);  // 0.18 / 1e-4 = 1800
  EXPECT_EQ(chooseExaggeration(1000, 640), 0.1);     // 0.18 / 1.56 = 0.115
}

TEST(Plan, RefusesWhatIsOutsideTheStatedRanges) {
  const std::vector<engine::Version> fields{fieldOf(gridOf(8, 8), [](int c, int) { return c; })};
  PictureSpec good;
  good.view.width = good.view.height = 100;
  const auto plan = [&](const PictureSpec& spec) {
    return planPicture(spec, fields, spansOf(fields, spec.deviation_from),
                       layOut(spec.view, spec.decoration, 1, Titles::kNone));
  };
  ASSERT_TRUE(plan(good));
  const auto refused = [&](auto change) {
    PictureSpec spec = good;
    change(spec);
    const engine::Result<PicturePlan> result = plan(spec);
    return !result && result.error().kind == engine::ErrorKind::kInput;
  };
  EXPECT_TRUE(refused([](PictureSpec& s) { s.view.width = 0; }));
  EXPECT_TRUE(refused([](PictureSpec& s) { s.view.height = kLargestPicture + 1; }));
  EXPECT_TRUE(refused([](PictureSpec& s) { s.view.elevation_deg = -0.5; }));
  EXPECT_FALSE(refused([](PictureSpec& s) { s.view.elevation_deg = 0; }));
  EXPECT_TRUE(refused([](PictureSpec& s) { s.view.centre_x = 102; }));
  EXPECT_TRUE(refused([](PictureSpec& s) { s.view.centre_y = std::nan(""); }));
  EXPECT_TRUE(refused([](PictureSpec& s) { s.view.centre_z = -101; }));
  EXPECT_TRUE(refused([](PictureSpec& s) { s.view.azimuth_deg = std::nan(""); }));
  EXPECT_TRUE(refused([](PictureSpec& s) { s.view.zoom = 0; }));
  for (const double most : {1e-9, 1e9})
    EXPECT_FALSE(refused([&](PictureSpec& s) { s.view.vertical_exaggeration = most; })) << most;
  for (const double beyond : {-1.0, 0.9e-9, 1.1e9})
    EXPECT_TRUE(refused([&](PictureSpec& s) { s.view.vertical_exaggeration = beyond; })) << beyond;
  EXPECT_TRUE(refused([](PictureSpec& s) { s.marks_opacity = 1.5; }));
  EXPECT_TRUE(refused([](PictureSpec& s) { s.range = ValueRange{1, 1}; }));
}

TEST(NumberText, TicksAreRoundAndInside) {
  const std::vector<Tick> t = ticks(-2.96, 2.96, 6);
  ASSERT_EQ(t.size(), 5U);
  EXPECT_EQ(t.front().text, "\u22122");
  EXPECT_EQ(t[2].text, "0");
  EXPECT_EQ(ticks(0, 0.5, 6).back().text, "0.5");
  EXPECT_TRUE(ticks(1, 1, 5).empty());
  for (const double size : {1e-9, 0.003, 7.0, 1e6})
    EXPECT_TRUE(ticks(-size, size, 7).size() >= 3 && ticks(-size, size, 7).size() <= 9) << size;
}

TEST(NumberText, UnitsChangeOnlyWhenNumbersReadBadly) {
  EXPECT_EQ(shownUnit({"m", 1000}, 43.0, 0.05, 5e4).name, "m");
  const ShownUnit u = shownUnit({"m", 1000}, 1.3e-4, 0.05, 5e4);
  EXPECT_EQ(u.name, "\u00b5m");
  EXPECT_DOUBLE_EQ(u.per_unit, 1e6);
  EXPECT_EQ(shownUnit({"ft", 304.8}, 1e-6, 0.05, 5e4).name, "ft");
  EXPECT_EQ(roundDown125(7.3), 5.0);
  EXPECT_EQ(roundDown125(1.0), 1.0);
  EXPECT_DOUBLE_EQ(roundDown125(0.0021), 0.002);
}

engine::Grid squareGrid(double spacing, const engine::LengthUnit& unit) {
  engine::Grid grid;
  grid.width = grid.height = 101;
  grid.spacing_x = grid.spacing_y = spacing;
  grid.lateral_unit = grid.height_unit = unit;
  return grid;
}

TEST(NumberText, AFieldHasOneUnitForEachQuantity) {
  const FieldUnits microscope = fieldUnits(squareGrid(4e-9, {"m", 1000}), 0.0, 1.3e-7);
  EXPECT_EQ(microscope.height.name, "nm");
  EXPECT_EQ(microscope.change.name, "nm");
  EXPECT_EQ(microscope.length.name, "nm");
  EXPECT_DOUBLE_EQ(microscope.height.per_unit, 1e9);
  EXPECT_NEAR(microscope.height_step, 0.013, 1e-9);
  const FieldUnits part = fieldUnits(squareGrid(0.05, {"mm", 1}), -3.0, 30.0);
  EXPECT_EQ(part.height.name, "mm");
  EXPECT_EQ(part.change.name, "\u00b5m");
  EXPECT_EQ(part.length.name, "mm");
  const FieldUnits mountain = fieldUnits(squareGrid(10.0, {"m", 1000}), 100.0, 5100.0);
  EXPECT_EQ(mountain.height.name, "m");
  EXPECT_EQ(mountain.change.name, "m");
  EXPECT_EQ(mountain.length.name, "m");
  const FieldUnits feet = fieldUnits(squareGrid(1e-6, {"ft", 304.8}), 0.0, 1e-7);
  EXPECT_EQ(feet.height.name, "ft");
  EXPECT_EQ(feet.change.name, "ft");
  EXPECT_EQ(feet.length.name, "ft");
  // Without any extent: its own, and still a step to read to.
  const FieldUnits flat = fieldUnits(squareGrid(0.05, {"mm", 1}), 0.0, 0.0);
  EXPECT_EQ(flat.height.name, "mm");
  EXPECT_GT(flat.height_step, 0.0);
}

TEST(NumberText, DeviationsKeepTheUnitOfChangesWhileReadable) {
  const ShownUnit change{"\u00b5m", 1e3};
  EXPECT_EQ(deviationUnit({"mm", 1}, change, 0.02).name, "\u00b5m");
  EXPECT_EQ(deviationUnit({"mm", 1}, change, 3.0).name, "\u00b5m");
  EXPECT_EQ(deviationUnit({"mm", 1}, change, 1e-7).name, "nm");
  EXPECT_EQ(deviationUnit({"mm", 1}, change, 1e6).name, "km");
  EXPECT_EQ(deviationUnit({"mm", 1}, change, 0.0).name, "\u00b5m");
}

TEST(NumberText, DecimalsFollowTheStep) {
  EXPECT_EQ(decimalsFor(10.0), 0);
  EXPECT_EQ(decimalsFor(1.0), 0);
  EXPECT_EQ(decimalsFor(0.1), 1);
  EXPECT_EQ(decimalsFor(0.013), 2);
  EXPECT_EQ(decimalsFor(1e-300), 12);
}

// What the decorations of a picture says, letter by letter in drawing order; spaces draw nothing.
std::u32string saying(const std::vector<gpu::Quad>& quads, Glyphs& glyphs) {
  std::map<std::pair<int, int>, char32_t> letters;
  for (const char32_t c :
       std::u32string(U"0123456789.,+e\u2212\u2026\u00d7\u2248[]%:\u00b5abcdfghijklmnopqrstuvwxyz"))
    for (int px = 6; px <= 40; ++px)
      for (const auto weight : {Glyphs::Weight::kRegular, Glyphs::Weight::kBold}) {
        const Glyphs::Glyph& g = glyphs.glyph(c, px, weight);
        letters[{g.x, g.y}] = c;
      }
  std::u32string out;
  for (const gpu::Quad& quad : quads)
    if (quad.fill.x == gpu::kFillGlyph) {
      const auto found = letters.find({static_cast<int>(quad.uv.x), static_cast<int>(quad.uv.y)});
      out += found == letters.end() ? U'?' : found->second;
    }
  return out;
}

TEST(Decorations, AFigureIsShownWholeOrLeftOutWithAWarningButNeverCut) {
  struct Case {
    ValueRange range;
    std::string note;
    std::u32string lowest, highest;
  };
  const std::vector<Case> cases{
      {{-20, 40}, "lowest \u221230.0\nhighest 1713\nbar: 99.5 %", U"lowest\u221230.0", U"highest1713"},
      {{-0.1, 0.1}, "lowest \u22120.118\nhighest 0.123", U"lowest\u22120.118", U"highest0.123"},
      {{123456.25, 123456.75},
       "lowest \u22121.23e+08\nhighest 1.23e+08",
       U"lowest\u22121.23e+08",
       U"highest1.23e+08"},
      // Inches have no other unit to go to.
      {{4123456.25, 4123456.75}, "lowest 0\nhighest \u22121.23e+08", U"lowest0", U"highest\u22121.23e+08"}};
  int whole = 0, left_out = 0;
  for (const auto& [w, h] :
       {std::pair{800, 500}, {3000, 200}, {200, 140}, {200, 3000}, {480, 300}, {1280, 800}})
    for (const int panels : {1, 2})
      for (const Case& c : cases) {
        View view;
        view.width = w;
        view.height = h;
        const Layout layout = layOut(view, Decoration::kFull, panels, Titles::kNone);
        DecorationContent f;
        f.range = c.range;
        f.above = f.below = true;
        f.quantity = "deviation";
        f.note = c.note;
        f.height_unit = {"in", 25.4};
        f.lateral_unit = {"mm", 1.0};
        f.exaggeration = 1000;
        engine::Result<Glyphs> glyphs = Glyphs::create();
        ASSERT_TRUE(glyphs);
        std::vector<std::string> warnings;
        const std::vector<gpu::Quad> quads = decorationQuads(
            layout, view, f, paletteOf(Theme::kLight, ColourMap::kViridis), *glyphs, warnings);
        const std::u32string said = saying(quads, *glyphs);
        ASSERT_FALSE(said.empty());
        EXPECT_EQ(said.find(U'\u2026'), said.npos) << w << " x " << h << ' ' << c.note;
        EXPECT_EQ(said.find(U'?'), said.npos) << w << " x " << h << ' ' << c.note;
        for (const gpu::Quad& quad : quads)
          EXPECT_LE(quad.pixels.z, static_cast<float>(w + 1)) << w << " x " << h;
        const bool noted = said.find(c.lowest) != said.npos && said.find(c.highest) != said.npos;
        const bool warned = std::any_of(warnings.begin(), warnings.end(), [](const std::string& warning) {
          return warning.find("note") != std::string::npos;
        });
        EXPECT_NE(noted, warned) << w << " x " << h << ' ' << c.note;
        whole += noted;
        left_out += warned;
        // The two pictures the rule comes from have room for the figures.
        if (w == 800 || w == 1280) {
          EXPECT_TRUE(noted) << w << " x " << h << ' ' << c.note;
        }
      }
  EXPECT_GT(whole, 0);
  EXPECT_GT(left_out, 0);
}

TEST(ColourMaps, EndsAndMiddleAreTheSourcesOwn) {
  // First and last line of the published tables, 8-bit.
  const auto code = [](const glm::vec3& c) {
    return glm::ivec3(
        glm::round(glm::dvec3(srgbFromLinear(c.x), srgbFromLinear(c.y), srgbFromLinear(c.z)) * 255.0));
  };
  EXPECT_EQ(code(colourTable(ColourMap::kViridis).front()), glm::ivec3(68, 1, 84));
  EXPECT_EQ(code(colourTable(ColourMap::kViridis).back()), glm::ivec3(253, 231, 37));
  EXPECT_EQ(code(colourTable(ColourMap::kCividis).front()), glm::ivec3(0, 34, 78));
  const glm::vec3 zero = mapped(colourTable(ColourMap::kDiverging), 0.0, {-3, 3});
  EXPECT_GT(std::min({zero.x, zero.y, zero.z}), 0.97F);
}

TEST(ColourMaps, AToleranceIsTheMiddleColourAndStepsAreOneColourEach) {
  const ValueRange range{-4, 4};
  const glm::vec3 zero = mapped(colourTable(ColourMap::kDiverging), 0.0, range);
  const auto apart = [&](const ColourTable& table, double value) {
    return glm::length(mapped(table, value, range) - zero);
  };
  const ColourTable tolerant = tableOf({.tolerance = 1.0}, Quantity::kDeviation, range);
  // A step of the table is 8 / 255.
  for (const double value : {-0.96, -0.5, 0.0, 0.7, 0.96}) EXPECT_LT(apart(tolerant, value), 1e-6) << value;
  for (const double value : {-1.04, 1.04}) EXPECT_GT(apart(tolerant, value), 0.1) << value;
  EXPECT_EQ(tolerant.front(), colourTable(ColourMap::kDiverging).front());
  EXPECT_EQ(tolerant.back(), colourTable(ColourMap::kDiverging).back());
  // One smaller than a step of the table leaves what did not change as it is, and so do steps.
  for (const Colouring& colouring : {Colouring{.tolerance = 0.01}, Colouring{.steps = true},
                                     Colouring{.steps = true, .tolerance = 0.01}}) {
    const ColourTable table = tableOf(colouring, Quantity::kDeviation, range);
    EXPECT_LT(apart(table, 0.0), 1e-6);
    EXPECT_LT(glm::length(table[128] - zero), 1e-6F);
    EXPECT_GT(apart(table, 0.5), 0.02);
  }
  // Of heights it is none, and beyond the range all are within it.
  EXPECT_EQ(tableOf({.tolerance = 1.0}, Quantity::kHeight, range), colourTable(ColourMap::kViridis));
  const ColourTable all = tableOf({.tolerance = 9.0}, Quantity::kDeviation, range);
  for (const double value : {-4.0, 0.0, 4.0}) EXPECT_LT(apart(all, value), 1e-6) << value;
  ColourTable steps = tableOf({.steps = true}, Quantity::kHeight, range);
  EXPECT_EQ(std::unique(steps.begin(), steps.end()) - steps.begin(), kColourSteps);
}

TEST(Plan, TheScaleBarHasTheUnitOfLengthsAcrossTheField) {
  engine::Grid grid = gridOf(64, 64);
  grid.spacing_x = grid.spacing_y = 0.004;
  const std::vector<engine::Version> fields{fieldOf(grid, [](int c, int) { return c; })};
  const PictureSpec spec;
  const auto plan =
      planPicture(spec, fields, spansOf(fields, {}), layOut(spec.view, spec.decoration, 1, Titles::kNone));
  ASSERT_TRUE(plan);
  EXPECT_EQ(plan->decorations.length_unit.name, fieldUnits(grid, 0.0, 63.0).length.name);
  EXPECT_EQ(plan->decorations.length_unit.name, "mm");
}

TEST(Plan, ContourLinesAreAsFarApartAsAskedOrAtTheStepsOfTheBar) {
  const std::vector<engine::Version> fields{fieldOf(gridOf(64, 64), [](int c, int) { return c; })};
  PictureSpec spec;
  spec.contours = Contours::kShow;
  const auto plan = [&] {
    return planPicture(spec, fields, spansOf(fields, {}),
                       layOut(spec.view, spec.decoration, 1, Titles::kNone));
  };
  EXPECT_EQ(plan()->contour_step, 5.0);
  spec.colouring.contour_step = 0.75;
  EXPECT_EQ(plan()->contour_step, 0.75);
  EXPECT_EQ(plan()->panels[0].uniforms.colouring.z, 0.75F);
  EXPECT_NE(plan()->decorations.note.find("lines: 0.75"), std::string::npos);
  spec.colouring.contour_step = -1.0;
  EXPECT_FALSE(plan());
  spec.colouring = {.tolerance = std::nan("")};
  EXPECT_FALSE(plan());
}

// Heights over saddles, depths below them: half of a bar about zero would be of values that cannot be.
TEST(Plan, ADifferenceOfOneSignHasItsNameAndTheBarFromZero) {
  const auto level = [](int, int) { return 0; };
  const std::vector<engine::Version> hills{fieldOf(gridOf(64, 64), [](int c, int) { return c % 8; })},
      dales{fieldOf(gridOf(64, 64), [](int c, int) { return -(c % 8); })};
  PictureSpec spec;
  spec.deviation_from = fieldOf(gridOf(64, 64), level);
  const auto plan = [&](const std::vector<engine::Version>& fields) {
    return *planPicture(spec, fields, spansOf(fields, spec.deviation_from),
                        layOut(spec.view, spec.decoration, 1, Titles::kNone));
  };
  EXPECT_EQ(plan(hills).range, (ValueRange{-7, 7}));
  EXPECT_EQ(plan(hills).decorations.quantity, "deviation");
  EXPECT_EQ(plan(hills).map, ColourMap::kDiverging);
  spec.difference = {"hill height", true};
  EXPECT_EQ(plan(hills).range, (ValueRange{0, 7}));
  EXPECT_EQ(plan(hills).decorations.range, (ValueRange{0, 7}));
  EXPECT_EQ(plan(hills).decorations.quantity, "hill height");
  EXPECT_FALSE(plan(hills).decorations.below);
  EXPECT_EQ(plan(hills).map, ColourMap::kViridis);
  EXPECT_EQ(plan(dales).range, (ValueRange{-7, 0}));
  EXPECT_FALSE(plan(dales).decorations.above);
  spec.range = ValueRange{-3, 3};
  EXPECT_EQ(plan(hills).range, (ValueRange{0, 3}));
  EXPECT_TRUE(plan(hills).decorations.above);
}

// Colours stay as they were planned while heights are edited; what stands below them is what there is now.
TEST(Plan, TheNoteNamesTheExtremesOfNowWhateverTheColoursWereChosenBy) {
  const auto sloped = [](int c, int) { return c; };
  const std::vector<engine::Version> before{fieldOf(gridOf(64, 64), sloped)};
  const PictureSpans spans = spansOf(before, {});
  const std::vector<engine::Version> after{
      fieldOf(gridOf(64, 64), [](int c, int r) { return c == 9 && r == 7 ? -500 : c; })};
  PictureSpec spec;
  const auto decorations = [&](const std::vector<engine::Version>& fields) {
    return planPicture(spec, fields, spans, layOut(spec.view, spec.decoration, 1, Titles::kNone))
        ->decorations;
  };
  EXPECT_FALSE(decorations(before).below);
  EXPECT_EQ(decorations(before).note, "");
  EXPECT_TRUE(decorations(after).below);
  EXPECT_EQ(decorations(after).note, "lowest \u2212500\nhighest 63.0");
  EXPECT_EQ(decorations(after).range, decorations(before).range);
}

TEST(Plan, ATitleInTheMarginMovesNoPlot) {
  View view;
  view.width = 1100;
  view.height = 758;
  for (const double scale : {0.7, 0.87, 1.0, 1.74})
    for (const int panels : {1, 2, 3}) {
      const Layout none = layOut(view, Decoration::kFull, panels, Titles::kNone, scale);
      const Layout titled = layOut(view, Decoration::kFull, panels, Titles::kInMargin, scale);
      EXPECT_EQ(titled.plots, none.plots);
      // Letters with accents and all: the margin holds them.
      EXPECT_LE(0.85 * titled.title_px + titled.title_above, titled.plots.front().y);
      EXPECT_GT(layOut(view, Decoration::kFull, panels, Titles::kAbove, scale).plots.front().y,
                none.plots.front().y);
    }
}

TEST(Plan, TextIsAsLargeAsTheDisplayAsksAndLeavesRoomForTheSurface) {
  View view;
  view.width = 1280;
  view.height = 800;
  EXPECT_EQ(layOut(view, Decoration::kFull, 1, Titles::kAbove).text_px, 15);
  for (const double scale : {0.87, 1.0, 1.74, 2.5})
    EXPECT_EQ(layOut(view, Decoration::kFull, 1, Titles::kAbove, scale).text_px, std::lround(15.0 * scale));
  // Smaller than ten pixels it could not be read.
  EXPECT_EQ(layOut(view, Decoration::kFull, 1, Titles::kAbove, 0.6).text_px, 10);
  // The display says how large, not the picture: a larger one has the same text.
  view.width = 2560;
  view.height = 1600;
  EXPECT_EQ(layOut(view, Decoration::kFull, 1, Titles::kAbove, 1.0).text_px, 15);
  for (const auto& [w, h] : {std::pair{400, 1000}, {2000, 260}, {300, 200}}) {
    view.width = w;
    view.height = h;
    const Layout layout = layOut(view, Decoration::kFull, 1, Titles::kAbove, 4.0);
    EXPECT_GE(layout.plots[0].width, 0.5 * w) << w << " x " << h;
    EXPECT_GE(layout.plots[0].height, 0.5 * h) << w << " x " << h;
  }
  // As large as three fifths of the picture for the surface allow.
  for (const auto& [w, h] : {std::pair{1280, 800}, {800, 1100}, {2000, 700}}) {
    view.width = w;
    view.height = h;
    const Rectangle plot = layOut(view, Decoration::kFull, 1, Titles::kAbove, 5.9).plots[0];
    // Margins are whole pixels each.
    EXPECT_NEAR(std::min(1.0 * plot.width / w, 1.0 * plot.height / h), 0.6, 2.0 / h) << w << " x " << h;
  }
}

}  // namespace
}  // namespace fettle::render
