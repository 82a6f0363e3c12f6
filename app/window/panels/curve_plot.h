#pragma once

#include <string>
#include <vector>

#include <glm/vec2.hpp>

#include "render/plan/panel_colours.h"

namespace fettle::app {

/// A curve of a plot: places where a coordinate is no finite number end a line.
struct PlotCurve {
  std::vector<glm::dvec2> points;
  render::PanelColour colour;
  float width = 0.1F;  ///< in heights of a letter
  std::string name;    ///< in the tip and, where there are several, below the plot; empty: none
};

struct CurvePlot {
  enum class Scale { kLinear, kLogarithmic };
  std::vector<PlotCurve> curves = {};  ///< the first ones beneath
  Scale scale = Scale::kLinear;        ///< of both axes; what is not above 0 is left out of a logarithmic one
  double low = 0.0, high = 0.0;        ///< of y, where they are not the same; else what the curves reach
  std::string x_name = {}, y_name = {};  ///< with their units: "material ratio [%]"
};

/// Draws it over the width of the panel, with what its axes show below, and where the cursor is in a tip.
void curvePlot(const char* id, const CurvePlot& plot);

}  // namespace fettle::app
