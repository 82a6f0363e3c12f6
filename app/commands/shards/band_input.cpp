#include "app/commands/shards/band_input.h"

#include <string>
#include <utility>

#include <fmt/format.h>

#include "app/commands/original_scan.h"
#include "app/commands/output_checks.h"
#include "app/commands/scan_files.h"
#include "app/terminal.h"
#include "app/work/memory_places.h"
#include "app/work/open_document.h"
#include "app/work/streams.h"
#include "engine/field/piece.h"
#include "engine/filter/catalogue.h"
#include "engine/formats/formats.h"

namespace fettle::app {

namespace {

using engine::RowSpan;

engine::Version rowsWithSign(const engine::Version& field, const engine::Version& like, const RowSpan& rows) {
  const bool same_sign = field.reader().sign() == like.reader().sign();
  return engine::rowsOf(same_sign ? field : field.inverted(), rows.first, rows.count);
}

}  // namespace

bool hasCompanions(const BandWork& work) {
  return !work.keep.empty() || !work.only.empty() || !work.lines.empty() || !work.original.empty();
}

engine::Result<BandInput> wholeOf(const BandWork& work, engine::JobControl& job) {
  auto imported = loadScan(work.in, work.reading, job);
  if (!imported) return tl::unexpected(imported.error());
  if (imported->field.seenOf() != nullptr)
    return engine::inputError("a form lies over the session, which is of the whole field", work.in,
                              "bake it first: fettle level --layer bake");
  auto original = originalOf(*imported, work.original, work.reading, job);
  if (!original) return tl::unexpected(original.error());
  auto marked = withMarks(imported->field, work.only.empty() ? work.keep : work.only, job);
  if (!marked) return tl::unexpected(marked.error());
  auto lined = withLines(*marked, work.lines, job);
  if (!lined) return tl::unexpected(lined.error());
  return BandInput{*std::move(lined), *std::move(original)};
}

engine::Result<LoadedBand> loadBand(const BandWork& work,
                                    const std::function<RowSpan(const engine::Grid&)>& rows_in,
                                    engine::JobControl& job) {
  const auto import = importOptions(work.reading);
  if (!import) return tl::unexpected(import.error());
  if (!hasCompanions(work)) {
    const auto grid = engine::importGrid(work.in, *import);
    if (!grid) return tl::unexpected(grid.error());
    if (*grid) {
      const RowSpan rows = rows_in(**grid);
      auto band = engine::importRows(work.in, *import, rows.first, rows.count, job);
      if (!band) return tl::unexpected(band.error());
      for (const std::string& warning : band->warnings) warn(fmt::format("{}: {}", work.in, warning));
      return LoadedBand{{band->field, band->field}, rows, **grid};
    }
  }
  auto whole = wholeOf(work, job);
  if (!whole) return tl::unexpected(whole.error());
  const RowSpan rows = rows_in(whole->input.grid());
  engine::Version original = rowsWithSign(whole->original, whole->input, rows);
  return LoadedBand{
      {engine::rowsOf(whole->input, rows.first, rows.count), std::move(original)}, rows, whole->input.grid()};
}

Report settingsOf(const BandWork& work) {
  Report settings{{"in", work.in}, {"out", work.out}};
  if (work.spec) {
    const engine::FilterSpec& spec = *work.spec;
    settings["filter"] = engine::name(spec.kind);
    settings["window"] = spec.window;
    settings["sigma"] = spec.sigma;
    settings["nesting"] = spec.nesting_mm;
    settings["element"] = engine::kElementWords[static_cast<std::size_t>(spec.element)];
    settings["passes"] = spec.passes;
  }
  const std::pair<const char*, const std::string&> texts[] = {{"range-sigma", work.range_sigma},
                                                              {"max-change", work.max_change},
                                                              {"keep", work.keep},
                                                              {"only", work.only},
                                                              {"lines", work.lines},
                                                              {"original", work.original}};
  for (const auto& [word, text] : texts)
    if (!text.empty()) settings[word] = text;
  if (const std::string reading = scanOptionsText(work.reading); !reading.empty())
    settings["reading"] = reading;
  if (work.writing.tiff_compression) settings["compress"] = static_cast<int>(*work.writing.tiff_compression);
  if (work.writing.cloud_optimised) settings["cloud-optimised"] = true;
  if (work.writing.ascii) settings["ascii"] = true;
  return settings;
}

engine::Status checkBandFiles(const BandWork& work, engine::JobControl& job) {
  if (isStream(work.in) || memoryPlace(work.in) != nullptr)
    return engine::inputError("shards read a file", shownInput(work.in), "name one");
  if (isStream(work.out) || memoryPlace(work.out) != nullptr)
    return engine::inputError("shards write a file", shownOutput(work.out), "name one");
  if (isSessionPath(work.out))
    return engine::inputError("a session cannot be written in shards", work.out, "name a .tif");
  if (work.writing.mesh || work.writing.max_error)
    return engine::inputError("a mesh is made of the whole field", work.out, "leave shards out");
  return checkOutputs({{work.out, OutputKind::kField, {}}},
                      {work.in, work.keep, work.only, work.lines, work.original}, Replacing::kNoWork, job);
}

std::optional<engine::FilterSpec> plannedSpec(const BandWork& work, const ShardPlan& plan) {
  std::optional<engine::FilterSpec> spec = work.spec;
  if (spec && plan.range_sigma) spec->range_sigma = *plan.range_sigma;
  if (spec) spec->max_change = plan.max_change;
  return spec;
}

}  // namespace fettle::app
