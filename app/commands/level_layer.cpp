#include "app/commands/level_layer.h"

#include <memory>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "app/commands/estimate_option.h"
#include "app/commands/known_steps.h"
#include "app/commands/levelling.h"
#include "app/commands/original_scan.h"
#include "app/commands/recipe_file.h"
#include "app/commands/scan_files.h"
#include "app/terminal.h"
#include "app/work/memory_places.h"
#include "app/work/streams.h"
#include "app/work/through_noise.h"
#include "engine/field/piece.h"
#include "engine/field/seen_field.h"
#include "engine/field/upright.h"
#include "engine/formats/formats.h"

namespace fettle::app {

namespace {

// The form of the samples, upright, that count.
engine::Result<engine::FittedForm> fitOver(const engine::Version& samples,
                                           const std::optional<engine::Version>& original,
                                           const FormArguments& form, const engine::Imported& imported,
                                           const std::string& scan, engine::JobControl& job) {
  auto counted = countedOf(engine::upright(samples), original, scan, form, job);
  if (!counted) return tl::unexpected(counted.error());
  auto fit = formOf(*counted, scan, imported, form, job);
  if (fit)
    if (auto status = addThroughNoise(*fit, *counted, formChoiceOf(form), job); !status)
      return tl::unexpected(status.error());
  return fit;
}

tl::unexpected<engine::Error> noLayer(const std::string& scan) {
  return engine::inputError("no form lies over the scan", shownInput(scan),
                            "name a session of fettle level --layer put");
}

// Files store the form beside the samples; what stays in memory is what is seen.
engine::Result<engine::Version> shownIn(const BatchTask& task, const engine::Version& version,
                                        engine::JobControl& job) {
  if (memoryPlace(task.out) == nullptr) return version;
  const auto seen = engine::SeenField::of(version, job);
  if (!seen) return tl::unexpected(seen.error());
  return seen->seen();
}

engine::Result<Foreseen> foreseeLayer(const LayerChange& change, const BatchTask& task,
                                      const engine::Version& samples,
                                      const std::optional<engine::Version>& original,
                                      engine::JobControl& job) {
  PlannedWork planned{.field = samples,
                      .original = original ? *original : samples,
                      .steps = {},
                      .out = task.out,
                      .extension = isStream(task.out) ? withDot(task.to) : engine::extensionOf(task.out),
                      .writing = change.writing};
  planned.writing.original = original;
  if (change.layer == kLayerPut) {
    PlannedOnPieces fit = plannedLayer(samples, change.form, Lowered::kOnce);
    fit.fields = 2;  // what is seen is not made here
    planned.steps.emplace_back(std::move(fit));
  }
  return foresee(planned, shownOutput(task.out), change.estimate, job);
}

}  // namespace

std::vector<Word> layerWords() {
  return {{kLayerPut,
           "lay the form over the scan: it is taken out of what is seen, touched and measured, no sample "
           "changes"},
          {kLayerRemove, "take the layer of a session away: its samples are what they are"},
          {kLayerBake, "make what is seen of a session its samples"}};
}

engine::Status checkLayer(const std::string& layer, const FormArguments& form,
                          const std::vector<BatchTask>& tasks) {
  const bool put = layer == kLayerPut;
  if (put && form.form == "none")
    return engine::inputError("there is no form to lay over a scan", "--form",
                              "name another than none, or take --layer remove");
  const FormArguments usual;
  if (!put)
    for (const auto& [given, option] : {std::pair(form.form != usual.form, "--form"),
                                        {form.robust, "--robust"},
                                        {form.region != usual.region, "--region"},
                                        {!form.marks.empty(), "--marks"},
                                        {!form.through.empty(), "--through"}})
      if (given)
        return engine::inputError("the session's layer has its form", option, "omit it, or take --layer put");
  if (layer == kLayerBake) return {};
  for (const BatchTask& task : tasks)
    if (memoryPlace(task.out) == nullptr && !writesSession(task))
      return engine::inputError("only a session stores samples and the form over them", shownOutput(task.out),
                                "write a session, NAME.fettle");
  return {};
}

PlannedOnPieces plannedLayer(const engine::Version& samples, const FormArguments& form, Lowered lowered) {
  PlannedOnPieces fit = plannedLevel(samples, samples, {}, form, lowered);
  // What is seen is lowered, what is stored is not.
  fit.work = [&samples, lower = fit.work](const engine::SampleRect& r,
                                          engine::JobControl& own) -> engine::Result<engine::Version> {
    auto seen = lower(r, own);
    if (!seen) return seen;
    return engine::pieceOf(samples, r.column, r.row, r.columns, r.rows);
  };
  fit.uneven = true;  // a session packs smooth places better than rough ones
  return fit;
}

engine::Result<Layered> withLayer(const std::string& layer, const FormArguments& form,
                                  const engine::Version& field, const engine::Version& original,
                                  const engine::Imported& imported, const std::string& scan,
                                  engine::JobControl& job) {
  if (layer != kLayerPut && field.seenOf() == nullptr) return noLayer(scan);
  if (layer == kLayerBake) return Layered{engine::madeHeights(field), engine::madeHeights(original), {}};
  auto samples = engine::withoutLayer(field, job);
  if (!samples) return tl::unexpected(samples.error());
  auto first = engine::withoutLayer(original, job);
  if (!first) return tl::unexpected(first.error());
  if (layer == kLayerRemove) return Layered{*std::move(samples), *std::move(first), {}};
  auto fit = fitOver(*samples, std::nullopt, form, imported, scan, job);
  if (!fit) return tl::unexpected(fit.error());
  const auto over = std::make_shared<const engine::NominalForm>(fit->form);
  const auto seen = engine::SeenField::of(samples->withForm(over), job);
  if (!seen) return tl::unexpected(seen.error());
  auto limit = engine::seenNear(first->withForm(over), seen->seen(), job);
  if (!limit) return tl::unexpected(limit.error());
  return Layered{seen->seen(), *std::move(limit), *std::move(fit)};
}

engine::Result<Report> changeLayer(const LayerChange& change, const BatchTask& task,
                                   engine::JobControl& job) {
  const std::string& layer = change.layer;
  const FormArguments& form = change.form;
  const auto imported = loadScan(task.in, change.reading, job);
  if (!imported) return tl::unexpected(imported.error());
  const engine::Grid& grid = imported->field.grid();
  if (layer != kLayerPut && imported->field.seenOf() == nullptr) return noLayer(task.in);
  const auto samples = engine::withoutLayer(imported->field, job);
  if (!samples) return tl::unexpected(samples.error());
  std::optional<engine::Version> original;
  if (imported->original) {
    auto first = engine::withoutLayer(*imported->original, job);
    if (!first) return tl::unexpected(first.error());
    original = *std::move(first);
  }
  engine::Result<Foreseen> foreseen;
  if (memoryPlace(task.out) == nullptr) foreseen = foreseeLayer(change, task, *samples, original, job);
  if (!foreseen) return tl::unexpected(foreseen.error());
  if (foreseen->only) return *std::move(foreseen->only);
  Report report{{"layer", layer}};
  engine::Version result = *samples;
  if (layer == kLayerPut) {
    if (imported->field.seenOf() != nullptr)
      warn(fmt::format("{}: the form that lay over it, {}, is replaced", shownInput(task.in),
                       formWordOf(*imported->field.seenOf()->form())));
    const auto fit = fitOver(*samples, original, form, *imported, task.in, job);
    if (!fit) return tl::unexpected(fit.error());
    warnOfLeaving(*fit, task.in);
    const auto over = std::make_shared<const engine::NominalForm>(fit->form);
    for (engine::Version* version : {&result, original ? &*original : nullptr}) {
      if (version == nullptr) continue;
      auto shown = shownIn(task, version->withForm(over), job);
      if (!shown) return tl::unexpected(shown.error());
      *version = *std::move(shown);
    }
    addForm(report, form, *fit, grid);
    report.update({{"samples", fit->samples}, {"rms", fit->rms}, {"rounds", fit->rounds}});
    if (form.robust) report["rms_counted"] = fit->rms_counted;
  } else {
    report["form"] = formWordOf(*imported->field.seenOf()->form());
  }
  if (layer == kLayerBake) {
    // Changes since the scan stay what they were: its first state loses the same form.
    result = imported->field.withSeenOf(nullptr);
    if (imported->original) original = imported->original->withSeenOf(nullptr);
  }
  engine::ExportOptions exported = change.writing;
  exported.original = std::move(original);
  auto known = KnownSteps::of(*imported, task, job);
  if (!known) return tl::unexpected(known.error());
  RecipeForm step{layer, form};
  if (form.region == "measured") {
    known->leftOut("that filled samples did not count in the form");
    step.form.region = "all";
  }
  known->didToBoth(step);
  known->note(exported);
  if (auto status = saveField(result, task.out, job, exported, task.to); !status)
    return tl::unexpected(status.error());
  report["unit"] = grid.height_unit.name;
  report["hash"] = hashOf(result);
  return report;
}

}  // namespace fettle::app
