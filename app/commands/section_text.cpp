#include "app/commands/section_text.h"

#include <algorithm>
#include <string>

#include <fmt/format.h>

#include "app/work/estimate_text.h"
#include "app/work/read_units.h"

namespace fettle::app {

namespace {

// In which unit figures of a section are written: lengths along the line, and heights.
struct TextUnits {
  ReadAs along{"mm", 1.0}, height{"mm", 1.0};
};

TextUnits unitsOf(const Report& report) {
  double longest = 0.0, span = 0.0;
  for (const Report& one : report["sections"]) {
    longest = std::max(longest, one["length_mm"].get<double>());
    span = std::max(span, one["high_mm"].get<double>() - one["low_mm"].get<double>());
  }
  return {readLengthAs(longest, 1.0, "mm"), readLengthAs(span, 1.0, "mm")};
}

std::string shownLength(const Report& mm, const ReadAs& unit) {
  return mm.is_null() ? "-" : fmt::format("{:.6g} {}", mm.get<double>() / unit.size, unit.name);
}

// Heights may be small differences far from 0: as many digits as float samples have, and two more.
std::string shownHeight(const Report& mm, const ReadAs& unit) {
  return mm.is_null() ? "-" : fmt::format("{:.9g} {}", mm.get<double>() / unit.size, unit.name);
}

const ReadAs kDegrees{"degrees", 1.0};

void printFigures(const Report& of, const std::string& before, const TextUnits& units) {
  const ReadAs &along = units.along, &height = units.height;
  const auto row = [&](const char* name, const std::string& text) {
    fmt::print("{}{:<10} {}\n", before, name, text);
  };
  if (of.contains("cursors")) {
    const Report& c = of["cursors"];
    row("cursors", fmt::format("dx {}, dz {}, slope {} degrees, distance {}", shownLength(c["dx_mm"], along),
                               shownEstimate(c, "dz", "mm", height), shownNumber(c["slope_deg"]),
                               shownLength(c["distance_mm"], along)));
  }
  if (of.contains("line")) {
    const Report& line = of["line"];
    row("line",
        fmt::format("inclination {}, height in the middle {}, rms {}",
                    shownEstimate(line, "inclination", "deg", kDegrees),
                    shownEstimate(line, "height", "mm", height), shownLength(line["rms_mm"], height)));
  }
  if (of.contains("step")) {
    const Report& step = of["step"];
    row("step", fmt::format("{}, edge at {}, rms {}", shownEstimate(step, "step", "mm", height),
                            shownLength(step["edge_mm"], along), shownLength(step["rms_mm"], height)));
  }
  if (of.contains("groove")) {
    const Report& groove = of["groove"];
    row("groove",
        fmt::format("depth {}, width {} from {} to {}, rms {}", shownEstimate(groove, "depth", "mm", height),
                    shownLength(groove["width_mm"], along), shownLength(groove["edges"][0], along),
                    shownLength(groove["edges"][1], along), shownLength(groove["rms_mm"], height)));
  }
  if (of.contains("angle")) {
    const Report& angle = of["angle"];
    row("angle", fmt::format("turn {}, included {} degrees, lines meet at {}, height {}",
                             shownEstimate(angle, "turn", "deg", kDegrees),
                             shownNumber(angle["included_deg"]), shownLength(angle["meet_along_mm"], along),
                             shownHeight(angle["meet_height_mm"], height)));
  }
  if (of.contains("arc")) {
    const Report& arc = of["arc"];
    row("arc", fmt::format("radius {}, {}, centre at {}, height {}, rms {}",
                           shownEstimate(arc, "radius", "mm", along),
                           arc["hollow"].get<bool>() ? "hollow" : "raised",
                           shownLength(arc["centre_along_mm"], along),
                           shownHeight(arc["centre_height_mm"], along), shownLength(arc["rms_mm"], height)));
  }
  if (of.contains("roughness")) {
    const Report& r = of["roughness"];
    const ReadAs as = readLengthAs(r["ra_mm"].get<double>(), 1.0, "mm");
    row("roughness", fmt::format("over {} cut-offs of {}; without noise +- standard error",
                                 r["lengths"].get<int>(), shownLength(r["cutoff_mm"], along)));
    struct Kind {
      const char* name;
      const char* key;
      const char* unit;
      const ReadAs* as;
    };
    const ReadAs plain{"", 1.0};
    for (const Kind& kind : {Kind{"Ra", "ra", "_mm", &as},
                             {"Rq", "rq", "_mm", &as},
                             {"Rz", "rz", "_mm", &as},
                             {"RSm", "rsm", "_mm", &along},
                             {"Rsk", "rsk", "", &plain},
                             {"Rku", "rku", "", &plain}}) {
      const Report &value = r[fmt::format("{}{}", kind.key, kind.unit)],
                   &without = r[fmt::format("{}_without{}", kind.key, kind.unit)],
                   &error = r[fmt::format("{}_error{}", kind.key, kind.unit)];
      std::string text = shownLength(value, *kind.as);
      if (!without.is_null()) {
        const double by = error.get<double>() / kind.as->size;
        text += fmt::format(", without noise {} +- {:.2g}",
                            shownTo(without.get<double>() / kind.as->size, by), by);
      }
      row("", fmt::format("{:<4} {}", kind.name, text));
    }
  }
}

}  // namespace

void printSections(const Report& report) {
  const TextUnits units = unitsOf(report);
  const ReadAs &along = units.along, &height = units.height;
  if (!report["noise_mm"].is_null()) {
    const double noise_mm = report["noise_mm"].get<double>();
    const ReadAs as = readLengthAs(noise_mm, 1.0, "mm");
    fmt::print("noise of a sample {:.4g} {}; +- standard error\n", noise_mm / as.size, as.name);
  }
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
               shownEstimate(p, "slope", "deg", kDegrees), shownNumber(p["rises_to_deg"]),
               shownEstimate(p, "mean_curvature", "", {"", 1.0}), shownNumber(p["least_curvature"]),
               shownNumber(p["most_curvature"]));
  }
}

}  // namespace fettle::app
