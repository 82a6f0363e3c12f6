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
  /// Places whose height has samples that were filled; none: the scan has no such sample.
  std::vector<bool> filled = {};
};

/// How sections were taken, as their files state it.
struct SectionTaking {
  engine::Interpolation interpolation = engine::Interpolation::kBilinear;
  std::string layer = {}, other_layer = {};  ///< forms over the scan and over the other, layer_over.h
};

/// "bilinear between samples, without the form poly2 that lies over the scan".
[[nodiscard]] std::string takingText(const SectionTaking& taking);

/// A row per place: section, length, position, height, share of the lanes, of a scan with filled samples whether there are any in
/// the height, height of the other, all in millimetres; how they were taken. Cells without a height are empty.
[[nodiscard]] std::string sectionCsv(const std::vector<DrawnSection>& sections, const SectionTaking& taking);

/// DXF R12: length and height in millimetres as polylines, one for each run of heights, on a layer for each section, its
/// other beside it.
[[nodiscard]] std::string sectionDxf(const std::vector<DrawnSection>& sections);

/// Draws heights over lengths, a colour for each section and broken lines for the other, to an .svg or a .png. Errors:
/// as drawnByGnuplot.
[[nodiscard]] engine::Status drawSections(const std::vector<DrawnSection>& sections,
                                          const SectionTaking& taking, const std::string& path);

/// That drawing as a script for gnuplot (plots/gnuplot.h): of at most the first 7. `caption` stands above it; empty: none.
[[nodiscard]] std::string sectionsPlot(const std::vector<DrawnSection>& sections, const std::string& caption);

}  // namespace fettle::app
