#include "app/work/fit_files.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <numbers>
#include <optional>
#include <string_view>
#include <tuple>
#include <utility>

#include <fmt/format.h>
#include <glm/vec3.hpp>

#include "app/work/estimate_text.h"
#include "app/work/layer_over.h"
#include "app/work/read_units.h"
#include "engine/field/builder.h"

namespace fettle::app {

namespace {

using engine::ShapeKind;

constexpr double kFitDegrees = 180.0 / std::numbers::pi;

Report vectorOf(const glm::dvec3& v) {
  return Report::array({v.x, v.y, v.z});
}

Report numberOf(double value) {
  return std::isnan(value) ? Report() : Report(value);
}

Report errorsOf(const glm::dvec3& v) {
  return Report::array({numberOf(v.x), numberOf(v.y), numberOf(v.z)});
}

// "1.5 +- 0.2 mm"; without an error the value alone.
std::string shownComponent(double value, const Report& error, const ReadAs& as) {
  const std::string unit = as.name.empty() ? std::string() : " " + as.name;
  const double by = error.is_null() ? 0.0 : error.get<double>();
  // Of a plane x and y are chosen.
  if (by == 0.0) return fmt::format("{:.6g}{}", value / as.size, unit);
  return fmt::format("{} +- {:.2g}{}", shownTo(value / as.size, by / as.size), by / as.size, unit);
}

void addFigure(Report& report, const char* key, const char* unit, double value, double error,
               std::optional<double> bias = {}) {
  // An angle is no more than 90 degrees off any other: such an error leaves all of them.
  constexpr double kMostDegrees = 90.0;
  if (std::string_view(unit) == "deg" && error > kMostDegrees) value = std::nan("");
  if (std::isnan(value)) error = value;
  report[fmt::format("{}_{}", key, unit)] = numberOf(value);
  report[fmt::format("{}_error_{}", key, unit)] = numberOf(error);
  if (bias) report[fmt::format("{}_bias_{}", key, unit)] = numberOf(std::isnan(value) ? value : *bias);
}

// The figures of a fit that are single numbers.
struct FitFigure {
  const char* key;
  const char* unit;
  const char* title;
};
constexpr FitFigure kFitFigures[] = {{"radius", "mm", "radius"},
                                     {"tube_radius", "mm", "radius of the tube"},
                                     {"half_angle", "deg", "half angle"},
                                     {"tilt_x", "deg", "tilt x"},
                                     {"tilt_y", "deg", "tilt y"}};
constexpr const char* kAxes[] = {"x", "y", "z"};

const char* pointTitle(const std::string& shape) {
  return shape == "plane"      ? "point"
         : shape == "cylinder" ? "point on axis"
         : shape == "cone"     ? "apex"
                               : "centre";
}

double sizeOf(const Report& vector) {
  double most = 0.0;
  for (const Report& one : vector) most = std::max(most, std::abs(one.get<double>()));
  return most;
}

}  // namespace

Report fitReport(const FittedRegion& fitted) {
  const engine::ShapeFit& fit = fitted.chosen.fit;
  const engine::Shape& s = fit.shape;
  const engine::ShapeFit::Errors e = fit.errors(), bias = fit.biases();
  Report report{{"region", fitted.number},
                {"shape", std::string(engine::infoOf(s.kind).word)},
                {"samples", fit.samples},
                {"left_out", fit.left_out},
                {"middle_mm", vectorOf(fit.middle)},
                {"point_mm", vectorOf(s.point)},
                {"point_error_mm", errorsOf(e.point)},
                {"point_bias_mm", errorsOf(bias.point)}};
  if (s.kind != ShapeKind::kSphere) {
    report["direction"] = vectorOf(s.direction);
    report["direction_error"] = errorsOf(e.direction);
    report["direction_bias"] = errorsOf(bias.direction);
  }
  if (s.kind == ShapeKind::kPlane) {
    const auto degrees = [&](double along) { return std::atan(-along / s.direction.z) * kFitDegrees; };
    addFigure(report, "tilt_x", "deg", degrees(s.direction.x), e.tilt_x * kFitDegrees,
              bias.tilt_x * kFitDegrees);
    addFigure(report, "tilt_y", "deg", degrees(s.direction.y), e.tilt_y * kFitDegrees,
              bias.tilt_y * kFitDegrees);
  } else {
    report["hollow"] = s.hollow;
  }
  if (s.kind == ShapeKind::kSphere || s.kind == ShapeKind::kCylinder || s.kind == ShapeKind::kTorus)
    addFigure(report, "radius", "mm", s.radius, e.radius, bias.radius);
  if (s.kind == ShapeKind::kTorus)
    addFigure(report, "tube_radius", "mm", s.tube_radius, e.tube_radius, bias.tube_radius);
  if (s.kind == ShapeKind::kCone)
    addFigure(report, "half_angle", "deg", s.half_angle * kFitDegrees, e.half_angle * kFitDegrees,
              bias.half_angle * kFitDegrees);
  report.update({{"rms_mm", fit.rms_mm},
                 {"largest_mm", fit.largest_mm},
                 {"correlation", fit.correlation},
                 {"tried", Report::array()}});
  for (const engine::TriedShape& tried : fitted.chosen.tried) {
    Report one{{"shape", std::string(engine::infoOf(tried.kind).word)}, {"rms_mm", numberOf(tried.rms_mm)}};
    if (!tried.refused.empty()) one["refused"] = tried.refused;
    report["tried"].push_back(std::move(one));
  }
  return report;
}

Report relationReport(int first, int second, const engine::ShapeRelation& relation) {
  Report report{{"first", first}, {"second", second}};
  addFigure(report, "angle", "deg", relation.angle_deg.value, relation.angle_deg.error);
  addFigure(report, "distance", "mm", relation.distance_mm.value, relation.distance_mm.error);
  addFigure(report, "between_axes", "mm", relation.between_axes_mm.value, relation.between_axes_mm.error);
  return report;
}

std::string fitTitle(const Report& fit) {
  const double rms = fit["rms_mm"].get<double>();
  const ReadAs small = readLengthAs(rms, 1.0, "mm");
  return fmt::format("region {}: {}{}, {} samples, rms {:.4g} {}", fit["region"].get<int>(),
                     fit.contains("hollow") && fit["hollow"].get<bool>() ? "hollow " : "",
                     fit["shape"].get<std::string>(), fit["samples"].get<std::int64_t>(), rms / small.size,
                     small.name);
}

std::vector<FitLine> fitLines(const Report& fit) {
  const ReadAs degrees{"degrees", 1.0};
  const std::string shape = fit["shape"].get<std::string>();
  std::vector<FitLine> lines;
  for (const FitFigure& figure : kFitFigures) {
    const std::string key = fmt::format("{}_{}", figure.key, figure.unit);
    if (!fit.contains(key)) continue;
    const ReadAs as =
        std::string(figure.unit) == "mm" ? readLengthAs(fit[key].get<double>(), 1.0, "mm") : degrees;
    lines.push_back({figure.title, shownEstimate(fit, figure.key, figure.unit, as)});
  }
  const ReadAs place = readLengthAs(sizeOf(fit["point_mm"]), 1.0, "mm");
  for (std::size_t k = 0; k < 3; ++k)
    lines.push_back({fmt::format("{} {}", pointTitle(shape), kAxes[k]),
                     shownComponent(fit["point_mm"][k].get<double>(), fit["point_error_mm"][k], place)});
  if (fit.contains("direction"))
    for (std::size_t k = 0; k < 3; ++k)
      lines.push_back(
          {fmt::format("{} {}", shape == "plane" ? "normal" : "axis", kAxes[k]),
           shownComponent(fit["direction"][k].get<double>(), fit["direction_error"][k], {"", 1.0})});
  return lines;
}

std::string biasWarning(const Report& fit, bool vertical) {
  constexpr double kOfError = 1.0 / 3.0;
  double most = kOfError;
  std::string text;
  const auto look = [&](const std::string& name, const Report& bias, const Report& error, const char* unit,
                        double along = 0.0) {
    if (bias.is_null() || error.is_null() || !(error.get<double>() > 0.0)) return;
    const double by = bias.get<double>() - along, of_error = std::abs(by) / error.get<double>();
    if (!(of_error > most)) return;
    most = of_error;
    const ReadAs as =
        std::string_view(unit) == "mm" ? readLengthAs(std::abs(by), 1.0, "mm") : ReadAs{unit, 1.0};
    text = fmt::format("{} by {:+.2g}{}{}, {:.2g} of its standard error", name, by / as.size,
                       as.name.empty() ? "" : " ", as.name, of_error);
  };
  const std::string shape = fit["shape"].get<std::string>();
  // Noise turns a direction either way, which on average makes its largest component smaller by half of the square of its error: a
  // 1e-10 of an upright axis, whose error to first order is as small. That is a length of 1, no other direction.
  double shorter = 0.0;
  if (fit.contains("direction"))
    for (std::size_t k = 0; k < 3; ++k)
      if (!fit["direction_bias"][k].is_null())
        shorter += fit["direction_bias"][k].get<double>() * fit["direction"][k].get<double>();
  for (std::size_t k = 0; k < 3; ++k) {
    look(fmt::format("{} {}", pointTitle(shape), kAxes[k]), fit["point_bias_mm"][k], fit["point_error_mm"][k],
         "mm");
    if (fit.contains("direction"))
      look(fmt::format("{} {}", shape == "plane" ? "normal" : "axis", kAxes[k]), fit["direction_bias"][k],
           fit["direction_error"][k], "", shorter * fit["direction"][k].get<double>());
  }
  for (const FitFigure& figure : kFitFigures)
    if (const std::string key = fmt::format("{}_bias_{}", figure.key, figure.unit); fit.contains(key))
      look(figure.title, fit[key], fit[fmt::format("{}_error_{}", figure.key, figure.unit)],
           std::string_view(figure.unit) == "deg" ? "degrees" : figure.unit);
  if (text.empty()) return text;
  return fmt::format("region {}: noise moves the {} on average, which the error does not count: {}",
                     fit["region"].get<int>(), text,
                     vertical ? "take a larger region" : "--distance vertical has less of it");
}

std::string errorNoiseText(const Report& report) {
  if (report["noise_mm"].is_null()) return {};
  const auto read = [](double mm) {
    const ReadAs as = readLengthAs(mm, 1.0, "mm");
    return fmt::format("{:.4g} {}", mm / as.size, as.name);
  };
  std::string text = "noise between samples " + read(report["noise_mm"].get<double>());
  for (const auto& [key, name] : {std::pair("noise_rows_mm", "rows"), {"noise_columns_mm", "columns"}})
    if (const double mm = report[key].get<double>(); mm > 0.0)
      text += fmt::format(", of whole {} {}", name, read(mm));
  return text;
}

std::vector<FitLine> relationLines(const Report& between) {
  std::vector<FitLine> lines;
  for (const auto& [key, unit, title] : {std::tuple("angle", "deg", "angle"),
                                         {"distance", "mm", "distance"},
                                         {"between_axes", "mm", "between axes"}}) {
    const Report& value = between[fmt::format("{}_{}", key, unit)];
    if (value.is_null()) continue;
    const ReadAs as = std::string(unit) == "mm" ? readLengthAs(std::abs(value.get<double>()), 1.0, "mm")
                                                : ReadAs{"degrees", 1.0};
    lines.push_back({title, shownEstimate(between, key, unit, as)});
  }
  return lines;
}

std::string fitCsv(const Report& report) {
  std::string text = "region,shape,figure,value,standard_error,unit,layer\n";
  const std::string layer = layerOf(report);
  for (const Report& fit : report["fits"]) {
    const auto row = [&](const std::string& figure, const Report& value, const Report& error,
                         const char* unit) {
      fmt::format_to(std::back_inserter(text), "{},{},{},{},{},{},{}\n", fit["region"].get<int>(),
                     fit["shape"].get<std::string>(), figure,
                     value.is_null() ? "" : fmt::format("{:.12g}", value.get<double>()),
                     error.is_null() ? "" : fmt::format("{:.6g}", error.get<double>()), unit, layer);
    };
    for (std::size_t k = 0; k < 3; ++k)
      row(fmt::format("point_{}", kAxes[k]), fit["point_mm"][k], fit["point_error_mm"][k], "mm");
    if (fit.contains("direction"))
      for (std::size_t k = 0; k < 3; ++k)
        row(fmt::format("direction_{}", kAxes[k]), fit["direction"][k], fit["direction_error"][k], "");
    for (const FitFigure& figure : kFitFigures)
      if (const std::string key = fmt::format("{}_{}", figure.key, figure.unit); fit.contains(key))
        row(figure.key, fit[key], fit[fmt::format("{}_error_{}", figure.key, figure.unit)], figure.unit);
    row("rms", fit["rms_mm"], Report(), "mm");
  }
  return text;
}

engine::Result<engine::Version> residualField(const engine::Version& field,
                                              const std::vector<FittedRegion>& fitted, bool vertical,
                                              engine::JobControl& job) {
  engine::Grid grid = field.grid();
  grid.height_per_count = 0.0;
  auto builder = engine::FieldBuilder::create(grid, "the residual map");
  if (!builder) return tl::unexpected(builder.error());
  const engine::FieldReader reader = field.reader();
  std::vector<float> heights;
  for (const FittedRegion& one : fitted) {
    const engine::ShapeFit& fit = one.chosen.fit;
    for (const engine::SampleRun& run : one.region.runs) {
      if (job.cancelled()) return engine::cancelled();
      heights.resize(static_cast<std::size_t>(run.columns));
      reader.readHeights(run.column, run.row, run.columns, 1, heights.data(), run.columns);
      for (std::int32_t i = 0; i < run.columns; ++i) {
        float& z = heights[static_cast<std::size_t>(i)];
        const glm::dvec3 p((run.column + i) * grid.spacingXMm(), run.row * grid.spacingYMm(),
                           double{z} * grid.height_unit.mm);
        z = static_cast<float>(engine::residualAt(fit, p, vertical) / grid.height_unit.mm);
      }
      builder->writeHeights(run.column, run.row, run.columns, 1, heights.data(), run.columns);
    }
  }
  return std::move(*builder).build();
}

}  // namespace fettle::app
