#pragma once

#include <string>
#include <vector>

#include "app/work/section_report.h"
#include "engine/base/error.h"
#include "engine/measure/section.h"

namespace fettle::app {

/// A section of a scan and, with --compare, that of the other at the same places; what is drawn into it.
struct DrawnSection {
  std::string name;  ///< "section 0"
  engine::Section section;
  engine::Section other;           ///< no places: there is none
  std::string other_name;          ///< empty: "NAME, other"
  std::vector<SectionMark> marks;  ///< at which a thin line stands, with its name
};

/// A row per place: section, length, position, height, share of the lanes, height of the other, all in millimetres.
/// Cells without a height are empty.
[[nodiscard]] std::string sectionCsv(const std::vector<DrawnSection>& sections);

/// DXF R12: length and height in millimetres as polylines, one for each run of heights, on a layer for each section, its
/// other beside it.
[[nodiscard]] std::string sectionDxf(const std::vector<DrawnSection>& sections);

/// Draws heights over lengths, a colour for each section and broken lines for the other, to an .svg or a .png. Errors:
/// as drawnByGnuplot.
[[nodiscard]] engine::Status drawSections(const std::vector<DrawnSection>& sections, const std::string& path);

/// That drawing as a script for gnuplot (plots/gnuplot.h): of at most the first 7.
[[nodiscard]] std::string sectionsPlot(const std::vector<DrawnSection>& sections);

}  // namespace fettle::app
