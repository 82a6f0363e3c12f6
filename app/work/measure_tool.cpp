#include "app/work/measure_tool.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "app/work/areal_choice.h"
#include "engine/inspect/noise_model.h"
#include "engine/marks/change_marks.h"
#include "engine/marks/polygon.h"
#include "engine/measure/areal.h"
#include "engine/measure/form.h"
#include "engine/measure/form_fit.h"
#include "engine/measure/only_region.h"
#include "engine/measure/scale_filter.h"
#include "engine/uncertainty/areal_figures.h"

namespace fettle::app {
namespace {

constexpr int kNoisePairs = 8;

engine::Region regionOf(MeasureTool::Where where) {
  switch (where) {
    case MeasureTool::Where::kAll:
      return engine::Region::kAll;
    case MeasureTool::Where::kUnmarked:
      return engine::Region::kUnmarked;
    case MeasureTool::Where::kVisible:  // the visible ones are marked for it
    case MeasureTool::Where::kMarked:
      break;
  }
  return engine::Region::kMarked;
}

// The field with its visible samples as the only marked ones.
engine::Result<engine::Version> markedWhereSeen(const engine::Version& field, const engine::SampleRect& seen,
                                                engine::JobControl& job) {
  auto plain = engine::clearMarks(field, job);
  if (!plain) return plain;
  const double left = seen.column - 0.5, low = seen.row - 0.5;
  const double right = left + seen.columns, high = low + seen.rows;
  const glm::dvec2 corners[] = {{left, low}, {right, low}, {right, high}, {left, high}};
  const engine::Polygon polygon(corners);
  return engine::changeMarks(
      *plain, polygon.tiles(field.grid()),
      [&](std::int32_t column, std::int32_t row, const engine::Tile& tile, engine::MarkRows& rows) {
        engine::applyChange(tile, polygon.inside(column, row), engine::MarkChange::kMark, rows);
      },
      job);
}

// A field with the marks of another of its size.
engine::Result<engine::Version> withMarksOf(const engine::Version& field, const engine::Version& other,
                                            engine::JobControl& job) {
  return engine::changeMarks(
      field, engine::allTiles(field.grid()),
      [reader = other.reader()](std::int32_t column, std::int32_t row, const engine::Tile&,
                                engine::MarkRows& rows) { rows = reader.tile(column, row).marks; },
      job);
}

enum class Curves : std::uint8_t { kWithout, kWith };

ArealChoice choiceOf(const MeasureTool::Options& options) {
  if (!options.own) return {};
  ArealChoice choice{.volumes = {options.peaks / 100.0, options.dales / 100.0},
                     .prune = options.prune / 100.0};
  if (options.between) choice.difference = {options.from / 100.0, options.to / 100.0};
  return choice;
}

engine::Status checkRatios(const MeasureTool::Options& options) {
  const auto check = [](double low, double high) -> engine::Status {
    if (low < high) return {};
    return engine::inputError(
        fmt::format("the material ratios {:.6g} and {:.6g} are not in order", low, high), "",
        "give the smaller one first");
  };
  if (!options.own) return {};
  if (auto status = check(options.peaks, options.dales); !status || !options.between) return status;
  return check(options.from, options.to);
}

engine::Status checkScales(const MeasureTool::Options& options) {
  if (!options.scales || options.l_mm == 0.0 || options.l_mm > options.s_mm) return {};
  return engine::inputError("the L-filter leaves nothing of what the S-filter left", "",
                            "give it the longer one");
}

engine::Result<engine::Version> wavesOf(const engine::Version& field, double length_mm, engine::Waves waves,
                                        engine::JobControl& job, const engine::NominalForm* about = nullptr) {
  engine::FilterSpec spec;
  spec.kind = engine::FilterKind::kArealGaussian;
  spec.nesting_mm = length_mm;
  return engine::scaleFiltered(field, spec, waves, job, nullptr, about);
}

// What is measured: the field, or its S-F or S-L surface, and the form about which.
struct MeasuredSurface {
  engine::Version field;
  engine::NominalForm form;
  int numbers;  // of the form, FittedForm::numbers
};

// As `fettle measure` with --s-filter and --l-filter.
engine::Result<MeasuredSurface> limitedSurface(engine::Version field, const MeasureTool::Options& options,
                                               engine::JobControl& job) {
  const engine::Region region = regionOf(options.where);
  const double s_mm = options.scales ? options.s_mm : 0.0, l_mm = options.scales ? options.l_mm : 0.0;
  const engine::FormInfo& info =
      *std::ranges::find(engine::formInfos(), options.degree, &engine::FormInfo::degree);
  const engine::FormChoice choice{.kind = info.kind, .region = region, .robust = options.robust};
  if (s_mm > 0.0 || l_mm > 0.0) {
    // What does not count is as good as a hole for filters, too.
    auto counted = engine::onlyRegion(field, field, region, job);
    if (!counted) return tl::unexpected(counted.error());
    field = *std::move(counted);
  }
  if (s_mm > 0.0) {
    // About a bent form: the ends of a bow would be bent up by what it is filtered with.
    std::optional<engine::FittedForm> bow;
    if (options.degree > 1) {
      auto fitted = engine::fitNominalForm(field, choice, job);
      if (fitted) bow = *std::move(fitted);
    }
    auto smooth = wavesOf(field, s_mm, engine::Waves::kLong, job, bow ? &bow->form : nullptr);
    if (!smooth) return tl::unexpected(smooth.error());
    field = *std::move(smooth);
  }
  auto fit = engine::fitNominalForm(field, choice, job);
  if (!fit) return tl::unexpected(fit.error());
  if (l_mm == 0.0) return MeasuredSurface{std::move(field), std::move(fit->form), fit->numbers};
  const auto rest = engine::withoutForm(field, fit->form, job);
  if (!rest) return tl::unexpected(rest.error());
  auto rough = wavesOf(*rest, l_mm, engine::Waves::kShort, job);
  if (!rough) return tl::unexpected(rough.error());
  return MeasuredSurface{*std::move(rough),
                         engine::PolynomialForm{0, fit->form.width(), fit->form.height(), 0.0, {0.0}},
                         fit->numbers};
}

engine::Result<engine::ArealParameters> parametersOf(const engine::Version& field,
                                                     const MeasureTool::Options& options, Curves curves,
                                                     engine::TrialNoise noise, engine::JobControl& job) {
  const auto surface = limitedSurface(field, options, job);
  if (!surface) return tl::unexpected(surface.error());
  engine::ArealOptions areal;
  areal.region = regionOf(options.where);
  areal.fitted = surface->numbers;
  if (curves == Curves::kWith) {
    areal.at_ratios = curveRatios();
    areal.analysis = true;
  }
  choose(choiceOf(options), areal);
  return engine::measureAreal(surface->field, surface->form, engine::optionsOf(areal, noise), job);
}

struct MeasuredState {
  Report report;  // as `fettle measure` makes it
  SurfaceCurves curves;
};

engine::Result<MeasuredState> measuredState(const engine::Version& field, const MeasureTool::Options& options,
                                            engine::JobControl& job) {
  auto measured = parametersOf(field, options, Curves::kWith, engine::TrialNoise::kOwn, job);
  if (!measured) return tl::unexpected(measured.error());
  MeasuredState state{Report(), curvesOf(*measured, field.grid())};
  if (std::isnan(measured->sq)) state.curves.heights.clear();
  Report chosen;
  addChosen(chosen, choiceOf(options), *measured);
  // The noise says nothing of the curves, whose autocorrelation is as large as the field.
  measured->heights.clear();
  measured->analysis.reset();
  addAreal(state.report, *measured, {}, field.grid());
  state.report.update(chosen);
  if (!options.noise) return state;
  const auto noise = engine::measureNoise(field, job);
  if (!noise) return tl::unexpected(noise.error());
  if (!(noise->sigma >= 0.0)) return state;
  auto effects = engine::arealEffects(
      field, *noise, *measured,
      [&](const engine::Version& noisy, engine::TrialNoise of) {
        return parametersOf(noisy, options, Curves::kWithout, of, job);
      },
      {.pairs = kNoisePairs}, job);
  if (!effects) return tl::unexpected(effects.error());
  addNoise(state.report, {noise->sigma, 2 * kNoisePairs, *std::move(effects)}, field.grid());
  return state;
}

}  // namespace

void MeasureTool::measure(const LoopClient& client, const engine::SampleRect& seen, const ReadAs& across,
                          const ReadAs& heights) {
  asked_ = options;
  work_.begin([field = client.newest(), scan = client.original(), seen, across, heights,
               what = options](engine::JobControl& job) -> engine::Result<Work> {
    Work work{field, {}};
    work.figures.options = what;
    work.figures.before = engine::measureChange(scan, field).tiles > 0;
    engine::Version after = field, before = scan;
    if (auto status = checkRatios(what); !status) return tl::unexpected(status.error());
    if (auto status = checkScales(what); !status) return tl::unexpected(status.error());
    if (what.where == Where::kVisible) {
      if (seen.columns <= 0 || seen.rows <= 0)
        return engine::inputError("nothing of the field is visible", "", "move the view to it");
      for (engine::Version* state : {&after, &before}) {
        auto marked = markedWhereSeen(*state, seen, job);
        if (!marked) return tl::unexpected(marked.error());
        *state = *std::move(marked);
      }
    } else if (what.where != Where::kAll && work.figures.before) {
      // The marks of the field count for the scan as well.
      auto marked = withMarksOf(before, after, job);
      if (!marked) return tl::unexpected(marked.error());
      before = *std::move(marked);
    }
    std::vector<Report> reports;
    if (work.figures.before) {
      auto state = measuredState(before, what, job);
      if (!state) return tl::unexpected(state.error());
      reports.push_back(std::move(state->report));
      work.figures.curves.push_back(std::move(state->curves));
    }
    auto state = measuredState(after, what, job);
    if (!state) return tl::unexpected(state.error());
    work.figures.samples = state->report["samples"].get<std::int64_t>();
    reports.push_back(std::move(state->report));
    work.figures.curves.push_back(std::move(state->curves));
    work.figures.lines = arealLines(reports, across, heights);
    return work;
  });
}

}  // namespace fettle::app
