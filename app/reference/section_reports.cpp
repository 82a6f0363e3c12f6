#include "app/reference/report_keys.h"
#include "app/work/section_report.h"
#include "engine/measure/roughness.h"

namespace fettle::app::reports {

namespace {

// A line fitted to a stretch of a section.
Keys fittedLine() {
  return {{"inclination_deg", "number", ""},
          {"inclination_error_deg", "number", ""},
          {"height_mm", "number", "in the middle"},
          {"height_error_mm", "number", ""},
          {"rms_mm", "number", ""},
          {"places", "integer", ""}};
}

Keys profileKeys(const engine::ProfileInfo& profile) {
  Keys keys = {{"lambda_s_mm?", "number", "with --lambda-s"}, {"evaluated", "[number]", "from and to"}};
  keys.push_back({"lengths", "integer",
                  profile.kind == engine::ProfileKind::kRoughness ? "section lengths of one cut-off"
                                                                  : "section lengths: 1"});
  if (profile.by_cutoff) keys.push_back({"cutoff_mm", "number", ""});
  for (const engine::RoughnessInfo& info : engine::roughnessInfos()) {
    const RoughnessKeys names = keysOf(info, profile);
    keys.push_back({names.value, "number", info.text});
    keys.push_back({names.without, "number", "without noise"});
    keys.push_back({names.error, "number", "standard error of that"});
    keys.push_back({names.reason + "?", "string", "why it is not stated without noise"});
  }
  keys.push_back({askedKey("rmr", profile) + "?",
                  "[object]",
                  "with --at-height: Rmr(c)",
                  {{"height_mm", "number", "about the mean line"},
                   {"ratio", "number", "share"},
                   {"without", "number", "ratio without noise"},
                   {"error", "number", "its standard error"},
                   {"reason?", "string", "why neither is stated"}}});
  keys.push_back({askedKey("rdc", profile) + "?",
                  "[object]",
                  "with --height-between: Rdc",
                  {{"ratios", "[number]", "shares"},
                   {"height_mm", "number", "between both"},
                   {"without_mm", "number", "height without noise"},
                   {"error_mm", "number", "its standard error"},
                   {"reason?", "string", "why neither is stated"}}});
  return keys;
}

// What is measured in a section, of the scan and of that of --compare.
Keys sectionFigures() {
  return {{"cursors?",
           "object",
           "with --cursors",
           {{"dx_mm", "number", ""},
            {"dz_mm", "number", ""},
            {"dz_error_mm", "number", "standard error, as of every key with _error"},
            {"slope_deg", "number", ""},
            {"distance_mm", "number", "in space, straight"},
            {"first_mm", "number", "height"},
            {"second_mm", "number", "height"}}},
          {"line?", "object", "with --fit-line", fittedLine()},
          {"step?",
           "object",
           "with --step",
           {{"edge_mm", "number", "length along the line"},
            {"edge_error_mm", "number", "standard error; null where it is given or noise leaves it open"},
            {"step_mm", "number", "after the edge less before"},
            {"step_error_mm", "number", ""},
            {"inclination_deg", "number", "of both lines"},
            {"inclination_error_deg", "number", ""},
            {"before", "[number]", "stretch that counts, from and to"},
            {"after", "[number]", ""},
            {"rms_mm", "number", ""},
            {"places", "integer", ""}}},
          {"groove?",
           "object",
           "with --groove, ISO 5436-1",
           {{"edges", "[number]", "lengths along the line"},
            {"edges_error_mm", "number", "standard error of each; null where they are given"},
            {"width_mm", "number", ""},
            {"width_error_mm", "number", "null where the edges are given"},
            {"depth_mm", "number", "below 0: a ridge"},
            {"depth_error_mm", "number", ""},
            {"inclination_deg", "number", ""},
            {"inclination_error_deg", "number", ""},
            {"before", "[number]", "stretch that counts, from and to"},
            {"inside", "[number]", ""},
            {"behind", "[number]", ""},
            {"rms_mm", "number", ""},
            {"places", "integer", ""}}},
          {"angle?",
           "object",
           "with --angle",
           {{"turn_deg", "number", "inclination of the second less that of the first, above 0 concave"},
            {"turn_error_deg", "number", ""},
            {"included_deg", "number", "180 less the turn's size"},
            {"meet_along_mm", "number", "where the lines meet; null of parallel ones"},
            {"meet_along_error_mm", "number", ""},
            {"meet_height_mm", "number", ""},
            {"meet_height_error_mm", "number", ""},
            {"first", "object", "", fittedLine()},
            {"second", "object", "", fittedLine()}}},
          {"arc?",
           "object",
           "with --arc",
           {{"radius_mm", "number", ""},
            {"radius_error_mm", "number", ""},
            {"centre_along_mm", "number", ""},
            {"centre_along_error_mm", "number", ""},
            {"centre_height_mm", "number", ""},
            {"centre_height_error_mm", "number", ""},
            {"hollow", "boolean", "the centre is above the surface"},
            {"rms_mm", "number", ""},
            {"places", "integer", ""}}},
          {"roughness?", "object", "with --cutoff, ISO 21920-2",
           profileKeys(engine::profileInfo(engine::ProfileKind::kRoughness))},
          {"primary?", "object", "with --profile primary",
           profileKeys(engine::profileInfo(engine::ProfileKind::kPrimary))},
          {"waviness?", "object", "with --profile waviness and --cutoff",
           profileKeys(engine::profileInfo(engine::ProfileKind::kWaviness))}};
}

Keys sectionKeys() {
  return joined(
      {{"section", "integer", "from 0"},
       {"from", "[number]", "x, y, mm from the lower left sample"},
       {"to", "[number]", ""},
       {"length_mm", "number", ""},
       {"spacing_mm", "number", "of the places"},
       {"places", "integer", ""},
       {"without_height", "integer", "places at holes and outside"},
       {"partial", "integer", "places whose height is the mean of fewer lanes: some lie at holes or outside"},
       {"lanes", "integer", "lines side by side that were averaged"},
       {"filled?", "integer", "of a session: places with heights that were filled, not measured"},
       {"low_mm", "number", ""},
       {"high_mm", "number", ""},
       {"deviation?",
        "object",
        "with --compare: other less this",
        {{"places", "integer", "that have both heights"},
         {"mean_mm", "number", ""},
         {"rms_mm", "number", ""},
         {"max_abs_mm", "number", ""}}},
       {"other?", "object", "with --compare: its figures", sectionFigures()}},
      sectionFigures());
}

}  // namespace

std::vector<ReportSchema> sectioning() {
  return {
      {"section",
       1,
       {{"",
         {{"noise_mm", "number", "standard deviation in a sample"},
          {"noise_rows_mm", "number", "of what whole rows are off"},
          {"noise_columns_mm", "number", "of what whole columns are off"},
          {"interpolation", "string", "of heights between samples: bilinear or nearest"},
          layer(),
          {"other_layer?", "string", "the same of the scan of --compare"},
          {"sections", "[object]", "in the order of --start, --line, --lines", sectionKeys()},
          {"probes?",
           "[object]",
           "with --probe",
           {{"x", "number", "mm from the lower left sample"},
            {"y", "number", ""},
            {"radius_mm", "number", ""},
            {"height_mm", "number", ""},
            {"height_error_mm", "number", "standard error, as of every key with _error"},
            {"slope_deg", "number", "of the steepest direction"},
            {"slope_error_deg", "number", ""},
            {"rises_to_deg", "number", "anticlockwise from x"},
            {"most_curvature", "number", "1/mm, above 0 hollow"},
            {"least_curvature", "number", "1/mm"},
            {"mean_curvature", "number", "1/mm"},
            {"mean_curvature_error", "number", ""},
            {"rms_mm", "number", "of the samples about the quadratic"},
            {"samples", "integer", ""}}}}}}},
  };
}

}  // namespace fettle::app::reports
