#pragma once

#include <algorithm>
#include <cmath>
#include <string>
#include <string_view>
#include <vector>

#include <glm/vec3.hpp>

#include "render/plan/camera.h"
#include "render/plan/glyphs.h"
#include "render/plan/number_text.h"
#include "render/plan/picture.h"
#include "shaders/layout.h"

namespace fettle::render {

/// Colours of everything except the surface, linear light.
struct Palette {
  glm::vec3 ground, ink, faint_ink, no_data, wall, marks, suggested;
};
[[nodiscard]] Palette paletteOf(Theme theme, ColourMap map);

/// How far stripes of the hatch lie apart that samples without a colour have, along x and along y [pixels].
[[nodiscard]] inline double hatchPeriod(double scale) noexcept {
  return std::max(6.0, std::round(8.0 * scale));
}

/// Positions of the parts in a picture of a given size; pixels.
struct Layout {
  double scale = 1.0;  ///< 1: text of 15 pixels
  int text_px = 15;
  int title_px = 18;
  double title_above = 14.0;     ///< of a title's foot, over its plot [pixels]
  std::vector<Rectangle> plots;  ///< one per panel
  bool decorated = false;        ///< whether there is room for colour bar and scale bar
};
/// In the margin that is there without them, or above the plots in a row of their own.
enum class Titles { kNone, kInMargin, kAbove };
/// `scale`: of text and bars, as set for the display; 0: by the size of the picture, 1 at 1280 x 800. At any
/// scale, text and bars leave three fifths of width and height to the surface.
[[nodiscard]] Layout layOut(const View& view, Decoration decoration, int panels, Titles titles,
                            double scale = 0.0);

/// What a colour of lines on the surface means.
struct LineMeaning {
  glm::vec3 colour;  ///< linear light
  std::string_view name;

  friend bool operator==(const LineMeaning&, const LineMeaning&) = default;
};

/// The content of the decorations.
struct DecorationContent {
  ValueRange range;                   ///< of the colours [the field's height unit]
  bool colours = true;                ///< the picture has them: it gets the bar
  bool below = false, above = false;  ///< values outside it exist: the bar gets a pointed end
  std::string quantity;               ///< "height", or what the difference is
  std::string note;                   ///< small, under the bar; may be empty
  ShownUnit height_unit;              ///< in which the colours' numbers are written
  engine::LengthUnit lateral_unit;
  ShownUnit length_unit{"mm"};  ///< of the scale bar, as lengths across the field are written elsewhere
  double pixels_per_mm = 1.0;   ///< of the first panel's camera
  double exaggeration = 1.0;
  bool approximate_scale = false;  ///< perspective: the scale bar holds at the middle only
  bool marks = false, suggested = false, no_data = false;  ///< legend entries
  std::string without;  ///< legend entry of Difference::without; empty: none
  float marks_opacity = 1.0F;
  std::vector<std::string> titles;  ///< one per panel
  std::vector<LineMeaning> lines;   ///< of the lines in the picture: a row of its own, under the others
};

/// The quads of the decorations in drawing order. `warnings` gets a line for each text that did not fit.
[[nodiscard]] std::vector<gpu::Quad> decorationQuads(const Layout& layout, const View& view,
                                                     const DecorationContent& decorations,
                                                     const Palette& palette, Glyphs& glyphs,
                                                     std::vector<std::string>& warnings);

}  // namespace fettle::render
