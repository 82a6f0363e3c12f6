#include "app/commands/scale_option.h"

#include <utility>

#include <fmt/format.h>

#include "app/commands/typed_values.h"
#include "engine/measure/gaussian_filter.h"

namespace fettle::app {

namespace {

// In millimetres: the default unit of a grid. 0 where nothing was typed.
engine::Result<double> cutOffOf(const std::string& typed, const std::string& option) {
  if (typed.empty()) return 0.0;
  return parseHeight(typed, engine::Grid{}, option);
}

engine::Result<engine::Version> filteredBy(const engine::Version& field, double cut_off, engine::Waves waves,
                                           const std::string& option, engine::JobControl& job) {
  auto filtered = engine::gaussianFiltered(field, cut_off, waves, job);
  if (filtered || filtered.error().kind != engine::ErrorKind::kInput) return filtered;
  return engine::inputError(filtered.error().what, option, filtered.error().remedy);
}

}  // namespace

void addScaleOptions(Command command, ScaleArguments& arguments) {
  command.add({
      {.name = "--s-filter",
       .to = &arguments.s_filter,
       .text =
           "Gaussian of ISO 16610-61 before the form: removes waves shorter than this, of which half stays",
       .kind = ValueKind::kLength,
       .shown = "MM"},
      {.name = "--l-filter",
       .to = &arguments.l_filter,
       .text = "The same after the form: removes waves longer than this, of which half stays",
       .kind = ValueKind::kLength,
       .shown = "MM"},
  });
}

engine::Result<ScaleLimited> scaleLimited(const engine::Version& field, const std::string& scan,
                                          const engine::Imported& imported, const FormArguments& form,
                                          const ScaleArguments& scale, engine::JobControl& job) {
  const auto short_ = cutOffOf(scale.s_filter, "--s-filter"), long_ = cutOffOf(scale.l_filter, "--l-filter");
  if (!short_) return tl::unexpected(short_.error());
  if (!long_) return tl::unexpected(long_.error());
  if (!scale.l_filter.empty() && *long_ <= *short_)
    return engine::inputError("the L-filter leaves nothing of what the S-filter left", "--l-filter",
                              fmt::format("take more than {} mm", *short_));
  ScaleLimited result{field, {}, {}};
  if (!scale.s_filter.empty()) {
    auto smooth = filteredBy(result.field, *short_, engine::Waves::kLong, "--s-filter", job);
    if (!smooth) return tl::unexpected(smooth.error());
    result.field = *std::move(smooth);
  }
  auto fit = formOf(result.field, scan, imported, form, job);
  if (!fit) return tl::unexpected(fit.error());
  result.fit = *std::move(fit);
  result.form = result.fit.form;
  if (scale.l_filter.empty()) return result;
  auto rest = engine::withoutForm(result.field, result.form, job);
  if (!rest) return tl::unexpected(rest.error());
  auto rough = filteredBy(*rest, *long_, engine::Waves::kShort, "--l-filter", job);
  if (!rough) return tl::unexpected(rough.error());
  result.field = *std::move(rough);
  result.form = {0, result.form.width, result.form.height, 0.0, {0.0}};
  return result;
}

void addScale(Report& report, const ScaleArguments& scale) {
  if (const auto s = cutOffOf(scale.s_filter, ""); s && *s > 0.0) report["s_filter"] = *s;
  if (const auto l = cutOffOf(scale.l_filter, ""); l && *l > 0.0) report["l_filter"] = *l;
}

}  // namespace fettle::app
