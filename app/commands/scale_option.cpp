#include "app/commands/scale_option.h"

#include <tuple>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "app/commands/typed_values.h"
#include "engine/field/sample_rect.h"
#include "engine/field/tile.h"
#include "engine/filter/catalogue.h"
#include "engine/marks/change_marks.h"
#include "engine/measure/form.h"
#include "engine/measure/gaussian_filter.h"
#include "engine/measure/lowered.h"

namespace fettle::app {

namespace {

// In millimetres: the default unit of a grid. 0 where nothing was typed.
engine::Result<double> cutOffOf(const std::string& typed, const std::string& option) {
  if (typed.empty()) return 0.0;
  return parseHeight(typed, engine::Grid{}, option);
}

const std::string kUsualKind = "areal-gaussian";

// A filter of the catalogue about the least-squares plane, so that a tilted surface keeps its ends. Marks choose what is
// measured, and do not keep samples.
engine::Result<engine::Version> filteredByKind(const engine::Version& field, const std::string& kind,
                                               double cut_off, engine::Waves waves, engine::JobControl& job) {
  engine::FilterSpec spec;
  spec.kind = engine::filterNamed(kind)->kind;
  spec.nesting_mm = cut_off;
  const auto fit =
      engine::fitForm(field, {.degree = 1, .region = engine::Region::kAll, .robust = false}, job);
  if (!fit && fit.error().kind == engine::ErrorKind::kInput) return field;  // of holes alone
  if (!fit) return tl::unexpected(fit.error());
  const auto about = engine::withoutForm(field, fit->form, job);
  if (!about) return tl::unexpected(about.error());
  const auto plain = engine::clearMarks(*about, job);
  if (!plain) return tl::unexpected(plain.error());
  const auto low = engine::applyFilter(*plain, *plain, spec, job);
  if (!low) return tl::unexpected(low.error());
  const bool long_waves = waves == engine::Waves::kLong;
  const engine::FieldReader long_part = low->field.reader(), whole = about->reader();
  // Of the levelled field its long waves are taken, or of the field the short ones: marks and lines stay.
  return engine::lowered(
      long_waves ? field : *about, "filtering",
      [&](const engine::SampleRect& rect, double* out) {
        std::vector<float> waves_of(engine::kTileSamples), all(engine::kTileSamples);
        long_part.readHeights(rect.column, rect.row, rect.columns, rect.rows, waves_of.data(),
                              engine::kTileSide);
        if (long_waves)
          whole.readHeights(rect.column, rect.row, rect.columns, rect.rows, all.data(), engine::kTileSide);
        for (int r = 0; r < rect.rows; ++r)
          for (int c = 0; c < rect.columns; ++c) {
            const auto k = static_cast<std::size_t>(r * engine::kTileSide + c);
            const double wave = waves_of[k];
            out[k] = long_waves ? all[k] - wave : wave;
          }
      },
      job);
}

engine::Result<engine::Version> filteredBy(const engine::Version& field, const std::string& kind,
                                           double cut_off, engine::Waves waves, const std::string& option,
                                           engine::JobControl& job) {
  auto filtered = kind == kUsualKind ? engine::gaussianFiltered(field, cut_off, waves, job)
                                     : filteredByKind(field, kind, cut_off, waves, job);
  if (filtered || filtered.error().kind != engine::ErrorKind::kInput) return filtered;
  return engine::inputError(filtered.error().what, option, filtered.error().remedy);
}

}  // namespace

void addScaleOptions(Command command, ScaleArguments& arguments) {
  std::vector<Word> kinds;
  for (const engine::Filter& filter : engine::filters())
    if (filter.nesting_word == "cutoff") kinds.emplace_back(std::string(filter.word), "");
  command.add({
      {.name = "--s-filter",
       .to = &arguments.s_filter,
       .text = "S-filter before the form: removes waves shorter than this, of which half stays",
       .kind = ValueKind::kLength,
       .shown = "MM"},
      {.name = "--l-filter",
       .to = &arguments.l_filter,
       .text = "The same after the form: removes waves longer than this, of which half stays",
       .kind = ValueKind::kLength,
       .shown = "MM"},
      {.name = "--s-filter-kind",
       .to = &arguments.s_kind,
       .text = "The filter of --s-filter: linear (ISO 16610-61) or robust (ISO 16610-71)",
       .words = kinds},
      {.name = "--l-filter-kind",
       .to = &arguments.l_kind,
       .text = "The filter of --l-filter",
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
      return engine::inputError("no cut-off is given", fmt::format("{}-kind", option),
                                fmt::format("give {} MM", option));
  if (!scale.l_filter.empty() && *long_ <= *short_)
    return engine::inputError("the L-filter leaves nothing of what the S-filter left", "--l-filter",
                              fmt::format("take more than {} mm", *short_));
  ScaleLimited result{field, {}, {}};
  if (!scale.s_filter.empty()) {
    auto smooth = filteredBy(result.field, scale.s_kind, *short_, engine::Waves::kLong, "--s-filter", job);
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
  auto rough = filteredBy(*rest, scale.l_kind, *long_, engine::Waves::kShort, "--l-filter", job);
  if (!rough) return tl::unexpected(rough.error());
  result.field = *std::move(rough);
  result.form = engine::PolynomialForm{0, result.form.width(), result.form.height(), 0.0, {0.0}};
  return result;
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
