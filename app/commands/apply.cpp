#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "app/commands/batch.h"
#include "app/commands/command.h"
#include "app/commands/estimate_option.h"
#include "app/commands/filling.h"
#include "app/commands/filter_warnings.h"
#include "app/commands/finished_scans.h"
#include "app/commands/known_steps.h"
#include "app/commands/level_layer.h"
#include "app/commands/levelling.h"
#include "app/commands/original_scan.h"
#include "app/commands/recipe_file.h"
#include "app/commands/region_option.h"
#include "app/commands/resume_option.h"
#include "app/commands/scan_files.h"
#include "app/commands/scan_options.h"
#include "app/commands/transforming.h"
#include "app/commands/typed_values.h"
#include "app/terminal.h"
#include "app/work/line_edits.h"
#include "app/work/memory_places.h"
#include "app/work/streams.h"
#include "engine/base/stopwatch.h"
#include "engine/field/piece.h"
#include "engine/field/seen_field.h"
#include "engine/field/tile_store.h"
#include "engine/fill/fill.h"
#include "engine/fill/filled_samples.h"
#include "engine/filter/catalogue.h"
#include "engine/filter/noise_range.h"
#include "engine/filter/pass.h"
#include "engine/formats/formats.h"
#include "engine/resume/work_identity.h"

namespace fettle::app {

namespace {

struct ApplyArguments {
  std::string recipe;
  BatchOptions files;
  int threads = 0;
  ResumeOptions resume;
  bool estimate = false;
  ScanOptions reading;
  engine::ExportOptions writing;
};

// One scan on its way through a recipe.
struct Applied {
  engine::Version field;
  engine::Version original;
  const BatchTask& task;
  const engine::Imported& imported;
  const ApplyArguments& options;
  Report steps = Report::array();

  [[nodiscard]] std::size_t step() const { return steps.size() + 1; }
};

// The output that the kept work of a step is named after: a finished step is read back while a later one goes on.
std::string keptOutOf(const std::string& out, std::size_t step) {
  return fmt::format("{}.step{}", out, step);
}

// For each filter of the recipe and each output, where its work is kept.
std::vector<BatchTask> keptTasks(const Recipe& recipe, const std::vector<BatchTask>& tasks) {
  std::vector<BatchTask> all;
  for (const BatchTask& task : tasks)
    for (std::size_t k = 0; k < recipe.steps.size(); ++k)
      if (std::holds_alternative<RecipeFilter>(recipe.steps[k]))
        all.push_back({task.in, isStream(task.out) ? task.out : keptOutOf(task.out, k + 1), task.to});
  return all;
}

engine::Status take(const RecipeFilter& step, Applied& at, engine::JobControl& job) {
  engine::FilterSpec spec = step.spec;
  spec.threads = at.options.threads;
  if (step.range_sigma) spec.range_sigma = step.range_sigma->in(at.field.grid());
  if (step.max_change) spec.max_change = step.max_change->in(at.field.grid());
  if (spec.scope == engine::FilterScope::kOnlyMarks && at.field.reader().root().marked_children == 0)
    warn(fmt::format("{}: step {} filters marked samples only, and none is marked", shownInput(at.task.in),
                     at.step()));
  const auto ready =
      engine::withMeasuredRange(spec, step.noise_of == NoiseOf::kOriginal ? at.original : at.field, job);
  if (!ready) return tl::unexpected(ready.error());
  const std::string out = keptOutOf(at.task.out, at.step());
  auto kept = openKeptWork(at.options.resume, out, at.field, at.original, *ready, "");
  if (!kept) return tl::unexpected(kept.error());
  engine::FilterTuning tuning;
  tuning.work = kept->get();
  auto filtered = engine::applyFilter(at.field, at.original, *ready, tuning, job);
  if (!filtered) return tl::unexpected(continued(filtered.error(), out, *std::move(kept)));
  at.field = std::move(filtered->field);
  Report done{{"do", "filter"},
              {"filter", engine::filterOf(spec.kind).word},
              {"changed", filtered->report.changed},
              {"rms_change", filtered->report.rms_change}};
  if (engine::hasRange(spec.kind)) done["range_sigma"] = ready->range_sigma;
  addWeightless(done, engine::filterOf(spec.kind), filtered->report,
                fmt::format("{}: step {}", shownInput(at.task.in), at.step()));
  if (auto status = addUnjudged(done, at.field, *ready,
                                fmt::format("{}: step {}", shownInput(at.task.in), at.step()), job);
      !status)
    return tl::unexpected(status.error());
  warnOfCutoff(*ready, at.field.grid(), fmt::format("{}: step {}", shownInput(at.task.in), at.step()));
  addKept(done, kept->get(), spec.passes);
  at.steps.push_back(std::move(done));
  return {};
}

engine::Status take(const RecipeEdges& step, Applied& at, engine::JobControl& job) {
  const auto map = engine::findEdges(at.field, step.scale, job);
  if (!map) return tl::unexpected(map.error());
  if (step.become == EdgesBecome::kLines) {
    auto lined = drawSuggestion(at.field, *map, step.choice, job);
    if (!lined) return tl::unexpected(lined.error());
    at.field = *std::move(lined);
    at.steps.push_back({{"do", "locate_edges"}, {"lines", at.field.lines() ? at.field.lines()->size() : 0}});
    return {};
  }
  auto marked = engine::suggestMarks(at.field, *map, step.choice, job);
  if (!marked) return tl::unexpected(marked.error());
  at.field = std::move(marked->field);
  at.steps.push_back({{"do", "mark_edges"}, {"lines", marked->lines}, {"samples", marked->samples}});
  return {};
}

engine::Status take(const RecipeInvert&, Applied& at, engine::JobControl&) {
  at.field = at.field.inverted();
  at.steps.push_back({{"do", "invert"}});
  return {};
}

engine::Status take(const RecipeLevel& step, Applied& at, engine::JobControl& job) {
  const auto counted = countedOf(at.field, std::nullopt, at.task.in, step.form, job);
  if (!counted && counted.error().kind == engine::ErrorKind::kInput && choosesByMarks(step.form.region))
    return engine::inputError(counted.error().what, shownInput(at.task.in),
                              "let a step that marks come before it, or level by region = \"all\"");
  if (!counted) return tl::unexpected(counted.error());
  const auto levelling = levellingOf(*counted, at.task.in, at.imported, step.lines, step.form, job);
  if (!levelling) return tl::unexpected(levelling.error());
  auto levelled = levelling->takenFrom(at.field, job);
  if (!levelled) return tl::unexpected(levelled.error());
  // Changes are limited from the scan without the same form.
  const bool same_sign = at.original.reader().sign() == at.field.reader().sign();
  auto original = levelling->takenFrom(same_sign ? at.original : at.original.inverted(), job);
  if (!original) return tl::unexpected(original.error());
  at.field = *std::move(levelled);
  at.original = *std::move(original);
  Report done{{"do", "level"}};
  addLevelling(done, step.lines, step.form, *levelling, at.field.grid());
  done["rms"] = levelling->fit.rms;
  if (step.form.robust) done["rms_counted"] = levelling->fit.rms_counted;
  at.steps.push_back(std::move(done));
  return {};
}

engine::Status take(const RecipeFill& step, Applied& at, engine::JobControl& job) {
  const auto options = fillOptionsOf(step.what, at.field.grid());
  if (!options) return tl::unexpected(options.error());
  auto filled = engine::fillHoles(at.field, *options, job);
  if (!filled && filled.error().kind == engine::ErrorKind::kInput)
    return engine::inputError(filled.error().what, shownInput(at.task.in), filled.error().remedy);
  if (!filled) return tl::unexpected(filled.error());
  // As fettle fill has it.
  auto measured = engine::withoutReplaced(at.original, at.field, filled->field, job);
  if (!measured) return tl::unexpected(measured.error());
  at.original = *std::move(measured);
  at.field = std::move(filled->field);
  at.steps.push_back({{"do", "fill"},
                      {"method", step.what.method},
                      {"holes", filled->holes},
                      {"filled_holes", filled->filled_holes},
                      {"filled", filled->filled}});
  return {};
}

engine::Status take(const RecipeRemove& step, Applied& at, engine::JobControl& job) {
  const auto options = removeOptionsOf(step.what, at.field.grid());
  if (!options) return tl::unexpected(options.error());
  const auto counted = countedOrNone(at.field, std::nullopt, at.task.in, {.region = step.what.region}, job);
  if (!counted) return tl::unexpected(counted.error());
  auto removed = removedFrom(at.field, *counted, step.what.region, *options, at.task.in, job);
  if (!removed) return tl::unexpected(removed.error());
  at.field = std::move(removed->field);
  at.steps.push_back(
      {{"do", "remove"}, {"removed", removed->counts.removed}, {"spared", removed->counts.spared}});
  return {};
}

engine::Status take(const RecipeTransform& step, Applied& at, engine::JobControl& job) {
  const bool shared = at.original == at.field;
  auto field = transformed(at.field, step.what, job);
  if (!field) return tl::unexpected(field.error());
  warnOfFormLeft(at.field, field->field, at.task.in);
  // What changes are limited from goes along.
  auto original = shared ? field : transformed(at.original, step.what, job);
  if (!original) return tl::unexpected(original.error());
  at.field = std::move(field->field);
  at.original = std::move(original->field);
  const engine::Grid& grid = at.field.grid();
  at.steps.push_back({{"do", "transform"}, {"width", grid.width}, {"height", grid.height}});
  return {};
}

engine::Status take(const RecipeForm& step, Applied& at, engine::JobControl& job) {
  auto layered = withLayer(step.layer, step.form, at.field, at.original, at.imported, at.task.in, job);
  if (!layered) return tl::unexpected(layered.error());
  Report done{{"do", "form"}, {"layer", step.layer}};
  if (layered->fit) {
    addForm(done, step.form, *layered->fit, at.field.grid());
    done["rms"] = layered->fit->rms;
    if (step.form.robust) done["rms_counted"] = layered->fit->rms_counted;
  } else {
    done["form"] = formWordOf(*at.field.formOver());
  }
  at.field = std::move(layered->field);
  at.original = std::move(layered->original);
  at.steps.push_back(std::move(done));
  return {};
}

// What is seen under a form, as the next command would see it that reads the session which this one wrote: so that a recipe
// has the bits of its steps one by one.
engine::Status seeAsStored(Applied& at, engine::JobControl& job) {
  if (at.field.seenOf() == nullptr) return {};
  const auto stored = engine::restored(at.field, job);
  if (!stored) return tl::unexpected(stored.error());
  auto seen = engine::seenNear(*stored, at.field, job);
  if (!seen) return tl::unexpected(seen.error());
  at.field = *std::move(seen);
  return {};
}

// The steps that take long, of a scan as it is before the first one.
engine::Result<Foreseen> foreseeSteps(const ApplyArguments& options, const Recipe& recipe,
                                      const BatchTask& task, const engine::Version& field,
                                      const engine::Version& original, engine::JobControl& job) {
  FilterCompute processor(Compute::kCpu, nullptr);
  std::vector<engine::FilterSpec> specs;  // that the steps refer to
  specs.reserve(recipe.steps.size());
  std::vector<PlannedStep> steps;
  engine::Grid grid = field.grid();  // before a step
  const auto share = [&] {
    return static_cast<double>(grid.samples()) / static_cast<double>(field.grid().samples());
  };
  for (const RecipeStep& step : recipe.steps) {
    if (const auto* filter = std::get_if<RecipeFilter>(&step)) {
      engine::FilterSpec spec = filter->spec;
      spec.threads = options.threads;
      spec.scope = engine::FilterScope::kKeepMarks;  // marks of an earlier step are not there yet
      if (filter->range_sigma) spec.range_sigma = filter->range_sigma->in(field.grid());
      const auto ready =
          engine::withMeasuredRange(spec, filter->noise_of == NoiseOf::kOriginal ? original : field, job);
      // As in foresee(): the step says it itself.
      if (!ready && !options.estimate && ready.error().kind == engine::ErrorKind::kInput) return Foreseen{};
      if (!ready) return tl::unexpected(ready.error());
      specs.push_back(*ready);
      steps.emplace_back(PlannedFilter{specs.back(), processor, share()});
    } else if (const auto* edges = std::get_if<RecipeEdges>(&step)) {
      steps.emplace_back(
          PlannedOnPieces{[&field, edges](const engine::SampleRect& r, engine::JobControl& own) {
            const engine::Version piece = engine::pieceOf(field, r.column, r.row, r.columns, r.rows);
            const auto map = engine::findEdges(piece, edges->scale, own);
            if (!map) return engine::Result<engine::Version>(tl::unexpected(map.error()));
            if (edges->become == EdgesBecome::kLines) return drawSuggestion(piece, *map, edges->choice, own);
            auto marked = engine::suggestMarks(piece, *map, edges->choice, own);
            return marked ? engine::Result<engine::Version>(std::move(marked->field))
                          : engine::Result<engine::Version>(tl::unexpected(marked.error()));
          }});
    } else if (const auto* level = std::get_if<RecipeLevel>(&step)) {
      FormArguments form = level->form;
      form.region = "all";  // marks of an earlier step are not there yet, and shapes lie in what it made
      steps.emplace_back(plannedLevel(field, field, level->lines, form, Lowered::kTwice));
    } else if (const auto* layer = std::get_if<RecipeForm>(&step)) {
      // To take a layer away, or to make it heights, is no work on samples.
      if (layer->layer != kLayerPut) continue;
      FormArguments form = layer->form;
      form.region = "all";  // as of a level
      PlannedOnPieces over = plannedLayer(field, form, Lowered::kTwice);
      // What is seen, and what is seen of an original that differs, which small pieces do not show; a quarter more while it is made.
      const double fields = original == field && steps.empty() ? 1.25 : 2.25;
      over.memory_each = fields *
                         static_cast<double>(engine::fieldBytes(static_cast<std::uint64_t>(grid.width),
                                                                static_cast<std::uint64_t>(grid.height))) /
                         static_cast<double>(grid.samples());
      steps.emplace_back(std::move(over));
    } else if (const auto* filling = std::get_if<RecipeFill>(&step)) {
      const auto fill = fillOptionsOf(filling->what, grid);
      if (!fill) return tl::unexpected(fill.error());
      steps.emplace_back(plannedFill(field, *fill));
    } else if (const auto* removing = std::get_if<RecipeRemove>(&step)) {
      const auto remove = removeOptionsOf(removing->what, grid);
      if (!remove) return tl::unexpected(remove.error());
      steps.emplace_back(plannedRemove(field, *remove));
    } else if (const auto* moving = std::get_if<RecipeTransform>(&step)) {
      const auto made = transformedGrid(grid, moving->what);
      if (!made && !options.estimate) return Foreseen{};
      if (!made) return tl::unexpected(made.error());
      // Twice, of what changes are limited from as well.
      steps.emplace_back(plannedTransform(field, original, moving->what, grid, WithOriginal::kYes));
      grid = *made;
    }
    if (auto* pieces = steps.empty() ? nullptr : std::get_if<PlannedOnPieces>(&steps.back());
        pieces != nullptr && !std::holds_alternative<RecipeTransform>(step))
      pieces->share = share();
  }
  engine::ExportOptions writing = options.writing;
  writing.original = original;
  const PlannedWork planned{
      .field = field,
      .original = original,
      .steps = std::move(steps),
      .out = task.out,
      .extension = isStream(task.out) ? withDot(task.to) : engine::extensionOf(task.out),
      .writing = writing,
      .kept = options.resume.resume,
      .result = share()};
  return foresee(planned, shownOutput(task.out), options.estimate, job);
}

engine::Result<Report> applyToOne(const ApplyArguments& options, const Recipe& recipe, const BatchTask& task,
                                  engine::JobControl& job) {
  auto imported = loadScan(task.in, options.reading, job);
  if (!imported) return tl::unexpected(imported.error());
  const engine::Version original = imported->original ? *imported->original : imported->field;
  const FinishedScans finished(options.resume.resume && options.files.many() && !options.estimate);
  std::string identity;
  if (options.resume.resume) {
    engine::FilterSpec any;
    any.max_change = 0.0;  // a step may refer to the original
    identity = engine::identityOf(imported->field, original, any, "").text() + recipeText(recipe) +
               writingIdentity(original.grid(), options.writing);
  }
  if (auto report = finished.earlier(task.out, identity)) return *std::move(report);
  engine::Result<Foreseen> foreseen;
  if (memoryPlace(task.out) == nullptr)
    foreseen = foreseeSteps(options, recipe, task, imported->field, original, job);
  if (!foreseen) return tl::unexpected(foreseen.error());
  if (foreseen->only) return *std::move(foreseen->only);
  const engine::Stopwatch watch;
  Applied at{imported->field, original, task, *imported, options};
  engine::ExportOptions writing = options.writing;
  auto known = KnownSteps::of(*imported, task, job);
  if (!known) return tl::unexpected(known.error());
  for (std::size_t k = 0; k < recipe.steps.size(); ++k) {
    // What a session begins with is levelled and transformed, too, and under the same form.
    if (const auto* level = std::get_if<RecipeLevel>(&recipe.steps[k]))
      known->levelledBoth(*level);
    else if (std::holds_alternative<RecipeForm>(recipe.steps[k]) ||
             std::holds_alternative<RecipeTransform>(recipe.steps[k]))
      known->didToBoth(recipe.steps[k]);
    else
      known->did(recipe.steps[k]);
    if (auto done = std::visit([&](const auto& step) { return take(step, at, job); }, recipe.steps[k]);
        !done) {
      engine::Error error = done.error();
      if (error.kind != engine::ErrorKind::kCancelled)
        error.what = fmt::format("step {} of the recipe: {}", k + 1, error.what);
      return tl::unexpected(std::move(error));
    }
    if (auto seen = seeAsStored(at, job); !seen) return tl::unexpected(seen.error());
  }
  const double seconds = watch.seconds();
  writing.original = at.original;
  known->note(writing);
  if (auto status = saveField(at.field, task.out, job, writing, task.to); !status)
    return tl::unexpected(status.error());
  std::error_code ignored;
  if (options.resume.resume)
    for (std::size_t k = 1; k <= recipe.steps.size(); ++k)
      std::filesystem::remove(keptWorkOf(keptOutOf(task.out, k)), ignored);
  Report report{{"steps", at.steps}, {"seconds", seconds}, {"hash", hashOf(at.field)}};
  finished.add(task.out, identity, report);
  return report;
}

engine::Result<Report> apply(const ApplyArguments& options, engine::JobControl& job) {
  if (isStream(options.recipe) &&
      std::any_of(options.files.files.begin(), options.files.files.end() - 1, isStream))
    return engine::inputError("recipe and scan cannot both be standard input", "-", "name one of them");
  const auto recipe = readRecipe(options.recipe, job);
  if (!recipe) return tl::unexpected(recipe.error());
  const auto tasks = batchTasks(options.files, {isStream(options.recipe) ? "" : options.recipe}, job);
  if (!tasks) return tl::unexpected(tasks.error());
  if (auto status = checkCompress(options.writing, *tasks); !status) return tl::unexpected(status.error());
  if (auto status = checkResume(options.resume, keptTasks(*recipe, *tasks)); !status)
    return tl::unexpected(status.error());
  const auto one = [&](const BatchTask& task, engine::JobControl& j) {
    auto done = applyToOne(options, *recipe, task, j);
    if (done || options.estimate) return done;
    engine::Error error = done.error();
    for (std::size_t k = 1; k <= recipe->steps.size(); ++k)
      error = stillKept(std::move(error), options.resume, keptOutOf(task.out, k));
    return engine::Result<Report>(tl::unexpected(std::move(error)));
  };
  if (options.files.many()) {
    auto report = runBatch(*tasks, job, one);
    if (report && !options.estimate) FinishedScans(options.resume.resume).end(*tasks, *report);
    return report;
  }
  const ProgressLine progress(job);
  return one(tasks->front(), job);
}

}  // namespace

void addApply(Command root, Chosen& chosen) {
  auto options = std::make_shared<ApplyArguments>();
  Command command = addCommand(
      root, chosen, "apply", "Do the steps of a recipe to scans",
      [options](engine::JobControl& job) { return apply(*options, job); }, printBatch, Progress::kOwn,
      batchStatus);
  command.add({{.name = "RECIPE",
                .to = &options->recipe,
                .text = "The recipe, as fettle recipe prints it, TOML",
                .kind = ValueKind::kInput,
                .required = true}});
  addBatchOptions(command, options->files);
  command.add({{.name = "--threads",
                .to = &options->threads,
                .text = "Threads to use",
                .range = Range{0.0, engine::FilterSpec::kMaxThreads},
                .otherwise = "0, one per core"}});
  addEstimateOption(command, options->estimate);
  addResumeOptions(command, options->resume);
  addCompressOption(command, options->writing);
  addScanOptions(command, options->reading);
  command.notes(
      "With --resume each filter of the recipe keeps its work in a file of its own, OUT.stepN.resume. "
      "The page File formats describes the keys of a recipe. A filter without range_sigma takes that of each "
      "scan's own "
      "noise.");
  command.examples({{"fettle apply clean.toml scan.tif clean.tif", "One scan"},
                    {"fettle apply clean.toml scan.tif other.tif --out-dir cleaned",
                     "The same steps for two scans, into a folder"}});
}

}  // namespace fettle::app
