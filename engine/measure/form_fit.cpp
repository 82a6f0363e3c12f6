#include "engine/measure/form_fit.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numbers>
#include <string>
#include <string_view>
#include <utility>

#include <fmt/format.h>
#include <glm/geometric.hpp>

#include "engine/compare/tile_sums.h"
#include "engine/measure/fit_regions.h"
#include "engine/measure/fit_samples.h"
#include "engine/measure/form.h"

namespace fettle::engine {

namespace {

constexpr double kMostFitted = 1 << 22;  // samples

// The region's samples about a form.
struct AboutForm {
  CompensatedSum square;
  std::int64_t samples = 0, beyond = 0;
};

Status addAbout(const Version& field, Region region, FittedForm& fitted, JobControl& job) {
  const FieldReader reader = field.reader();
  const ShapeForm& shape = *fitted.form.shape();
  job.begin("fitting the form", tileCount(reader));
  const auto parts = forEachTile<AboutForm>(reader, job, [&](const SampleRect& rect, AboutForm& part) {
    float z[kTileSamples];
    double form[kTileSamples];
    readRegion(reader, region, rect, z, kTileSide);
    shape.readHeights(rect, form, kTileSide);
    for (int r = 0; r < rect.rows; ++r)
      for (int c = 0; c < rect.columns; ++c) {
        const int k = r * kTileSide + c;
        if (std::isnan(z[k])) continue;
        const double distance = z[k] - form[k];
        part.square.add(distance * distance);
        ++part.samples;
        if (shape.beyondOutline(rect.column + c, rect.row + r)) ++part.beyond;
      }
  });
  if (job.cancelled()) return cancelled();
  AboutForm all;
  for (const AboutForm& part : parts) {
    all.square.add(part.square);
    all.samples += part.samples;
    all.beyond += part.beyond;
  }
  fitted.samples = all.samples;
  fitted.beyond = all.beyond;
  fitted.rms = std::sqrt(all.square.value() / static_cast<double>(all.samples));
  return {};
}

// FittedForm::leaves.
std::string leavesText(const PolynomialForm& form, const Version& field, std::string_view word) {
  constexpr int kPlaces = 32;
  const HeightBounds heights = field.reader().bounds();
  double low = std::numeric_limits<double>::infinity(), high = -low;
  for (int j = 0; j <= kPlaces; ++j)
    for (int i = 0; i <= kPlaces; ++i) {
      const double z = form.heightAt((form.width - 1.0) * i / kPlaces, (form.height - 1.0) * j / kPlaces);
      low = std::fmin(low, z);
      high = std::fmax(high, z);
    }
  const double from = heights.min, to = heights.max, range = to - from;
  if (heights.empty() || (from - low <= range && high - to <= range)) return "";
  return fmt::format(
      "{} reaches from {:.4g} to {:.4g} {} over the field, whose heights are from {:.4g} to {:.4g}", word,
      low, high, field.grid().height_unit.name, from, to);
}

std::string openTermsText(const FormFit& fit, std::string_view title) {
  if (fit.open.empty()) return "";
  const bool one = fit.samples == 1;
  return fmt::format("{} sample{} decide{} {} of the {} terms of a {} and leave{} {} open", fit.samples,
                     one ? "" : "s", one ? "s" : "", fit.decided, fit.terms, title, one ? "s" : "", fit.open);
}

Result<FittedForm> fitShapeForm(const Version& field, ShapeKind kind, const FormChoice& choice,
                                JobControl& job) {
  const auto region = wholeRegion(field, choice.region, job);
  if (!region) return tl::unexpected(region.error());
  if (region->samples == 0) return nothingIn(choice.region, "");
  const auto stride = static_cast<std::int32_t>(
      std::ceil(std::sqrt(static_cast<double>(region->samples) / kMostFitted) - 1e-9));
  FitSamples samples(field, *region, std::max(1, stride));
  // A region that is thinner than the stride.
  constexpr std::size_t kFew = 1 << 16;
  if (samples.stride() > 1 && samples.size() < kFew) samples = FitSamples(field, *region);
  auto fit = fitShape(samples, kind, {.robust = choice.robust}, job);
  if (!fit) return tl::unexpected(fit.error());
  const auto form = formOfShape(*fit, field.grid());
  if (!form) return tl::unexpected(form.error());
  FittedForm fitted;
  fitted.form = *form;
  fitted.numbers = fit->numbers;
  fitted.rms_counted = fit->rms_mm / field.grid().height_unit.mm;
  fitted.fit = *std::move(fit);
  if (auto done = addAbout(field, choice.region, fitted, job); !done) return tl::unexpected(done.error());
  return fitted;
}

Result<FittedForm> fitThrough(const Version& field, const FormChoice& choice) {
  if (choice.kind != FormKind::kPlane || choice.robust)
    return inputError("three points are those of a plane, and all of their samples count", "through",
                      choice.robust ? "fit it without robustness" : "take the form plane");
  auto plane = planeThrough(field, *choice.through, choice.region);
  if (!plane) return tl::unexpected(plane.error());
  FittedForm fitted;
  fitted.form = plane->form;
  fitted.samples = plane->samples;
  fitted.rms = fitted.rms_counted = plane->rms;
  fitted.through = *std::move(plane);
  return fitted;
}

}  // namespace

Result<ShapeForm> formOfShape(const ShapeFit& fit, const Grid& grid) {
  FitSurface surface = fit.surface;
  glm::dvec3 normal = surface.normal();
  ShapeForm form;
  form.width = grid.width;
  form.height = grid.height;
  form.spacing_x_mm = grid.spacingXMm();
  form.spacing_y_mm = grid.spacingYMm();
  form.height_mm = grid.height_unit.mm;
  form.axis = glm::normalize(surface.axial);
  switch (fit.shape.kind) {
    case ShapeKind::kSphere:
      form.shape = FormShape::kSphere;
      form.curvature = surface.tube / fit.scale;
      // Every point describes it as well; the top one where the first lies near the equator.
      if (normal.z < 0.5) {
        surface.foot += (normal - glm::dvec3(0.0, 0.0, 1.0)) / surface.tube;
        normal = {0.0, 0.0, 1.0};
      }
      break;
    case ShapeKind::kCylinder:
      form.shape = FormShape::kCylinder;
      form.curvature = surface.ring / fit.scale;
      normal -= glm::dot(normal, form.axis) * form.axis;
      break;
    default:
      form.shape = FormShape::kCone;
      form.curvature = surface.ring * std::cos(surface.theta) / fit.scale;
      break;
  }
  form.normal = glm::normalize(normal);
  const glm::dvec3 foot = fit.middle + fit.scale * surface.foot;
  form.column = foot.x / form.spacing_x_mm;
  form.row = foot.y / form.spacing_y_mm;
  form.base = foot.z / form.height_mm;
  if (!form.sound())
    return inputError("the shape is too steep to have a height above each sample",
                      std::string(infoOf(fit.shape.kind).word),
                      "take another form, or a region where it is flatter than 87 degrees");
  return form;
}

std::optional<Tilt> tiltOf(const FittedForm& fit, const Grid& grid) {
  auto tilt = tiltOf(fit.form, grid);
  if (!tilt || !fit.through) return tilt;
  const auto errorOf = [](double angle_deg, double error) {
    // A slope of t is atan(t), which grows by 1 / (1 + t^2).
    const double slope = std::tan(angle_deg * std::numbers::pi / 180.0);
    return error / (1.0 + slope * slope) * 180.0 / std::numbers::pi;
  };
  tilt->x_error_deg = errorOf(tilt->x_deg, fit.through->slope_x_error);
  tilt->y_error_deg = errorOf(tilt->y_deg, fit.through->slope_y_error);
  return tilt;
}

Result<FittedForm> fitNominalForm(const Version& field, const FormChoice& choice, JobControl& job) {
  if (choice.through) return fitThrough(field, choice);
  const FormInfo& info = infoOf(choice.kind);
  if (info.shape) return fitShapeForm(field, *info.shape, choice, job);
  auto fit = fitForm(field, {info.degree, choice.region, choice.robust}, job);
  if (!fit) return tl::unexpected(fit.error());
  FittedForm fitted;
  fitted.open = openTermsText(*fit, info.title);
  // What a bend between so few samples would be elsewhere says nothing of the surface; level across them a plane does no harm.
  if (info.degree > 1 && !fitted.open.empty())
    return inputError(fitted.open, std::string(info.word),
                      "take a form of a lower degree or a larger region");
  fitted.samples = fit->samples;
  fitted.rms = fit->rms;
  fitted.rms_counted = fit->rms_counted;
  fitted.rounds = fit->rounds;
  fitted.numbers = fit->decided;
  if (choice.region != Region::kAll) fitted.leaves = leavesText(fit->form, field, info.word);
  fitted.form = std::move(fit->form);
  return fitted;
}

}  // namespace fettle::engine
