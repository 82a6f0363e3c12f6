#include "app/reference/report_keys.h"

#include <utility>

namespace fettle::app::reports {

ReportKey hash() {
  return {"hash", "string", "of all samples and marks: equal for equal fields, on every machine"};
}
ReportKey machine() {
  return {"machine", "string", "processor, cores, memory"};
}
ReportKey repeats() {
  return {"repeats", "integer", "runs of each row"};
}
ReportKey unit() {
  return {"unit", "string", "of heights"};
}

ReportKey rows(Keys keys) {
  return {"rows", "[object]", "the measurements", std::move(keys)};
}

Keys candidate() {
  return {{"method", "string", "in words"},
          {"filter", "string?", "null: the scan as it is"},
          {"window", "integer", "samples"},
          {"passes", "integer", ""},
          {"range_sigma", "number", "height unit; null: the filter has none"},
          {"around_edges", "boolean", "after marking the suggested edges"},
          {"thickness", "number", "of these marks, samples; null: none are marked"},
          {"error_flat", "number", "expected on flats, height unit"},
          {"error_edge", "number", "expected near edges, height unit"},
          {"seconds", "number", "expected"},
          {"within", "boolean", "within the tolerance"},
          {"why", "string?", "what the filter is listed for; null: others are better at everything"}};
}

Keys places() {
  return {{"places",
           "[object]",
           "those of most gain per second first",
           {{"x", "number", "middle, the scan's coordinates"},
            {"y", "number", ""},
            {"from", "[number]", "x, y"},
            {"to", "[number]", "x, y"},
            {"samples", "number", "length of the stroke"},
            {"gain", "number", "of the sum of squared errors"},
            {"rmse_after", "number", "expected after this place and all before it"},
            {"seconds", "number", "that the stroke takes"}}},
          {"pieces_left_out", "integer", "parts of the scan that could not be tried"},
          {"rmse_without", "number", "expected without any line"},
          {"places_unit", "string", "of rmse"},
          {"places_lateral_unit", "string", "of x and y"}};
}

Keys joined(Keys first, const Keys& second) {
  first.insert(first.end(), second.begin(), second.end());
  return first;
}

Keys suggestion() {
  return {{"met", "boolean", "whether a filter stays within the tolerance"},
          {"why", "string", "the reason, for a person"},
          {"commands", "[string]", "to type, in order"},
          unit(),
          {"tolerance", "number", "height unit"},
          {"budget", "number", "seconds; null: none"},
          {"noise", "number", "height unit"},
          {"samples", "integer", "of the scans that were made to try filters"},
          {"outlier_share", "number", ""},
          {"edge_share", "number", ""},
          {"pick", "object", "the suggested filter", candidate()},
          {"candidates", "[object]", "all that were tried", candidate()}};
}

Keys timing() {
  return {{"p50_us", "number", ""},
          {"p99_us", "number", ""},
          {"p999_us", "number", ""},
          {"p9999_us", "number", ""},
          {"worst_us", "number", ""}};
}

Keys expectedAndReal() {
  return {{"expected", "number", ""},
          {"real", "number", ""},
          {"ratio", "number", "expected over real"},
          {"least_ratio", "number", ""},
          {"most_ratio", "number", ""}};
}

Keys estimated() {
  return {{"seconds", "number", "of the work and of writing"},
          {"work_seconds", "number", ""},
          {"write_seconds", "number", ""},
          {"memory_bytes", "integer", "at most, of the whole process"},
          {"disk_bytes", "integer", "of the result"},
          {"kept_bytes", "integer", "of kept work beside it, with --resume"},
          {"store_bytes", "integer", "of --store"}};
}

ReportForm estimateAlone() {
  return {"--estimate", joined({{"text", "string", "for a person"}}, estimated())};
}
ReportForm noEstimate() {
  return {"--estimate of too little work", {{"text", "string", "that it is so"}}};
}

ReportKey layer() {
  return {"layer?", "string",
          "of a session: the form that lies over it, without which it is measured; a word of --form"};
}

Keys form() {
  return joined({{"form", "string", "none, mean, plane, poly2 to poly5, sphere, cylinder, cone"},
                 {"robust", "boolean", ""},
                 {"region", "string", "as typed: all, marked, unmarked, measured, or a shape"}},
                formFigures());
}

Keys formFigures() {
  return joined(
      joined({{"tilt_x?", "number", "degrees, up to higher x; of a plane and more"},
              {"tilt_y?", "number", "degrees"},
              {"tilt_x_error?", "number", "of three points, standard error; null: each has one sample"},
              {"tilt_y_error?", "number", "the same; null: each has one sample"},
              {"through?",
               "[object]",
               "of three points: the means the plane goes through",
               {{"x", "number", "mm from the lower left sample"},
                {"y", "number", ""},
                {"height", "number", "height unit"},
                {"samples", "integer", "around it"}}}},
             shapeFigures()),
      {{"left_out?", "integer", "samples that did not count, with robust"},
       {"beyond?", "integer", "samples that counted beyond the outline"}});
}

Keys shapeFigures() {
  return {{"point_mm?", "[number]", "of a shape, as the next ones: centre, on the axis, apex; x, y, z"},
          {"direction?", "[number]", "of an axis; from the apex into the cone"},
          {"radius_mm?", "number", ""},
          {"half_angle_deg?", "number", "of a cone"},
          {"hollow?", "boolean", "seen from inside"}};
}

}  // namespace fettle::app::reports
