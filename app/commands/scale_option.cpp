#include "app/commands/scale_option.h"

#include <optional>
#include <string>
#include <string_view>
#include <tuple>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "app/commands/filter_warnings.h"
#include "app/commands/typed_values.h"
#include "app/terminal.h"
#include "engine/filter/catalogue.h"
#include "engine/marks/chosen_marks.h"
#include "engine/measure/form.h"
#include "engine/measure/only_region.h"
#include "engine/measure/scale_filter.h"

namespace fettle::app {

namespace {

// In millimetres: the default unit of a grid. 0 where nothing was typed.
engine::Result<double> cutOffOf(const std::string& typed, const std::string& option) {
  if (typed.empty()) return 0.0;
  const auto length = parseHeight(typed, engine::Grid{}, option);
  if (length && *length == 0.0)
    return engine::inputError("a filter of length 0 leaves all as it is", option,
                              "leave it out, or take a longer one");
  return length;
}

const std::string kUsualKind = "areal-gaussian";

engine::Result<engine::Version> filteredBy(const engine::Version& field, const std::string& kind,
                                           double length, engine::Waves waves, const std::string& option,
                                           engine::JobControl& job,
                                           const engine::NominalForm* about = nullptr) {
  engine::FilterSpec spec;
  spec.kind = engine::filterNamed(kind)->kind;
  spec.nesting_mm = length;
  engine::FilterReport report;
  auto filtered = engine::scaleFiltered(field, spec, waves, job, &report, about);
  warnOfCutoff(spec, field.grid(), option);
  if (const std::string warning = engine::warningOf(report); !warning.empty()) warn(option + ": " + warning);
  if (filtered || filtered.error().kind != engine::ErrorKind::kInput) return filtered;
  return engine::inputError(filtered.error().what, option, filtered.error().remedy);
}

// Whether a Gaussian of such a form is another one.
bool bends(engine::FormKind kind) {
  return kind != engine::FormKind::kMean && kind != engine::FormKind::kPlane;
}

}  // namespace

void addScaleOptions(Command command, ScaleArguments& arguments) {
  std::vector<Word> kinds;
  for (const engine::Filter& filter : engine::filters())
    if (engine::separatesScales(filter)) kinds.emplace_back(std::string(filter.word), "");
  command.add({
      {.name = "--s-filter",
       .to = &arguments.s_filter,
       .text = "S-filter before the form: removes waves shorter than this, of which half stays; of a kind "
               "that rolls "
               "a ball, its radius",
       .kind = ValueKind::kLength,
       .unit = "mm",
       .shown = "MM"},
      {.name = "--l-filter",
       .to = &arguments.l_filter,
       .text = "The same after the form: removes waves longer than this, of which half stays",
       .kind = ValueKind::kLength,
       .unit = "mm",
       .shown = "MM"},
      {.name = "--s-filter-kind",
       .to = &arguments.s_kind,
       .text = "The filter of --s-filter, as of fettle filter",
       .words = kinds},
      {.name = "--l-filter-kind",
       .to = &arguments.l_kind,
       .text = "The filter of --l-filter: what it leaves is taken away",
       .words = kinds},
  });
}

engine::Result<ScaleLimited> scaleLimited(const engine::Version& field, const std::string& scan,
                                          const engine::Imported& imported, const FormArguments& form,
                                          const ScaleArguments& scale, engine::JobControl& job) {
  const auto short_ = cutOffOf(scale.s_filter, "--s-filter"), long_ = cutOffOf(scale.l_filter, "--l-filter");
  if (!short_) return tl::unexpected(short_.error());
  if (!long_) return tl::unexpected(long_.error());
  for (const auto& [kind, cut_off, option] : {std::tuple(&scale.s_kind, &scale.s_filter, "--s-filter"),
                                              std::tuple(&scale.l_kind, &scale.l_filter, "--l-filter")})
    if (*kind != kUsualKind && cut_off->empty())
      return engine::inputError("no length is given", fmt::format("{}-kind", option),
                                fmt::format("give {} MM", option));
  // A radius is no wavelength.
  const bool comparable =
      engine::filterNamed(scale.s_kind)->nesting_word == engine::filterNamed(scale.l_kind)->nesting_word;
  if (!scale.l_filter.empty() && comparable && *long_ <= *short_)
    return engine::inputError("the L-filter leaves nothing of what the S-filter left", "--l-filter",
                              fmt::format("take more than {} mm", *short_));
  ScaleLimited result{field, {}, {}};
  const engine::FormChoice choice = formChoiceOf(form);
  if (*short_ > 0.0 || *long_ > 0.0) {
    // What does not count is as good as a hole for filters, too.
    auto counted = engine::onlyRegion(field, field, choice.region, job);
    if (!counted) return tl::unexpected(counted.error());
    result.field = *std::move(counted);
  }
  if (*short_ > 0.0) {
    // About a bent form: the ends of a bow would be bent up by what it is filtered with. Where it cannot be fitted formOf() says why.
    std::optional<engine::FittedForm> bow;
    if (bends(choice.kind)) {
      auto fitted = engine::fitNominalForm(result.field, choice, job);
      if (fitted) bow = *std::move(fitted);
    }
    auto smooth = filteredBy(result.field, scale.s_kind, *short_, engine::Waves::kLong, "--s-filter", job,
                             bow ? &bow->form : nullptr);
    if (!smooth) return tl::unexpected(smooth.error());
    result.field = *std::move(smooth);
  }
  auto fit = formOf(result.field, scan, imported, form, job);
  if (!fit) return tl::unexpected(fit.error());
  result.fit = *std::move(fit);
  result.form = result.fit.form;
  if (*long_ == 0.0) return result;
  auto rest = engine::withoutForm(result.field, result.form, job);
  if (!rest) return tl::unexpected(rest.error());
  auto rough = filteredBy(*rest, scale.l_kind, *long_, engine::Waves::kShort, "--l-filter", job);
  if (!rough) return tl::unexpected(rough.error());
  result.field = *std::move(rough);
  result.form = engine::PolynomialForm{0, result.form.width(), result.form.height(), 0.0, {0.0}};
  return result;
}

engine::Result<engine::Version> surfaceField(const ScaleLimited& limited, engine::Region region,
                                             const engine::Version& scan, engine::JobControl& job) {
  const auto about = engine::withoutForm(limited.field, limited.form, job);
  if (!about) return tl::unexpected(about.error());
  const auto chosen = engine::onlyRegion(*about, *about, region, job);
  if (!chosen) return tl::unexpected(chosen.error());
  return engine::withMarksFrom(*chosen, scan, job);
}

std::string scaleText(const Report& report, std::string_view between) {
  std::string text;
  for (const auto& [title, key] : {std::pair("S-filter", "s_filter"), std::pair("L-filter", "l_filter")})
    if (report.contains(key))
      text += fmt::format("{}{} {:.6g} mm, {}", text.empty() ? "" : between, title, report[key].get<double>(),
                          report.value(fmt::format("{}_kind", key), kUsualKind));
  return text;
}

void addScale(Report& report, const ScaleArguments& scale) {
  if (const auto s = cutOffOf(scale.s_filter, ""); s && *s > 0.0) {
    report["s_filter"] = *s;
    if (scale.s_kind != kUsualKind) report["s_filter_kind"] = scale.s_kind;
  }
  if (const auto l = cutOffOf(scale.l_filter, ""); l && *l > 0.0) {
    report["l_filter"] = *l;
    if (scale.l_kind != kUsualKind) report["l_filter_kind"] = scale.l_kind;
  }
}

}  // namespace fettle::app
