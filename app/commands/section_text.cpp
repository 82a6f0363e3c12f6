#include "app/commands/section_text.h"

#include <algorithm>
#include <cmath>
#include <string>

#include <fmt/format.h>

namespace fettle::app {

namespace {

std::string shownNumber(const Report& value) {
  return value.is_null() ? "-" : fmt::format("{:.6g}", value.get<double>());
}

// Heights may be small differences far from 0: as many digits as float samples have, and two more.
std::string shownHeight(const Report& value) {
  return value.is_null() ? "-" : fmt::format("{:.9g}", value.get<double>());
}

// To two digits of the error.
std::string shownTo(double value, double error) {
  if (!(error > 0.0) || !std::isfinite(error) || value == 0.0) return fmt::format("{:.6g}", value);
  const double digits = std::floor(std::log10(std::abs(value))) - std::floor(std::log10(error)) + 2.0;
  return fmt::format("{:.{}g}", value, static_cast<int>(std::clamp(digits, 2.0, 12.0)));
}

// "12.3 +- 0.2 mm", the error of a figure beside it.
std::string shownEstimate(const Report& report, const std::string& key, const std::string& unit) {
  const std::string ending = unit.empty() ? std::string() : fmt::format("_{}", unit);
  const Report& error = report[key + "_error" + ending];
  const Report& value = report[key + ending];
  return fmt::format("{}{} {}",
                     value.is_null() || error.is_null() ? shownNumber(value)
                                                        : shownTo(value.get<double>(), error.get<double>()),
                     error.is_null() ? "" : fmt::format(" +- {:.2g}", error.get<double>()),
                     unit == "deg" ? "degrees" : unit);
}

void printFigures(const Report& of, const std::string& before) {
  const auto row = [&](const char* name, const std::string& text) {
    fmt::print("{}{:<10} {}\n", before, name, text);
  };
  if (of.contains("cursors")) {
    const Report& c = of["cursors"];
    row("cursors", fmt::format("dx {} mm, dz {}, slope {} degrees, distance {} mm", shownNumber(c["dx_mm"]),
                               shownEstimate(c, "dz", "mm"), shownNumber(c["slope_deg"]),
                               shownNumber(c["distance_mm"])));
  }
  if (of.contains("line"))
    row("line", fmt::format("inclination {}, height in the middle {}, rms {} mm",
                            shownEstimate(of["line"], "inclination", "deg"),
                            shownEstimate(of["line"], "height", "mm"), shownNumber(of["line"]["rms_mm"])));
  if (of.contains("step"))
    row("step", fmt::format("{}, edge at {} mm, rms {} mm", shownEstimate(of["step"], "step", "mm"),
                            shownNumber(of["step"]["edge_mm"]), shownNumber(of["step"]["rms_mm"])));
  if (of.contains("groove"))
    row("groove", fmt::format("depth {}, width {} mm from {} to {} mm, rms {} mm",
                              shownEstimate(of["groove"], "depth", "mm"),
                              shownNumber(of["groove"]["width_mm"]), shownNumber(of["groove"]["edges"][0]),
                              shownNumber(of["groove"]["edges"][1]), shownNumber(of["groove"]["rms_mm"])));
  if (of.contains("angle"))
    row("angle",
        fmt::format("turn {}, included {} degrees, lines meet at {} mm, height {} mm",
                    shownEstimate(of["angle"], "turn", "deg"), shownNumber(of["angle"]["included_deg"]),
                    shownNumber(of["angle"]["meet_along_mm"]), shownHeight(of["angle"]["meet_height_mm"])));
  if (of.contains("arc"))
    row("arc", fmt::format("radius {}, {}, centre at {} mm, height {} mm, rms {} mm",
                           shownEstimate(of["arc"], "radius", "mm"),
                           of["arc"]["hollow"].get<bool>() ? "hollow" : "raised",
                           shownNumber(of["arc"]["centre_along_mm"]),
                           shownHeight(of["arc"]["centre_height_mm"]), shownNumber(of["arc"]["rms_mm"])));
  if (of.contains("roughness")) {
    const Report& r = of["roughness"];
    row("roughness", fmt::format("Ra {} Rq {} Rz {} RSm {} mm, Rsk {} Rku {}, over {} cut-offs of {} mm",
                                 shownNumber(r["ra_mm"]), shownNumber(r["rq_mm"]), shownNumber(r["rz_mm"]),
                                 shownNumber(r["rsm_mm"]), shownNumber(r["rsk"]), shownNumber(r["rku"]),
                                 r["lengths"].get<int>(), shownNumber(r["cutoff_mm"])));
  }
}

}  // namespace

void printSections(const Report& report) {
  if (!report["noise_mm"].is_null())
    fmt::print("noise of a sample {:.4g} mm; +- standard error\n", report["noise_mm"].get<double>());
  for (const Report& one : report["sections"]) {
    fmt::print("section {}: {} mm long, {} places {} mm apart, {} lane{}, heights {} to {} mm\n",
               one["section"].get<int>(), shownNumber(one["length_mm"]), one["places"].get<int>(),
               shownNumber(one["spacing_mm"]), one["lanes"].get<int>(),
               one["lanes"].get<int>() == 1 ? "" : "s", shownHeight(one["low_mm"]),
               shownHeight(one["high_mm"]));
    if (one["without_height"].get<int>() > 0)
      fmt::print("  {} places have no height\n", one["without_height"].get<int>());
    printFigures(one, "  ");
    if (one.contains("deviation")) {
      const Report& d = one["deviation"];
      fmt::print("  {:<10} other less this: mean {} mm, rms {} mm, largest {} mm, {} places\n", "deviation",
                 shownNumber(d["mean_mm"]), shownNumber(d["rms_mm"]), shownNumber(d["max_abs_mm"]),
                 d["places"].get<int>());
    }
    if (one.contains("other")) printFigures(one["other"], "  other: ");
  }
  if (!report.contains("probes")) return;
  for (const Report& p : report["probes"])
    fmt::print("probe {},{}: height {}, slope {} rising to {} degrees, curvature {}, from {} to {} per mm\n",
               shownNumber(p["x"]), shownNumber(p["y"]), shownEstimate(p, "height", "mm"),
               shownEstimate(p, "slope", "deg"), shownNumber(p["rises_to_deg"]),
               shownEstimate(p, "mean_curvature", ""), shownNumber(p["least_curvature"]),
               shownNumber(p["most_curvature"]));
}

}  // namespace fettle::app
