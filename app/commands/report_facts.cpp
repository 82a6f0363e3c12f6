#include "app/commands/report_facts.h"

#include <cstddef>
#include <cstdint>
#include <iterator>
#include <utility>

#include <fmt/format.h>

#include "app/commands/scan_files.h"
#include "app/work/layer_over.h"
#include "app/work/read_units.h"
#include "engine/fill/filled_samples.h"
#include "engine/inspect/noise_model.h"
#include "render/plan/number_text.h"

namespace fettle::app {

namespace {

std::string plain(double value) {
  return std::isfinite(value) ? fmt::format("{:.6g}", value) : "no sample";
}

}  // namespace

engine::Status compareStates(ReportDraft& draft) {
  if (draft.states.size() < 2) return {};
  const auto found = engine::compareFields(draft.states.front().field, draft.states.back().field, draft.job);
  if (!found) return tl::unexpected(found.error());
  draft.change = *found;
  return {};
}

engine::Status addScanFacts(ReportDraft& draft) {
  const engine::Grid& grid = draft.imported.field.grid();
  const ReadAs across = unitRead(render::fieldUnits(grid, 0.0, 1.0).length);
  ReportPage::Table about{"Scan", "", {"", ""}, {}};
  about.rows = {
      {"Samples", fmt::format("{} x {}", grid.width, grid.height)},
      {"Spacing", fmt::format("{:.6g} x {:.6g} {}", grid.spacing_x / across.size,
                              grid.spacing_y / across.size, across.name)},
      {"Size", fmt::format("{:.6g} x {:.6g} {}", (grid.width - 1) * grid.spacing_x / across.size,
                           (grid.height - 1) * grid.spacing_y / across.size, across.name)},
      {"Lower left corner", fmt::format("{:.10g}, {:.10g} {}", grid.origin_x / across.size,
                                        grid.origin_y / across.size, across.name)},
  };
  if (draft.imported.field.lines() != nullptr)
    about.rows.push_back({"Edge lines", fmt::format("{}", draft.imported.field.lines()->size())});
  if (const std::string layer = layerOver(draft.imported.field); !layer.empty())
    about.rows.push_back({"Form over the scan, left out of all figures", layer});
  if (draft.imported.original)
    if (const std::int64_t filled = engine::countFilled(draft.imported.field, *draft.imported.original);
        filled > 0)
      about.rows.push_back({"Filled samples, not measured", fmt::format("{}", filled)});
  for (const std::string& warning : draft.imported.warnings) about.rows.push_back({"Note", warning});
  draft.page.parts.emplace_back(std::move(about));

  ReportPage::Table heights{"Heights",
                            "",
                            draft.heads({""}),
                            {{"Holes"}, {"Marked samples"}, {"Least"}, {"Mean"}, {"Largest"}, {"Hash"}}};
  heights.heads.emplace_back("Unit");
  for (const ShownState& state : draft.states) {
    const engine::FieldSummary summary = engine::summarize(state.field);
    const std::string cells[] = {fmt::format("{}", summary.no_data),
                                 fmt::format("{}", summary.marked),
                                 plain(summary.min),
                                 plain(summary.mean),
                                 plain(summary.max),
                                 fmt::format("#{}", hashOf(state.field))};
    for (std::size_t i = 0; i < std::size(cells); ++i) heights.rows[i].push_back(cells[i]);
  }
  draft.report["hash"] = hashOf(draft.states.back().field);
  addLayer(draft.report, draft.imported.field);
  if (draft.states.size() > 1) draft.report["original_hash"] = hashOf(draft.states.front().field);
  std::vector<std::string> row = {"Noise of the whole scan, standard deviation"};
  for (const ShownState& state : draft.states) {
    const auto noise = engine::measureNoise(state.field, draft.job);
    if (!noise) return tl::unexpected(noise.error());
    row.push_back(plain(noise->sigma));
  }
  heights.rows.insert(heights.rows.end() - 1, std::move(row));
  for (std::size_t i = 0; i < heights.rows.size(); ++i)
    heights.rows[i].push_back(i >= 2 && i + 1 < heights.rows.size() ? draft.heightUnit() : "");
  draft.page.parts.emplace_back(std::move(heights));
  return {};
}

engine::Status addChange(ReportDraft& draft) {
  if (!draft.change) return {};
  draft.page.parts.emplace_back(ReportPage::Table{
      "Change from before to after",
      fmt::format("Over the {} samples that both have.", draft.change->samples),
      {"", "", "Unit"},
      {{"Root mean square", plain(draft.change->rms), draft.heightUnit()},
       {"Mean", plain(draft.change->mean), draft.heightUnit()},
       {"99 % of the samples change by at most", plain(draft.change->p99), draft.heightUnit()},
       {"Largest", plain(draft.change->max_abs), draft.heightUnit()}}});
  draft.report["rms_change"] = draft.change->rms;
  draft.report["max_change"] = draft.change->max_abs;
  return {};
}

}  // namespace fettle::app
