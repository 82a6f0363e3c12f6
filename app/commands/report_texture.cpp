#include "app/commands/report_texture.h"

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "app/commands/measuring.h"
#include "app/commands/surface_plots.h"
#include "app/plots/gnuplot.h"
#include "app/terminal.h"
#include "app/work/areal_table.h"
#include "app/work/form_figures.h"
#include "app/work/layer_over.h"
#include "app/work/surface_numbers.h"
#include "engine/marks/chosen_marks.h"
#include "render/plan/number_text.h"

namespace fettle::app {

namespace {

// Of each state.
struct MeasuredStates {
  std::vector<engine::ArealParameters> measured;
  int trials = 0;         // with noise, for errors
  std::int64_t part = 0;  // samples they were made on; 0: all
};

// Surface texture, of one or several states side by side; `states` names them.
ReportPage::Table textureTable(const std::vector<ArealLine>& lines, const std::vector<std::string>& states,
                               std::string note) {
  ReportPage::Table table{"Surface texture", std::move(note), {}, {}};
  table.heads = {"Parameter", "Meaning"};
  table.heads.insert(table.heads.end(), states.begin(), states.end());
  table.heads.emplace_back("Unit");
  for (const ArealLine& line : lines) {
    std::vector<std::string> row = {line.name, line.text};
    row.insert(row.end(), line.values.begin(), line.values.end());
    row.push_back(line.unit);
    table.rows.push_back(std::move(row));
  }
  return table;
}

// The same without noise, with standard errors.
ReportPage::Table noiseTable(const std::vector<ArealLine>& lines, std::vector<std::string> heads,
                             const MeasuredStates& found) {
  ReportPage::Table table{
      "Surface texture without noise",
      fmt::format(
          "+- the standard error that the noise of the scan puts on it, by {} trials with more of it{}. "
          "Noise "
          "that neighbours share in both directions, as in filtered scans, is not counted.",
          found.trials,
          found.part > 0 ? fmt::format(" on {} samples of the scan, which stand for all", found.part) : ""),
      std::move(heads),
      {}};
  table.heads.emplace_back("Unit");
  for (const ArealLine& line : lines) {
    std::vector<std::string> row = {line.name};
    for (const std::string& without : line.without) row.push_back(without.empty() ? "-" : without);
    row.push_back(line.unit);
    table.rows.push_back(std::move(row));
  }
  return table;
}

engine::Status addTexture(ReportDraft& draft, MeasuredStates& found) {
  std::vector<Report> reports;
  std::string tilt;
  const engine::Version& last = draft.states.back().field;
  for (const ShownState& state : draft.states) {
    // The marks of the field choose in the scan before it as well, which has none of them yet.
    engine::Result<engine::Version> chosen = state.field;
    if (choosesByMarks(draft.options.form.region) && &state.field != &last)
      chosen = engine::withMarksFrom(state.field, last, draft.job);
    if (!chosen) return tl::unexpected(chosen.error());
    const auto counted =
        countedOf(*chosen, draft.imported.original, draft.options.scan, draft.options.form, draft.job);
    if (!counted) return tl::unexpected(counted.error());
    const auto limited = scaleLimited(*counted, draft.options.scan, draft.imported, draft.options.form,
                                      draft.options.scale, draft.job);
    if (!limited) return tl::unexpected(limited.error());
    engine::ArealOptions areal;
    areal.region = formChoiceOf(draft.options.form).region;
    areal.at_ratios = curveRatios();
    areal.analysis = true;
    const ArealChoice choice = choiceOf(draft.options.areal);
    choose(choice, areal);
    areal.fitted = limited->fit.numbers;
    auto parameters = engine::measureAreal(limited->field, limited->form, areal, draft.job);
    if (!parameters) return tl::unexpected(parameters.error());
    addForm(reports.emplace_back(), draft.options.form, limited->fit, state.field.grid());
    addScale(reports.back(), draft.options.scale);
    addAreal(reports.back(), *parameters, {}, state.field.grid());
    addChosen(reports.back(), choice, *parameters);
    engine::ArealParameters stated = *parameters;
    stated.heights.clear();
    areal.at_ratios.clear();
    areal.analysis = false;
    const auto noise = noiseOfMeasured({*counted, draft.options.scan, draft.imported, draft.options.form,
                                        draft.options.scale, areal, draft.options.noise_trials},
                                       *limited, stated, draft.job);
    if (!noise) return tl::unexpected(noise.error());
    if (*noise) {
      addNoise(reports.back(), (*noise)->noise, state.field.grid());
      found.trials = (*noise)->noise.trials;
      found.part = (*noise)->samples;
    }
    found.measured.push_back(*std::move(parameters));
    draft.report[reports.size() == draft.states.size() ? "sq" : "sq_before"] = reports.back()["sq"];
    if (limited->fit.fit)
      tilt += fmt::format(" {}: {}.", state.name, formFigures(limited->fit.form, state.field.grid()));
    if (reports.back().contains("tilt_x"))
      tilt += fmt::format(" {}: tilted {:.4g} degrees along x, {:.4g} along y.", state.name,
                          reports.back()["tilt_x"].get<double>(), reports.back()["tilt_y"].get<double>());
  }
  const std::vector<ArealLine> lines = arealLines(
      reports, unitRead(render::fieldUnits(draft.imported.field.grid(), 0.0, 1.0).length), std::nullopt);
  addScale(draft.report, draft.options.scale);
  std::string scale = scaleText(draft.report, "; ");
  if (const std::string layer = layerText(layerOver(draft.imported.field)); !layer.empty())
    scale = layer + (scale.empty() ? "" : "; ") + scale;
  draft.page.parts.emplace_back(textureTable(
      lines, draft.heads({}),
      fmt::format("ISO 25178-2 about the form {}{}, over {} samples{}{}.{}", draft.options.form.form,
                  draft.options.form.robust ? " (robust)" : "",
                  draft.options.form.region == "all" ? "all" : "the " + draft.options.form.region,
                  scale.empty() ? "" : "; ", scale, tilt)));
  if (found.trials > 0) draft.page.parts.emplace_back(noiseTable(lines, draft.heads({"Parameter"}), found));
  return {};
}

// The curves of all states over each other. They are no reason to refuse a report: without gnuplot, or where there was
// no memory for an autocorrelation, a sentence stands in their place.
engine::Status addCurvePictures(ReportDraft& draft, const MeasuredStates& found) {
  draft.page.parts.emplace_back(ReportPage::Heading{"Curves"});
  draft.report["curves"] = 0;
  if (const auto able = plotsCanBeMade(); !able) {
    const std::string why = fmt::format("No curves are drawn: {}", able.error().line());
    warn(why);
    draft.page.parts.emplace_back(ReportPage::Paragraph{why + "."});
    return {};
  }
  std::vector<PlottedState> all, analysed;
  std::string none;
  for (std::size_t i = 0; i < draft.states.size(); ++i) {
    const PlottedState state{draft.states.size() > 1 ? draft.states[i].name : "", &found.measured[i]};
    if (std::isnan(found.measured[i].sq)) {
      none = found.measured[i].not_stated.front().reason;
      continue;
    }
    all.push_back(state);
    if (found.measured[i].analysis != nullptr)
      analysed.push_back(state);
    else
      none = found.measured[i].spatial.no_sal;
  }
  if (all.empty()) {
    draft.page.parts.emplace_back(ReportPage::Paragraph{fmt::format("No curves are drawn: {}.", none)});
    return {};
  }
  int drawn = 0;
  const auto draw = [&](const char* caption, const std::string& script) -> engine::Status {
    auto svg = drawnByGnuplot(script);
    if (!svg) return tl::unexpected(svg.error());
    draft.page.parts.emplace_back(ReportPage::Plot{caption, *std::move(svg)});
    ++drawn;
    return {};
  };
  const engine::Grid& grid = draft.imported.field.grid();
  if (auto status = draw("Material ratio (Abbott) curve", abbottPlot(all, grid)); !status) return status;
  if (!analysed.empty()) {
    if (auto status =
            draw("Autocorrelation in the directions of its fastest and slowest decay, or along x and y",
                 correlationPlot(analysed));
        !status)
      return status;
  }
  if (analysed.size() < draft.states.size())
    draft.page.parts.emplace_back(ReportPage::Paragraph{
        fmt::format("No autocorrelation and no spectrum{}: {}.", analysed.empty() ? "" : " of one state",
                    none.empty() ? "there was no memory for it" : none)});
  const auto beside =
      std::erase_if(analysed, [](const PlottedState& state) { return !hasSpectrum(*state.measured); });
  if (beside > 0)
    draft.page.parts.emplace_back(
        ReportPage::Paragraph{fmt::format("No spectrum{}: no samples of a line lie beside each other.",
                                          analysed.empty() ? "" : " of one state")});
  if (!analysed.empty())
    if (auto status =
            draw("Power spectral density of profiles along x and along y", spectrumPlot(analysed, grid));
        !status)
      return status;
  draft.report["curves"] = drawn;
  return {};
}

}  // namespace

engine::Status addTextureAndCurves(ReportDraft& draft) {
  MeasuredStates found;
  if (auto status = addTexture(draft, found); !status) return status;
  draft.noise_trials = found.trials;
  return addCurvePictures(draft, found);
}

}  // namespace fettle::app
