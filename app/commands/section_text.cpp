#include "app/commands/section_text.h"

#include <algorithm>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "app/commands/noise_text.h"
#include "app/commands/section_options.h"
#include "app/work/estimate_text.h"
#include "app/work/interpolation_words.h"
#include "app/work/layer_over.h"
#include "app/work/read_units.h"
#include "app/work/section_files.h"
#include "app/work/section_lines.h"

namespace fettle::app {

namespace {

const ReadAs kAngle{"degrees", 1.0};

SectionUnits unitsOf(const Report& report) {
  double longest = 0.0, span = 0.0;
  for (const Report& one : report["sections"]) {
    longest = std::max(longest, one["length_mm"].get<double>());
    span = std::max(span, one["high_mm"].get<double>() - one["low_mm"].get<double>());
  }
  return sectionUnits(longest, span);
}

void printFigures(const Report& of, const std::string& before, const SectionUnits& units) {
  for (const SectionLine& line : sectionLines(of, units))
    fmt::print("{}{:<10} {}\n", before, line.name, line.text);
}

}  // namespace

void printSections(const Report& report) {
  const SectionUnits units = unitsOf(report);
  const ReadAs &along = units.along, &height = units.height;
  printNoise(report);
  if (!report["sections"].empty())
    fmt::print("heights {}\n", takingText({interpolationNamed(report["interpolation"].get<std::string>()),
                                           layerOf(report), layerOf(report, kOtherLayerKey)}));
  else
    printLayer(report);
  for (const Report& one : report["sections"]) {
    const int lanes = one["lanes"].get<int>();
    fmt::print("section {}: {} long, {} places {} apart, {} lane{}, heights {:.9g} to {}\n",
               one["section"].get<int>(), shownLength(one["length_mm"], along), one["places"].get<int>(),
               shownLength(one["spacing_mm"], along), lanes, lanes == 1 ? "" : "s",
               one["low_mm"].get<double>() / height.size, shownHeight(one["high_mm"], height));
    if (one["without_height"].get<int>() > 0)
      fmt::print("  {} places have no height\n", one["without_height"].get<int>());
    if (one["partial"].get<int>() > 0)
      fmt::print("  {} places are means of fewer lanes, the others lie at holes or outside\n",
                 one["partial"].get<int>());
    if (one.value("filled", 0) > 0)
      fmt::print(
          "  {} places have heights that were filled, not measured: --region measured leaves them out\n",
          one["filled"].get<std::int64_t>());
    printFigures(one, "  ", units);
    if (one.contains("deviation")) {
      const Report& d = one["deviation"];
      fmt::print("  {:<10} other less this: mean {}, rms {}, largest {}, {} places\n", "deviation",
                 shownLength(d["mean_mm"], height), shownLength(d["rms_mm"], height),
                 shownLength(d["max_abs_mm"], height), d["places"].get<int>());
    }
    if (one.contains("other")) printFigures(one["other"], "  other: ", units);
  }
  if (!report.contains("probes")) return;
  for (const Report& p : report["probes"]) {
    const ReadAs as = readLengthAs(std::abs(p["height_mm"].get<double>()), 1.0, "mm");
    fmt::print("probe {},{}: height {}, slope {} rising to {} degrees, curvature {}, from {} to {} per mm\n",
               shownNumber(p["x"]), shownNumber(p["y"]), shownEstimate(p, "height", "mm", as),
               shownEstimate(p, "slope", "deg", kAngle), shownNumber(p["rises_to_deg"]),
               shownEstimate(p, "mean_curvature", "", {"", 1.0}), shownNumber(p["least_curvature"]),
               shownNumber(p["most_curvature"]));
  }
}

}  // namespace fettle::app
