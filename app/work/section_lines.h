#pragma once

#include <string>
#include <vector>

#include "app/report.h"
#include "app/work/read_units.h"

namespace fettle::app {

/// In which unit figures of a section are written: lengths along the line, and heights.
struct SectionUnits {
  ReadAs along{"mm", 1.0}, height{"mm", 1.0};
  friend bool operator==(const SectionUnits&, const SectionUnits&) = default;
};
/// In which lengths up to `longest_mm` and heights that span `span_mm` read at ease.
[[nodiscard]] SectionUnits sectionUnits(double longest_mm, double span_mm);

/// A line of text for a figure of sectionFigures(), values to two digits of their standard errors.
struct SectionLine {
  std::string name;  ///< "step"; empty: belongs to the line before
  std::string text;
};
[[nodiscard]] std::vector<SectionLine> sectionLines(const Report& figures, const SectionUnits& units);

/// "12.5 mm" of a length or height in millimetres; "-" of null.
[[nodiscard]] std::string shownLength(const Report& mm, const ReadAs& unit);
/// The same of a height far from 0: as many digits as float samples have, and two more.
[[nodiscard]] std::string shownHeight(const Report& mm, const ReadAs& unit);

}  // namespace fettle::app
