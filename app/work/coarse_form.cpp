#include "app/work/coarse_form.h"

#include <algorithm>
#include <cmath>
#include <new>
#include <utility>

#include "app/work/preview_picture.h"
#include "engine/field/means.h"
#include "engine/measure/form_surface.h"

namespace fettle::app {
namespace {

constexpr std::int64_t kFewSamples = 1 << 23;  // of which a form is worked out at once
// A polynomial is solved in one pass, a shape by many.
constexpr double kCellsOfPolynomial = 1 << 20, kCellsOfShape = 1 << 18;

engine::SampleRect allOf(const engine::Version& field) noexcept {
  return {0, 0, field.grid().width, field.grid().height};
}

engine::Result<engine::Version> fittedSurface(const engine::Version& field, const engine::FormChoice& choice,
                                              engine::JobControl& job) {
  const auto fit = engine::fitNominalForm(field, choice, job);
  if (!fit) return tl::unexpected(fit.error());
  return engine::formSurface(field.grid(), fit->form, nullptr, job);
}

// Of a surface and one over means of 2 x 2 of its samples, where both have one.
double rmsBetween(const engine::FieldReader& fine, const engine::FieldReader& coarse) noexcept {
  double squares = 0.0;
  std::int64_t compared = 0;
  for (std::int32_t r = 0; 2 * r + 1 < fine.height(); ++r)
    for (std::int32_t c = 0; 2 * c + 1 < fine.width(); ++c) {
      double sum = 0.0;
      for (const std::int32_t k : {0, 1, 2, 3})
        sum += static_cast<double>(fine.heightAt(2 * c + k % 2, 2 * r + k / 2));
      const double off = 0.25 * sum - static_cast<double>(coarse.heightAt(c, r));
      if (!std::isfinite(off)) continue;
      squares += off * off;
      ++compared;
    }
  return compared > 0 ? std::sqrt(squares / static_cast<double>(compared)) : 0.0;
}

}  // namespace

std::string coarseFormState(const CoarseForm& form) {
  return offText(form.off_rms, true, form.surface.grid());
}

bool formTakesLong(const engine::Grid& grid) noexcept {
  return grid.samples() > kFewSamples;
}

engine::Result<CoarseForm> coarseForm(const engine::Version& field, const engine::FormChoice& choice,
                                      engine::JobControl& job) try {
  const double cells = engine::infoOf(choice.kind).shape ? kCellsOfShape : kCellsOfPolynomial;
  CoarseForm coarse;
  coarse.step = std::max(1, static_cast<std::int32_t>(
                                std::ceil(std::sqrt(static_cast<double>(field.grid().samples()) / cells))));
  coarse.means = engine::meansOf(field, allOf(field), coarse.step);
  engine::FormChoice of_means = choice;
  if (choice.through) of_means.through = choice.through->onMeans(field.grid(), coarse.step);
  auto surface = fittedSurface(coarse.means, of_means, job);
  if (!surface) return tl::unexpected(surface.error());
  coarse.surface = *std::move(surface);
  if (of_means.through) of_means.through = of_means.through->onMeans(coarse.means.grid(), 2);
  const auto other = fittedSurface(engine::meansOf(coarse.means, allOf(coarse.means), 2), of_means, job);
  if (!other) return tl::unexpected(other.error());
  coarse.off_rms = rmsBetween(coarse.surface.reader(), other->reader());
  return coarse;
} catch (const std::bad_alloc&) {
  return engine::failure("memory for a preview could not be had", "form", "close other programs");
}

}  // namespace fettle::app
