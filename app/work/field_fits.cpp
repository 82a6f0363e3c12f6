#include "app/work/field_fits.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <utility>

#include <fmt/format.h>
#include <glm/geometric.hpp>

#include "app/work/layer_over.h"
#include "app/work/section_report.h"
#include "app/work/step_file.h"
#include "engine/measure/fit_relation.h"
#include "engine/measure/fit_samples.h"

namespace fettle::app {
namespace {

// The best of the shapes may be none: a warning, else empty.
std::string otherShape(const FittedRegion& fitted, double noise_mm) {
  constexpr double kUnlike = 3.0;
  const engine::ShapeFit& found = fitted.chosen.fit;
  // Of a scan without noise its rounding is left.
  const double rounding = std::numeric_limits<float>::epsilon() * glm::length(found.middle);
  const double times = found.rms_mm / std::max(noise_mm, rounding);
  if (!(times > kUnlike)) return {};
  return fmt::format(
      "region {}: the samples lie {:.0f} times the scan's noise off the {}, so it is another shape, "
      "or several, and "
      "the errors say little: divide it by edge lines, or look at the residuals",
      fitted.number, times, engine::infoOf(found.shape.kind).word);
}

}  // namespace

engine::Result<FieldFits> fitEach(const engine::Version& field, std::vector<engine::FitRegion> regions,
                                  const std::vector<engine::ShapeKind>& kinds, const engine::FitOptions& how,
                                  engine::JobControl& job) {
  FieldFits fits;
  const double noise_mm = std::hypot(how.noise_mm, how.rows_mm, how.columns_mm);
  fits.report = {{"noise_mm", numberOrNull(how.noise_mm)},
                 {"noise_rows_mm", how.rows_mm},
                 {"noise_columns_mm", how.columns_mm},
                 {"distance", how.vertical ? "vertical" : "orthogonal"},
                 {"robust", how.robust},
                 {"fits", Report::array()},
                 {"not_fitted", Report::array()}};
  addLayer(fits.report, field);
  const bool alone = regions.size() == 1;
  for (std::size_t k = 0; k < regions.size(); ++k) {
    engine::FitRegion& region = regions[k];
    const int number = static_cast<int>(k) + 1;
    auto chosen = engine::fitBestShape(field, region, kinds, how, job);
    if (chosen) {
      fits.fitted.push_back({number, std::move(region), *std::move(chosen)});
      fits.report["fits"].push_back(fitReport(fits.fitted.back()));
      if (std::string warning = otherShape(fits.fitted.back(), noise_mm); !warning.empty())
        fits.warnings.push_back(std::move(warning));
      else if (std::string biased = biasWarning(fits.report["fits"].back(), how.vertical); !biased.empty())
        fits.warnings.push_back(std::move(biased));
      continue;
    }
    if (chosen.error().kind != engine::ErrorKind::kInput || alone) return tl::unexpected(chosen.error());
    fits.report["not_fitted"].push_back(
        {{"region", number}, {"samples", region.samples}, {"reason", chosen.error().what}});
  }
  return fits;
}

engine::Status addRelation(FieldFits& fits, int first, int second) {
  const FittedRegion* both[2] = {nullptr, nullptr};
  const int numbers[2] = {first, second};
  for (std::size_t k = 0; k < 2; ++k) {
    const auto found = std::ranges::find(fits.fitted, numbers[k], &FittedRegion::number);
    if (found == fits.fitted.end())
      return engine::inputError(fmt::format("region {} has no fit", numbers[k]), "--between",
                                "name two numbers of the list of fits");
    both[k] = &*found;
  }
  fits.report["between"] =
      relationReport(first, second, engine::relationOf(both[0]->chosen.fit, both[1]->chosen.fit));
  return {};
}

std::string fitStep(const engine::Version& field, const std::vector<FittedRegion>& fitted) {
  std::vector<BoundedShape> faces;
  for (const FittedRegion& one : fitted) {
    const std::string name =
        fmt::format("region {}: {}", one.number, engine::infoOf(one.chosen.fit.shape.kind).word);
    for (BoundedShape& face : boundedBy(name, one.chosen.fit.shape, engine::FitSamples(field, one.region)))
      faces.push_back(std::move(face));
  }
  return stepFile("fettle fit", faces);
}

}  // namespace fettle::app
