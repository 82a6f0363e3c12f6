// What stands around the surface, from the quads that draw it: what it says is right to the pixel, and nothing is cut in two.
#include "render/plan/overlay.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "render/plan/plan.h"

namespace fettle::render {
namespace {

class Decorated {
 public:
  Decorated() : glyphs_(*Glyphs::create()), palette_(paletteOf(Theme::kLight, ColourMap::kViridis)) {
    view_.width = 1280;
    view_.height = 800;
    content.range = {0.0, 1.0};
    content.quantity = "height";
    content.lateral_unit = {"mm", 1.0};
    content.pixels_per_mm = 4.0;
  }
  [[nodiscard]] std::vector<gpu::Quad> quads() {
    warnings.clear();
    return decorationQuads(layout(), view_, content, palette_, glyphs_, warnings);
  }
  [[nodiscard]] std::vector<gpu::Quad> quadsOf(const Palette& palette) {
    warnings.clear();
    return decorationQuads(layout(), view_, content, palette, glyphs_, warnings);
  }
  [[nodiscard]] Layout layout() const {
    return layOut(view_, Decoration::kFull, panels_, Titles::kAbove, scale_);
  }
  [[nodiscard]] const Palette& palette() const { return palette_; }
  void setWidth(int width, int panels = 1) {
    view_.width = width;
    panels_ = panels;
  }
  void setScale(double scale) { scale_ = scale; }

  DecorationContent content;
  std::vector<std::string> warnings;

 private:
  View view_;
  int panels_ = 1;
  double scale_ = 0.0;  // as large as the picture
  Glyphs glyphs_;
  Palette palette_;
};

bool hasColour(const gpu::Quad& quad, const glm::vec3& colour) {
  return quad.colour.x == colour.x && quad.colour.y == colour.y && quad.colour.z == colour.z;
}
std::size_t letters(const std::vector<gpu::Quad>& quads) {
  return static_cast<std::size_t>(std::count_if(
      quads.begin(), quads.end(), [](const gpu::Quad& q) { return q.fill.x == gpu::kFillGlyph; }));
}
bool same(const gpu::Quad& a, const gpu::Quad& b) {
  return a.pixels == b.pixels && a.uv == b.uv && a.colour == b.colour && a.fill == b.fill;
}

TEST(ScaleBar, IsAsManyPixelsLongAsTheLengthThatItNames) {
  Decorated picture;
  const double at = picture.layout().plots[0].x;
  for (const double pixels_per_mm : {0.37, 4.0, 91.0}) {
    picture.content.pixels_per_mm = pixels_per_mm;
    // The longest of 1, 2, 5 times a power of ten in 22 % of the plot's width.
    const double longest = 0.22 * picture.layout().plots[0].width / pixels_per_mm;
    const double pixels = std::round(roundDown125(longest) * pixels_per_mm);
    const std::vector<gpu::Quad> quads = picture.quads();
    const auto bar = std::find_if(quads.begin(), quads.end(), [&](const gpu::Quad& q) {
      return q.fill.x == gpu::kFillSolid && q.pixels.x == at && q.pixels.z - q.pixels.x > 20.0F;
    });
    ASSERT_NE(bar, quads.end()) << pixels_per_mm;
    EXPECT_EQ(bar->pixels.z - bar->pixels.x, pixels) << pixels_per_mm;
    EXPECT_TRUE(hasColour(*bar, picture.palette().ink));
    // Its ends are marked by strokes that end where it does.
    const auto ends = std::count_if(quads.begin(), quads.end(), [&](const gpu::Quad& q) {
      return q.fill.x == gpu::kFillSolid && q.pixels.y < bar->pixels.y && q.pixels.w > bar->pixels.w &&
             (q.pixels.x == bar->pixels.x || q.pixels.z == bar->pixels.z);
    });
    EXPECT_EQ(ends, 2) << pixels_per_mm;
    EXPECT_TRUE(picture.warnings.empty());
  }
}

TEST(ScaleBar, IsReadInTheUnitOfTheOtherLengthsWhileThatIsReadable) {
  Decorated picture;
  const auto letters_as = [&](const ShownUnit& unit) {
    picture.content.length_unit = unit;
    std::vector<gpu::Quad> quads = picture.quads();
    std::erase_if(quads, [](const gpu::Quad& q) { return q.fill.x != gpu::kFillGlyph; });
    return quads;
  };
  const auto differ = [](const std::vector<gpu::Quad>& a, const std::vector<gpu::Quad>& b) {
    return !std::equal(a.begin(), a.end(), b.begin(), b.end(), same);
  };
  const ShownUnit mm{"mm", 1.0}, um{"\u00b5m", 1e3};
  picture.content.pixels_per_mm = 400.0;  // "0.5 mm", "500 \u00b5m"
  EXPECT_TRUE(differ(letters_as(mm), letters_as(um)));
  picture.content.pixels_per_mm = 4e4;  // 5 \u00b5m either way
  EXPECT_FALSE(differ(letters_as(mm), letters_as(um)));
}

TEST(Legend, NamesEachSpecialColourThatThePictureHasAndNoOther) {
  Decorated picture;
  const auto shown = [&](const glm::vec3& colour) {
    const std::vector<gpu::Quad> quads = picture.quads();
    return std::any_of(quads.begin(), quads.end(), [&](const gpu::Quad& q) { return hasColour(q, colour); });
  };
  const Palette& palette = picture.palette();
  const std::size_t without = letters(picture.quads());
  EXPECT_FALSE(shown(palette.no_data) || shown(palette.marks) || shown(palette.suggested));
  picture.content.marks = true;
  EXPECT_TRUE(shown(palette.marks));
  EXPECT_FALSE(shown(palette.no_data) || shown(palette.suggested));
  EXPECT_EQ(letters(picture.quads()), without + std::string("marked").size());
  picture.content.no_data = picture.content.suggested = true;
  EXPECT_TRUE(shown(palette.no_data) && shown(palette.marks) && shown(palette.suggested));
  EXPECT_EQ(letters(picture.quads()), without + std::string("markednodatasuggested").size());
  // A colour without its word would explain nothing: at every width there are both or neither.
  for (int width = 200; width < 1280; width += 20) {
    picture.setWidth(width);
    const std::vector<gpu::Quad> quads = picture.quads();
    const auto boxes = std::count_if(quads.begin(), quads.end(), [&](const gpu::Quad& q) {
      return hasColour(q, palette.no_data) || hasColour(q, palette.marks) || hasColour(q, palette.suggested);
    });
    for (const gpu::Quad& q : quads) EXPECT_LE(q.pixels.z, static_cast<float>(width)) << width;
    for (const std::string& warning : picture.warnings)
      for (const char* word : {"no data", "marked", "suggested"})
        EXPECT_EQ(warning.find(word), std::string::npos) << width << ": " << warning;
    EXPECT_LE(boxes, 3);
  }
}

// Both are grey: without colours and in both themes stripes tell them apart, dark on the light grey of theirs.
TEST(Legend, WhatIsNotComparedIsHatchedAndAHoleIsNot) {
  for (const Theme theme : {Theme::kDark, Theme::kLight}) {
    Decorated picture;
    const Palette palette = paletteOf(theme, ColourMap::kDiverging);
    const glm::vec3 stripe = palette.no_data / static_cast<float>(gpu::kHatchShade);
    const auto boxes = [&](const glm::vec3& colour) {
      const std::vector<gpu::Quad> quads = picture.quadsOf(palette);
      return std::ranges::count_if(quads, [&](const gpu::Quad& q) { return hasColour(q, colour); });
    };
    picture.content.no_data = true;
    EXPECT_EQ(boxes(palette.no_data), 1);
    EXPECT_EQ(boxes(stripe), 0);
    picture.content.without = "not fitted";
    EXPECT_EQ(boxes(palette.no_data), 2);
    EXPECT_GT(boxes(stripe), 8);
    // A quarter of the light: a contrast of more than 2 to 1, in luminance as WCAG states it.
    const auto contrast = [](const glm::vec3& a, const glm::vec3& b) { return (a.y + 0.05) / (b.y + 0.05); };
    EXPECT_GT(contrast(palette.no_data, stripe), 1.8);
  }
}

TEST(Legend, NamesTheColoursOfLinesWhereThereAreAnyAndMovesNothingForThem) {
  Decorated picture;
  const std::vector<gpu::Quad> without = picture.quads();
  const glm::vec3 black{0.02F}, orange{1.0F, 0.35F, 0.02F};
  picture.content.lines = {{orange, "step"}, {black, "section"}};
  const std::vector<gpu::Quad> with = picture.quads();
  ASSERT_GT(with.size(), without.size());
  EXPECT_TRUE(std::equal(without.begin(), without.end(), with.begin(), same));
  EXPECT_EQ(letters(with), letters(without) + std::string("stepsection").size());
  // Under what is always there, and none of it cut by the picture's edge.
  float lowest = 0.0F;
  for (const gpu::Quad& q : without) lowest = std::max(lowest, q.pixels.w);
  for (std::size_t i = without.size(); i < with.size(); ++i) {
    EXPECT_LE(with[i].pixels.w, 800.0F);
    EXPECT_GE(with[i].pixels.y, lowest - 1.0F);
  }
  // Each colour in a rim that is seen on the ground: black lines are, on a black ground.
  for (const glm::vec3& colour : {orange, black}) {
    const auto box = std::ranges::find_if(with, [&](const gpu::Quad& q) { return hasColour(q, colour); });
    ASSERT_NE(box, with.end());
    const gpu::Quad& rim = *(box - 1);
    EXPECT_TRUE(hasColour(rim, picture.palette().faint_ink));
    EXPECT_LT(rim.pixels.x, box->pixels.x);
    EXPECT_GT(rim.pixels.w, box->pixels.w);
  }
  // As thick as the text is large.
  for (const double scale : {1.0, 1.6, 2.0}) {
    picture.setScale(scale);
    const std::vector<gpu::Quad> quads = picture.quads();
    const auto box = std::ranges::find_if(quads, [&](const gpu::Quad& q) { return hasColour(q, orange); });
    ASSERT_NE(box, quads.end());
    EXPECT_NEAR(box->pixels.w - box->pixels.y, 4.0 * scale, 0.5) << scale;
    EXPECT_NEAR(box->pixels.z - box->pixels.x, 18.0 * scale, 0.5) << scale;
    // The row ends under the plot's right side, but for the space in the last letter.
    float last = 0.0F;
    for (auto quad = box; quad != quads.end(); ++quad) last = std::max(last, quad->pixels.z);
    const Rectangle plot = picture.layout().plots.back();
    const double right = plot.x + plot.width - std::round(scale);
    EXPECT_LE(last, right) << scale;
    EXPECT_GE(last, right - 2.0 * scale) << scale;
  }
  picture.setScale(0.0);
  // A colour without its word would explain nothing.
  for (int width = 200; width < 1280; width += 20) {
    picture.setWidth(width);
    const std::vector<gpu::Quad> quads = picture.quads();
    for (const gpu::Quad& q : quads) EXPECT_LE(q.pixels.z, static_cast<float>(width)) << width;
    const auto boxes = std::ranges::count_if(
        quads, [&](const gpu::Quad& q) { return hasColour(q, orange) || hasColour(q, black); });
    picture.content.lines.clear();
    const std::size_t others = letters(picture.quads());
    picture.content.lines = {{orange, "step"}, {black, "section"}};
    EXPECT_EQ(letters(quads) - others, boxes == 2 ? 11U : boxes == 1 ? 4U : 0U) << width;
  }
}

// Of more than one byte each: half a letter would be drawn as another one.
TEST(Titles, ThatAreTooLongEndWithAnEllipsisAfterAWholeLetter) {
  Decorated picture;
  const auto titled = [&](const std::string& title) {
    picture.content.titles = {title};
    return picture.quads();
  };
  const std::size_t others = letters(titled(""));
  EXPECT_EQ(letters(titled("short")), others + 5);
  std::string title;
  for (int i = 0; i < 400; ++i) title += "\u00e9";
  const std::vector<gpu::Quad> cut = titled(title);
  const std::size_t drawn = letters(cut) - others;  // the ellipsis is one
  ASSERT_GT(drawn, 20U);
  const std::vector<gpu::Quad> shorter = titled(title.substr(0, 2 * (drawn - 1)) + "\u2026");
  EXPECT_TRUE(std::equal(shorter.begin(), shorter.end(), cut.begin(), cut.end(), same));
  // As many as there is room for, and no pixel more.
  const double right = picture.layout().plots[0].x + picture.layout().plots[0].width;
  const double end = cut[drawn - 1].pixels.z;
  EXPECT_LE(end, right);
  const double one = cut[1].pixels.x - cut[0].pixels.x;
  EXPECT_GT(end + 1.5 * one, right);
}

// Beside each other in a narrow window titles become smaller, then several lines, and stay over their own plots.
TEST(Titles, StayWholeAndOverTheirPlotsWhereTheseAreNarrow) {
  Decorated picture;
  int narrowest = 0;
  for (int width = 1280; width >= 260; width -= 10) {
    picture.setWidth(width, 3);
    picture.content.titles = {"", "", ""};
    const std::size_t others = letters(picture.quads());
    picture.content.titles = {"unchanged", "Box 13 x 13", "Median 5 x 5, 12 passes"};
    const std::vector<gpu::Quad> quads = picture.quads();
    const std::size_t drawn = letters(quads) - others;
    // As many as the letters that are no blanks.
    constexpr std::size_t kAll = 9 + 8 + 18;
    if (drawn == kAll) narrowest = width;
    std::size_t k = 0;
    for (const gpu::Quad& q : quads) {
      if (k == drawn) break;
      ++k;
      const bool inside = std::ranges::any_of(picture.layout().plots, [&](const Rectangle& plot) {
        return q.pixels.x >= static_cast<float>(plot.x) - 1.0F &&
               q.pixels.z <= static_cast<float>(plot.x + plot.width) + 1.0F;
      });
      EXPECT_TRUE(inside) << width << ": " << q.pixels.x << " to " << q.pixels.z;
    }
  }
  // Plots of some 80 pixels.
  EXPECT_LE(narrowest, 400);
}

}  // namespace
}  // namespace fettle::render
