#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "app/commands/areal_option.h"
#include "app/commands/batch.h"
#include "app/commands/command.h"
#include "app/commands/estimate_option.h"
#include "app/commands/form_option.h"
#include "app/commands/list_text.h"
#include "app/commands/measuring.h"
#include "app/commands/noise_option.h"
#include "app/commands/output_checks.h"
#include "app/commands/rounding_warning.h"
#include "app/commands/scale_option.h"
#include "app/commands/scan_files.h"
#include "app/commands/scan_options.h"
#include "app/commands/shards/list_shard.h"
#include "app/commands/shards/shard_option.h"
#include "app/commands/surface_curves.h"
#include "app/commands/typed_values.h"
#include "app/terminal.h"
#include "app/work/areal_table.h"
#include "app/work/layer_over.h"
#include "app/work/section_report.h"
#include "app/work/streams.h"
#include "app/work/through_noise.h"
#include "engine/fill/filled_samples.h"
#include "engine/io/files/atomic_file.h"
#include "engine/measure/areal.h"
#include "engine/measure/height_rounding.h"

namespace fettle::app {

namespace {

struct MeasureArguments {
  std::vector<std::string> scans;
  FormArguments form;
  ScaleArguments scale;
  std::vector<std::string> groups;  // empty: all
  std::vector<std::string> at_heights;
  std::vector<double> at_ratios;
  ArealArguments areal;
  std::string csv, surface;
  CurveFiles curves;
  int noise_trials = kUsualTrials;
  bool estimate = false;
  std::string shard, shard_folder;
  ScanOptions reading;
};

const std::vector<double> kUsualRatios = {10.0, 80.0};  // [%]

std::vector<Word> groupWords() {
  std::vector<Word> words;
  for (const ArealGroup& group : arealGroups()) words.emplace_back(group.word, group.text);
  return words;
}

// Heights are signed here: Smr at a height below the mean.
engine::Result<std::vector<double>> heightsOf(const std::vector<std::string>& typed,
                                              const engine::Grid& grid) {
  std::vector<double> heights;
  for (const std::string& text : typed) {
    const auto height = parseSignedHeight(text, grid, "--at-height");
    if (!height)
      return engine::inputError(height.error().what, "--at-height",
                                "give numbers about the mean, below it with -, such as 0,-0.5um");
    heights.push_back(*height);
  }
  return heights;
}

engine::Result<engine::ArealOptions> arealOptionsOf(const MeasureArguments& options,
                                                    const engine::Grid& grid) {
  engine::ArealOptions areal;
  areal.region = formChoiceOf(options.form).region;
  const auto wants = [&](const char* group) {
    return options.groups.empty() || std::ranges::find(options.groups, group) != options.groups.end();
  };
  areal.hybrid = wants("hybrid");
  areal.functional = wants("functional");
  areal.spatial = wants("spatial");
  areal.feature = wants("feature");
  const auto heights = heightsOf(options.at_heights, grid);
  if (!heights) return tl::unexpected(heights.error());
  areal.at_heights = *heights;
  const std::vector<double>& ratios = options.at_ratios.empty() ? kUsualRatios : options.at_ratios;
  for (const double ratio : ratios) areal.at_ratios.push_back(ratio / 100.0);
  areal.at_volumes = areal.at_ratios;
  choose(choiceOf(options.areal), areal);
  return areal;
}

engine::Status writeSurface(const MeasureArguments& options, const ScaleLimited& limited,
                            const engine::Version& scan, engine::JobControl& job) {
  if (options.surface.empty()) return {};
  const auto surface = surfaceField(limited, regionOf(options.form.region), scan, job);
  if (!surface) return tl::unexpected(surface.error());
  return saveField(*surface, options.surface, job);
}

engine::Result<Report> measureOne(const MeasureArguments& options, const std::string& scan,
                                  engine::JobControl& job) {
  const auto imported = loadScan(scan, options.reading, job);
  if (!imported) return tl::unexpected(imported.error());
  const auto marked = countedOf(imported->field, imported->original, scan, options.form, job);
  if (!marked) return tl::unexpected(marked.error());
  const engine::Grid& grid = imported->field.grid();
  const auto areal = arealOptionsOf(options, grid);
  if (!areal) return tl::unexpected(areal.error());
  engine::ArealOptions wanted = *areal;
  addCurves(options.curves, wanted);  // their heights are the last ones
  const PlannedWork planned{.field = *marked,
                            .original = *marked,
                            .steps = {plannedMeasuring({*marked, scan, *imported, options.form, options.scale,
                                                        wanted, options.noise_trials})},
                            .out = {},
                            .extension = {},
                            .writing = {}};
  auto foreseen = foresee(planned, shownInput(scan), options.estimate, job);
  if (!foreseen) return tl::unexpected(foreseen.error());
  if (foreseen->only) return *std::move(foreseen->only);
  const auto limited = scaleLimited(*marked, scan, *imported, options.form, options.scale, job);
  if (!limited) return tl::unexpected(limited.error());
  wanted.fitted = limited->fit.numbers;
  const auto measured = engine::measureAreal(limited->field, limited->form, wanted, job);
  if (!measured) return tl::unexpected(measured.error());
  if (auto status = writeCurves(options.curves, *measured, grid, job); !status)
    return tl::unexpected(status.error());
  if (auto status = writeSurface(options, *limited, imported->field, job); !status)
    return tl::unexpected(status.error());
  Report report;
  engine::FittedForm fit = limited->fit;
  if (auto status = addThroughNoise(fit, *marked, formChoiceOf(options.form), job); !status)
    return tl::unexpected(status.error());
  addForm(report, options.form, fit, grid);
  addLayer(report, imported->field);
  if (imported->original) report["filled"] = engine::countFilled(*marked, *imported->original);
  addScale(report, options.scale);
  if (!options.surface.empty()) report["surface"] = options.surface;
  addAreal(report, *measured, options.groups, grid);
  if (areal->functional) {
    report["smr"] = Report::array();
    for (std::size_t i = 0; i < areal->at_heights.size(); ++i)
      report["smr"].push_back(
          {{"height", areal->at_heights[i]}, {"ratio", numberOrNull(measured->ratios[i])}});
    report["smc"] = Report::array();
    for (std::size_t i = 0; i < areal->at_ratios.size(); ++i)
      report["smc"].push_back({{"ratio", areal->at_ratios[i]},
                               {"height", numberOrNull(measured->heights[i])},
                               {"material_volume", numberOrNull(measured->material[i])},
                               {"void_volume", numberOrNull(measured->voids[i])}});
  }
  addChosen(report, choiceOf(options.areal), *measured);
  if (!areal->functional) report.erase("volume_ratios");
  if (!areal->feature) report.erase("prune");
  // Of a smoothed surface the scan's rounding says nothing.
  if (options.scale.s_filter.empty())
    warnOfRounding(engine::roundingDoubt(*marked, *measured), shownInput(scan));
  // Trials measure what is stated, not the curves.
  engine::ArealParameters stated = *measured;
  stated.heights.resize(areal->at_ratios.size());
  const auto noise =
      noiseOfMeasured({*marked, scan, *imported, options.form, options.scale, *areal, options.noise_trials},
                      *limited, stated, job);
  if (!noise) return tl::unexpected(noise.error());
  if (*noise) addNoise(report, (*noise)->noise, grid);
  if (*noise && (*noise)->samples > 0) report["noise"]["part"] = (*noise)->samples;
  return report;
}

engine::Status writeCsv(const MeasureArguments& options, const Report& report, engine::JobControl& job) {
  if (options.csv.empty()) return {};
  std::string text = kArealHeading;
  if (report.contains("files")) {
    for (const Report& file : report["files"])
      if (!file.contains("error")) text += arealRows(file["in"].get<std::string>(), file);
  } else {
    text += arealRows(options.scans.front(), report);
  }
  return writeTo(options.csv, ".csv", job,
                 [&](const std::string& file) { return engine::writeFileAtomically(file, text); });
}

engine::Result<Report> measureAll(const MeasureArguments& options, const std::vector<std::string>& arguments,
                                  engine::JobControl& job) {
  if (options.scans.size() == 1 && options.shard.empty()) {
    const ProgressLine progress(job);
    return measureOne(options, options.scans.front(), job);
  }
  std::vector<BatchTask> tasks;
  tasks.reserve(options.scans.size());
  for (const std::string& scan : options.scans) tasks.push_back({scan, {}, {}});
  const auto mine = ListShard::begin(tasks, options.shard,
                                     options.estimate ? std::string() : options.shard_folder, arguments);
  if (!mine) return tl::unexpected(mine.error());
  auto report = runBatch(mine->tasks(), job, [&](const BatchTask& task, engine::JobControl& j) {
    return measureOne(options, task.in, j);
  });
  if (report)
    if (auto status = mine->keep(*report); !status) return tl::unexpected(status.error());
  return report;
}

engine::Result<Report> measure(const MeasureArguments& options, const std::vector<std::string>& arguments,
                               engine::JobControl& job) {
  if (auto status = checkForm(options.form); !status) return tl::unexpected(status.error());
  if (auto status = checkNoiseTrials(options.noise_trials); !status) return tl::unexpected(status.error());
  const bool functional =
      options.groups.empty() || std::ranges::find(options.groups, "functional") != options.groups.end();
  for (const auto& [given, option] : {std::pair(!options.at_heights.empty(), "--at-height"),
                                      {!options.at_ratios.empty(), "--at-ratio"},
                                      {!options.areal.volumes.empty(), "--ratios"},
                                      {!options.areal.difference.empty(), "--height-between"}})
    if (given && !functional)
      return engine::inputError("no material ratios are measured without the functional parameters", option,
                                "add functional to --only");
  if (auto status = checkAreal(options.areal); !status) return tl::unexpected(status.error());
  if (auto status = checkListShard(options.shard, options.shard_folder); !status)
    return tl::unexpected(status.error());
  // Two inputs cannot both be standard input.
  std::vector<std::string> inputs = options.scans;
  inputs.push_back(options.form.marks);
  if (auto status = checkCurves(options.curves, options.scans.size()); !status)
    return tl::unexpected(status.error());
  if (!options.surface.empty() && options.scans.size() > 1)
    return engine::inputError("a surface is written of one scan", "--surface",
                              "leave it out, or measure one after another");
  std::vector<Output> outputs = outputsOf(options.curves);
  outputs.push_back({options.surface, OutputKind::kField});
  outputs.push_back({options.csv, OutputKind::kText, ".csv"});
  if (auto status = checkOutputs(outputs, inputs, Replacing::kNoWork, job); !status)
    return tl::unexpected(status.error());
  auto report = measureAll(options, arguments, job);
  if (!report) return report;
  if (options.estimate) return report;
  if (auto status = writeCsv(options, *report, job); !status) return tl::unexpected(status.error());
  return report;
}

void printOneMeasured(const Report& report) {
  if (report.contains("text")) return printReport(report);
  const auto samples = report["samples"].get<std::int64_t>();
  const auto filled = report.value("filled", std::int64_t{0});
  fmt::print("{} sample{}{}, form {}{}\n", samples, samples == 1 ? "" : "s",
             filled > 0 ? fmt::format(", {} of the scan filled and not measured", filled) : "",
             report["form"].get<std::string>(), report["robust"].get<bool>() ? ", robust" : "");
  printLayer(report);
  if (report.contains("tilt_x"))
    fmt::print("tilt {:.4g} degrees along x, {:.4g} along y\n", report["tilt_x"].get<double>(),
               report["tilt_y"].get<double>());
  if (const std::string scale = scaleText(report, "\n"); !scale.empty()) fmt::print("{}\n", scale);
  printAreal(report);
}

}  // namespace

void printMeasured(const Report& report) {
  if (!report.contains("files")) return printOneMeasured(report);
  for (const Report& file : report["files"]) {
    fmt::print("{}{}\n", file["in"].get<std::string>(), file.contains("error") ? "  failed" : "");
    if (!file.contains("error")) printOneMeasured(file);
    fmt::print("\n");
  }
  fmt::print("{} measured, {} failed\n", report["done"].get<std::size_t>(),
             report["failed"].get<std::size_t>());
}

void addMeasure(Command root, Chosen& chosen) {
  auto options = std::make_shared<MeasureArguments>();
  Command command = addCommand(
      root, chosen, "measure", "Surface texture parameters of ISO 25178-2, about a form",
      [options, &chosen](engine::JobControl& job) { return measure(*options, chosen.arguments, job); },
      printMeasured, Progress::kOwn, batchStatus);
  command.add({{.name = "SCAN",
                .to = &options->scans,
                .text = "The scan, or several, each with a report of its own; - for standard input",
                .kind = ValueKind::kInput,
                .required = true},
               {.name = "--only",
                .to = &options->groups,
                .text = "Only these groups, and that of heights: the others need more time and memory",
                .words = groupWords(),
                .shown = "GROUP[,GROUP...]",
                .otherwise = "all groups",
                .between = ','},
               {.name = "--at-height",
                .to = &options->at_heights,
                .text = "Heights about the mean for the material ratio Smr(c), below it with -: 0,-0.5um",
                .shown = "C[,C...]",
                .between = ','},
               {.name = "--at-ratio",
                .to = &options->at_ratios,
                .text = "Material ratios for the height Smc(mr)",
                .range = Range{0.0, 100.0},
                .unit = "%",
                .shown = "MR[,MR...]",
                .otherwise = "10,80",
                .between = ','}});
  addArealOptions(command, options->areal);
  command.add(
      {{.name = "--csv",
        .to = &options->csv,
        .text = "Write a row per scan and parameter, in the scan's units",
        .kind = ValueKind::kOutput},
       {.name = "--surface",
        .to = &options->surface,
        .text = "Write the surface that the parameters are those of: without the form, after --s-filter "
                "(S-F surface) and --l-filter (S-L surface), holes where no sample counts",
        .kind = ValueKind::kNewScan}});
  addNoiseOption(command, options->noise_trials);
  addEstimateOption(command, options->estimate);
  addCurveOptions(command, options->curves);
  addFormOptions(command, options->form);
  addScaleOptions(command, options->scale);
  addListShardOptions(command, options->shard, options->shard_folder);
  addScanOptions(command, options->reading);
  command.notes(
      "No S- or L-filter is applied unless named. At borders and holes their weights are normalised. Ratios "
      "are shares of 1 in a report, per cent in text. Sdq and Sdr are those of the bilinear patch between "
      "four samples, the other figures of the samples. The "
      "autocorrelation reaches to half of the surface. Std is the direction of the lay in degrees from x to "
      "y, from 0 to below 180: 0 and 180 are one direction, so that noise may turn 0.1 into 179.9. "
      "It says little where Str is near 1. Ssw is the length of the strongest wave of the Fourier transform. "
      "Hills and "
      "dales "
      "are all that are --prune, 5 % of Sz, high or deep and more; S5p and S5v are means of the five highest "
      "peaks "
      "and deepest pits about the mean. Sha and Sda are of hills and dales that reach neither border nor "
      "hole; Shv and Sdv lie above the highest saddle, or below the lowest one, of those that do not "
      "reach them there. What the samples do not determine is not stated, with the reason.\n"
      "Noise scatters parameters and raises most of them. Both are found by measuring the scan again with "
      "more "
      "noise like its own: beside each parameter stands what it is without noise, and the standard error of "
      "that. Noise that neighbours share in both directions, as in filtered scans, is not seen and not "
      "counted.");
  command.examples({{"fettle measure scan.tif", "All parameters about the least-squares plane"},
                    {"fettle measure scan.tif other.tif --only spatial --csv texture.csv",
                     "Heights and spatial parameters of several scans, as a table"},
                    {"fettle measure scan.tif --s-filter 2.5 --l-filter 25",
                     "Of the S-L surface: waves between 2.5 and 25 mm"},
                    {"fettle measure scan.tif --s-filter 2.5 --l-filter 25 --surface surface.tif",
                     "The same, and the S-L surface as a scan"},
                    {"fettle measure scan.tif --abbott abbott.svg --spectrum spectrum.svg",
                     "With pictures of the material ratio curve and the power spectrum"},
                    {"fettle measure scan.tif --form poly2 --robust",
                     "About a slightly bent surface, as if steps and spikes were not there"}});
}

}  // namespace fettle::app
