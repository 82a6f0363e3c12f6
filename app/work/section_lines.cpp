#include "app/work/section_lines.h"

#include <utility>

#include <fmt/format.h>

#include "app/work/estimate_text.h"
#include "app/work/section_report.h"
#include "engine/measure/roughness.h"

namespace fettle::app {

namespace {

const ReadAs kDegrees{"degrees", 1.0};

// What lies between two cursors is read to five digits, as the heights of the plot that they are set on.
std::string shownBetween(const Report& of, const ReadAs& unit) {
  return of.is_null() ? "-" : fmt::format("{:.5g} {}", of.get<double>() / unit.size + 0.0, unit.name);
}

// "0.3 to 0.9 mm"
std::string shownStretch(const Report& stretch, const ReadAs& unit) {
  return fmt::format("{:.6g} to {}", stretch[0].get<double>() / unit.size, shownLength(stretch[1], unit));
}

// A length to the digits of its error; without one all that are known.
std::string shownWith(const Report& of, const char* key, const char* error_key, const ReadAs& unit,
                      std::string (*plain)(const Report&, const ReadAs&)) {
  if (of[key].is_null() || !of.contains(error_key) || of[error_key].is_null()) return plain(of[key], unit);
  const double error = of[error_key].get<double>() / unit.size;
  return fmt::format("{} +- {:.2g} {}", shownTo(of[key].get<double>() / unit.size, error), error, unit.name);
}

// Of what is left of a fit no more digits say anything.
std::string shownRms(const Report& of, const ReadAs& unit) {
  const Report& mm = of["rms_mm"];
  return mm.is_null() ? "-" : fmt::format("{:.4g} {}", mm.get<double>() / unit.size, unit.name);
}

// Why a profile does not determine a parameter.
const char* reasonWithout(const engine::RoughnessInfo& info) {
  if (info.unit == engine::RoughnessInfo::Unit::kRatio) return "the core has no height";
  return info.figure == &engine::Roughness::rsm || info.figure == &engine::Roughness::rc
             ? "it has no element from one crossing of the mean line to the next but one"
             : "the profile is flat";
}

}  // namespace

SectionUnits sectionUnits(double longest_mm, double span_mm) {
  return {readLengthAs(longest_mm, 1.0, "mm"), readLengthAs(span_mm, 1.0, "mm")};
}

std::string shownLength(const Report& mm, const ReadAs& unit) {
  return mm.is_null() ? "-" : fmt::format("{:.6g} {}", mm.get<double>() / unit.size, unit.name);
}

std::string shownHeight(const Report& mm, const ReadAs& unit) {
  return mm.is_null() ? "-" : fmt::format("{:.9g} {}", mm.get<double>() / unit.size, unit.name);
}

std::vector<SectionLine> sectionLines(const Report& of, const SectionUnits& units) {
  const ReadAs &along = units.along, &height = units.height;
  std::vector<SectionLine> lines;
  const auto row = [&](const char* name, std::string text) { lines.push_back({name, std::move(text)}); };
  if (of.contains("cursors")) {
    const Report& c = of["cursors"];
    const std::string dz =
        c["dz_error_mm"].is_null() ? shownBetween(c["dz_mm"], height) : shownEstimate(c, "dz", "mm", height);
    row("cursors",
        fmt::format("dx {}, dz {}, slope {}, distance {}", shownBetween(c["dx_mm"], along), dz,
                    shownBetween(c["slope_deg"], kDegrees), shownBetween(c["distance_mm"], along)));
  }
  if (of.contains("line")) {
    const Report& line = of["line"];
    row("line", fmt::format("inclination {}, height in the middle {}, rms {}",
                            shownEstimate(line, "inclination", "deg", kDegrees),
                            shownEstimate(line, "height", "mm", height), shownRms(line, height)));
  }
  if (of.contains("step")) {
    const Report& step = of["step"];
    row("step", fmt::format("{}, edge at {}, by {} and {}, rms {}", shownEstimate(step, "step", "mm", height),
                            shownWith(step, "edge_mm", "edge_error_mm", along, shownLength),
                            shownStretch(step["before"], along), shownStretch(step["after"], along),
                            shownRms(step, height)));
  }
  if (of.contains("groove")) {
    const Report& groove = of["groove"];
    row("groove",
        fmt::format("depth {}, width {} from {} to {}, rms {}", shownEstimate(groove, "depth", "mm", height),
                    shownWith(groove, "width_mm", "width_error_mm", along, shownLength),
                    shownLength(groove["edges"][0], along), shownLength(groove["edges"][1], along),
                    shownRms(groove, height)));
  }
  if (of.contains("angle")) {
    const Report& angle = of["angle"];
    row("angle",
        fmt::format("turn {}, included {} degrees, lines meet at {}, height {}",
                    shownEstimate(angle, "turn", "deg", kDegrees), shownNumber(angle["included_deg"]),
                    shownWith(angle, "meet_along_mm", "meet_along_error_mm", along, shownLength),
                    shownWith(angle, "meet_height_mm", "meet_height_error_mm", height, shownHeight)));
  }
  if (of.contains("arc")) {
    const Report& arc = of["arc"];
    row("arc", fmt::format("radius {}, {}, centre at {}, height {}, rms {}",
                           shownEstimate(arc, "radius", "mm", along),
                           arc["hollow"].get<bool>() ? "hollow" : "raised",
                           shownLength(arc["centre_along_mm"], along),
                           shownHeight(arc["centre_height_mm"], along), shownRms(arc, height)));
  }
  for (const engine::ProfileInfo& profile : engine::profileInfos()) {
    const std::string word(profile.word);
    if (!of.contains(word)) continue;
    const Report& r = of[word];
    const ReadAs as =
        readLengthAs(r[keysOf(engine::roughnessInfos().front(), profile).value].get<double>(), 1.0, "mm");
    const std::string smooth =
        r.contains("lambda_s_mm") ? fmt::format(", lambda s {}", shownLength(r["lambda_s_mm"], along)) : "";
    const std::string over = profile.kind == engine::ProfileKind::kRoughness
                                 ? fmt::format("over {} Gaussian cut-offs of {}", r["lengths"].get<int>(),
                                               shownLength(r["cutoff_mm"], along))
                             : profile.by_cutoff
                                 ? fmt::format("Gaussian cut-off {}", shownLength(r["cutoff_mm"], along))
                                 : std::string("without a cut-off");
    // Of a session of before it was kept there is none.
    const std::string where =
        r.contains("evaluated") ? fmt::format(", from {}", shownStretch(r["evaluated"], along)) : "";
    row(word.c_str(), fmt::format("{}{}{}; without noise +- standard error", over, where, smooth));
    for (const engine::RoughnessInfo& info : engine::roughnessInfos()) {
      const RoughnessKeys keys = keysOf(info, profile);
      if (!r.contains(keys.value)) continue;  // of a session of before it was measured
      using Unit = engine::RoughnessInfo::Unit;
      const ReadAs in = info.unit == Unit::kHeight  ? as
                        : info.unit == Unit::kAlong ? along
                        : info.unit == Unit::kRatio ? ReadAs{"%", 0.01}
                                                    : ReadAs{"", 1.0};
      std::string text = r[keys.value].is_null() ? fmt::format("not stated: {}", reasonWithout(info))
                                                 : shownLength(r[keys.value], in);
      if (const Report& without = r[keys.without], &error = r[keys.error]; !without.is_null()) {
        const double by = error.get<double>() / in.size;
        text += fmt::format(", without noise {} +- {:.2g}", shownTo(without.get<double>() / in.size, by), by);
      } else if (r.contains(keys.reason) && !r[keys.value].is_null()) {
        text += fmt::format(", without noise not stated: {}", r[keys.reason].get<std::string>());
      }
      row("", fmt::format("{:<5} {}", keys.symbol, text));
    }
    const auto asked = [&](const char* key, const char* figure, const char* ending, const ReadAs& in,
                           const auto& whereOf) {
      const std::string list = askedKey(key, profile);
      if (!r.contains(list)) return;
      for (const Report& one : r[list]) {
        std::string text = fmt::format("{}, {}", shownLength(one[figure], in), whereOf(one));
        if (const Report& without = one[std::string("without") + ending]; !without.is_null()) {
          const double by = one[std::string("error") + ending].get<double>() / in.size;
          text +=
              fmt::format(", without noise {} +- {:.2g}", shownTo(without.get<double>() / in.size, by), by);
        } else if (one.contains("reason")) {
          text += fmt::format(", without noise not stated: {}", one["reason"].get<std::string>());
        }
        row("", fmt::format("{}{:<4} {}", profile.letter, key + 1, text));
      }
    };
    asked("rmr", "ratio", "", ReadAs{"%", 0.01}, [&](const Report& one) {
      return fmt::format("material ratio at {} about the mean line", shownLength(one["height_mm"], as));
    });
    asked("rdc", "height_mm", "_mm", as, [](const Report& one) {
      return fmt::format("height difference of the material ratios {:.5g} and {:.5g} %",
                         100.0 * one["ratios"][0].get<double>(), 100.0 * one["ratios"][1].get<double>());
    });
  }
  return lines;
}

}  // namespace fettle::app
