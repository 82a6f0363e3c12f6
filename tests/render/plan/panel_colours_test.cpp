// Every pair of colours of the panels by the contrast that WCAG 2.1 defines, and what is told apart by colour alone as
// colour-blind eyes see it.
#include "render/plan/panel_colours.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

#include "render/plan/colour_map.h"
#include "render/plan/overlay.h"

namespace fettle::render {
namespace {

struct Colour {
  glm::dvec3 code;  // sRGB, 0 .. 1
  double opacity;
};
Colour unpacked(PanelColour colour, Theme theme) {
  const std::uint32_t c = panelColour(colour, theme);
  const auto part = [c](unsigned shift) { return (c >> shift & 0xFFU) / 255.0; };
  return {{part(0), part(8), part(16)}, part(24)};
}
// Blended as ImGui does, on code values.
glm::dvec3 over(const Colour& ink, const glm::dvec3& ground) {
  return glm::mix(ground, ink.code, ink.opacity);
}
glm::dvec3 linear(const glm::dvec3& code) {
  return {linearFromSrgb(code.x), linearFromSrgb(code.y), linearFromSrgb(code.z)};
}
double luminance(const glm::dvec3& light) {
  return glm::dot(light, glm::dvec3(0.2126, 0.7152, 0.0722));
}
double contrast(const glm::dvec3& a, const glm::dvec3& b) {
  const double x = luminance(linear(a)), y = luminance(linear(b));
  return (std::max(x, y) + 0.05) / (std::min(x, y) + 0.05);
}

constexpr std::array kThemes{Theme::kDark, Theme::kLight};

TEST(PanelColours, AreReadableOnAllTheyAreSeenOn) {
  for (const Theme theme : kThemes)
    for (const PanelPair& pair : panelPairs()) {
      const Colour ground = unpacked(pair.ground, theme);
      // What is half transparent lies over pictures from black to white.
      for (const double picture : {0.0, 1.0}) {
        const glm::dvec3 below = over(ground, glm::dvec3(picture));
        EXPECT_GE(contrast(over(unpacked(pair.ink, theme), below), below), pair.contrast)
            << fmt::format("{} on {}, {}", static_cast<int>(pair.ink), static_cast<int>(pair.ground),
                           theme == Theme::kLight ? "light" : "dark");
      }
    }
}

// Who adds a text or a line adds the pairs in which it is seen.
TEST(PanelColours, ThatAreTextsOrLinesAreEachSeenOnSomething) {
  // The shade between cursors only points at them; the others lie over any picture.
  const std::array plain{PanelColour::kStretch, PanelColour::kLasso, PanelColour::kLassoRim,
                         PanelColour::kSplitHandle, PanelColour::kAxisPointed};
  for (auto i = static_cast<int>(PanelColour::kText); i < static_cast<int>(PanelColour::kCount); ++i) {
    const auto colour = static_cast<PanelColour>(i);
    const bool seen = std::ranges::any_of(
        panelPairs(), [&](const PanelPair& p) { return p.ink == colour || p.ground == colour; });
    EXPECT_NE(seen, std::ranges::find(plain, colour) != plain.end()) << i;
  }
}

TEST(PanelColours, LightOnesAreDarkOnLight) {
  EXPECT_GT(luminance(linear(unpacked(PanelColour::kPanel, Theme::kLight).code)), 0.6);
  EXPECT_LT(luminance(linear(unpacked(PanelColour::kPanel, Theme::kDark).code)), 0.05);
  // Red in the lowest byte.
  EXPECT_EQ(panelColour(PanelColour::kLasso, Theme::kDark), 0xFF28AAFFU);
}

// Machado, Oliveira, Fernandes 2009, "A physiologically-based model for simulation of color vision deficiency", severity 1;
// on linear light. Rows as printed there.
const std::array kBlindness{
    glm::dmat3(0.152286, 1.052583, -0.204868, 0.114503, 0.786281, 0.099216, -0.003882, -0.048116, 1.051998),
    glm::dmat3(0.367322, 0.860646, -0.227968, 0.280085, 0.672501, 0.047413, -0.011820, 0.042940, 0.968881),
    glm::dmat3(1.255528, -0.076749, -0.178779, -0.078411, 0.930809, 0.147602, 0.004733, 0.691367, 0.303900)};

// CIE 1976 L*a*b* of D65.
glm::dvec3 labOf(const glm::dvec3& light) {
  const glm::dvec3 xyz{glm::dot(light, glm::dvec3(0.4124, 0.3576, 0.1805)) / 0.9505,
                       glm::dot(light, glm::dvec3(0.2126, 0.7152, 0.0722)),
                       glm::dot(light, glm::dvec3(0.0193, 0.1192, 0.9505)) / 1.089};
  const auto f = [](double t) { return t > 0.008856 ? std::cbrt(t) : 7.787 * t + 16.0 / 116.0; };
  const double x = f(xyz.x), y = f(xyz.y), z = f(xyz.z);
  return {116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z)};
}

TEST(PanelColours, ThatAreToldApartByColourAreSoByColourBlindEyes) {
  // A difference of 2.3 is just seen (Mahy, Van Eycken, Oosterlinck 1994); eight times that is seen at once.
  constexpr double kSeenAtOnce = 20.0;
  constexpr std::pair<PanelColour, PanelColour> kApart[] = {
      {PanelColour::kGood, PanelColour::kProblem},
      {PanelColour::kGood, PanelColour::kWarning},
      {PanelColour::kLower, PanelColour::kHigher},
      {PanelColour::kProfileNow, PanelColour::kProfileBefore},
      {PanelColour::kCursors, PanelColour::kOtherCursors}};
  for (const Theme theme : kThemes)
    for (const auto& [one, other] : kApart)
      for (const glm::dmat3& rows : kBlindness) {
        const auto seen = [&](PanelColour colour) {
          const glm::dvec3 light = linear(over(unpacked(colour, theme), glm::dvec3(1.0)));
          return labOf(glm::clamp(light * rows, 0.0, 1.0));
        };
        EXPECT_GE(glm::distance(seen(one), seen(other)), kSeenAtOnce)
            << static_cast<int>(one) << " and " << static_cast<int>(other);
      }
}

// What stands around the surface.
TEST(Palette, IsReadableOnItsGround) {
  for (const Theme theme : kThemes)
    for (const ColourMap map : {ColourMap::kViridis, ColourMap::kDiverging}) {
      const Palette p = paletteOf(theme, map);
      const auto against = [&](const glm::vec3& light) {
        const double x = luminance(light), y = luminance(p.ground);
        return (std::max(x, y) + 0.05) / (std::min(x, y) + 0.05);
      };
      EXPECT_GE(against(p.ink), kTextContrast);
      EXPECT_GE(against(p.faint_ink), kTextContrast);
    }
}

}  // namespace
}  // namespace fettle::render
