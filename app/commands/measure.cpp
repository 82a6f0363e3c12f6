#include <cmath>

#include <memory>

#include <fmt/format.h>

#include "app/commands/batch.h"
#include "app/commands/command.h"
#include "app/commands/form_option.h"
#include "app/commands/output_checks.h"
#include "app/commands/scan_files.h"
#include "app/commands/scan_options.h"
#include "app/terminal.h"
#include "engine/measure/areal.h"

namespace fettle::app {

namespace {

struct MeasureArguments {
  std::vector<std::string> scans;
  FormArguments form;
  ScanOptions reading;
};

// One parameter: its key, the name of the standard, what its number is, and how it is taken.
struct Row {
  const char* key;
  const char* name;
  enum class Kind : std::uint8_t { kHeight, kVolume, kRatio, kPlain } kind;
  const char* text;
  double (*of)(const engine::ArealParameters&);
};
using Areal = engine::ArealParameters;
constexpr Row kRows[] = {
    {"sq", "Sq", Row::Kind::kHeight, "root mean square height", [](const Areal& p) { return p.sq; }},
    {"ssk", "Ssk", Row::Kind::kPlain, "skewness", [](const Areal& p) { return p.ssk; }},
    {"sku", "Sku", Row::Kind::kPlain, "kurtosis", [](const Areal& p) { return p.sku; }},
    {"sp", "Sp", Row::Kind::kHeight, "maximum peak height", [](const Areal& p) { return p.sp; }},
    {"sv", "Sv", Row::Kind::kHeight, "maximum pit depth", [](const Areal& p) { return p.sv; }},
    {"sz", "Sz", Row::Kind::kHeight, "maximum height", [](const Areal& p) { return p.sz; }},
    {"sa", "Sa", Row::Kind::kHeight, "arithmetical mean height", [](const Areal& p) { return p.sa; }},
    {"sdq", "Sdq", Row::Kind::kPlain, "root mean square gradient", [](const Areal& p) { return p.sdq; }},
    {"sdr", "Sdr", Row::Kind::kRatio, "developed interfacial area ratio",
     [](const Areal& p) { return p.sdr; }},
    {"sk", "Sk", Row::Kind::kHeight, "core height", [](const Areal& p) { return p.ratio.sk; }},
    {"spk", "Spk", Row::Kind::kHeight, "reduced peak height", [](const Areal& p) { return p.ratio.spk; }},
    {"svk", "Svk", Row::Kind::kHeight, "reduced dale height", [](const Areal& p) { return p.ratio.svk; }},
    {"smrk1", "Smrk1", Row::Kind::kRatio, "material ratio of the peaks",
     [](const Areal& p) { return p.ratio.smrk1; }},
    {"smrk2", "Smrk2", Row::Kind::kRatio, "material ratio above the dales",
     [](const Areal& p) { return p.ratio.smrk2; }},
    {"vmp", "Vmp", Row::Kind::kVolume, "material volume of the peaks (10 %)",
     [](const Areal& p) { return p.ratio.vmp; }},
    {"vmc", "Vmc", Row::Kind::kVolume, "material volume of the core (10 to 80 %)",
     [](const Areal& p) { return p.ratio.vmc; }},
    {"vvc", "Vvc", Row::Kind::kVolume, "void volume of the core (10 to 80 %)",
     [](const Areal& p) { return p.ratio.vvc; }},
    {"vvv", "Vvv", Row::Kind::kVolume, "void volume of the dales (80 %)",
     [](const Areal& p) { return p.ratio.vvv; }},
    {"sxp", "Sxp", Row::Kind::kHeight, "peak extreme height (2.5 to 50 %)",
     [](const Areal& p) { return p.ratio.sxp; }},
};

Report figureOrNull(double value) {
  return std::isnan(value) ? Report() : Report(value);
}

engine::Result<Report> measureOne(const MeasureArguments& options, const std::string& scan,
                                  engine::JobControl& job) {
  const auto imported = loadScan(scan, options.reading, job);
  if (!imported) return tl::unexpected(imported.error());
  const auto marked = withMarks(imported->field, options.form.marks, job);
  if (!marked) return tl::unexpected(marked.error());
  const auto fit = formOf(*marked, scan, *imported, options.form, job);
  if (!fit) return tl::unexpected(fit.error());
  const auto measured = engine::measureAreal(*marked, fit->form, formOptionsOf(options.form).region, job);
  if (!measured) return tl::unexpected(measured.error());
  Report report;
  addForm(report, options.form, *fit, imported->field.grid());
  report.update({{"unit", imported->field.grid().height_unit.name},
                 {"unit_mm", imported->field.grid().height_unit.mm},
                 {"samples", measured->samples},
                 {"cells", measured->cells},
                 {"mean", measured->mean}});
  for (const Row& row : kRows) report[row.key] = figureOrNull(row.of(*measured));
  return report;
}

engine::Result<Report> measure(const MeasureArguments& options, engine::JobControl& job) {
  if (auto status = checkForm(options.form); !status) return tl::unexpected(status.error());
  // Two inputs cannot both be standard input.
  std::vector<std::string> inputs = options.scans;
  inputs.push_back(options.form.marks);
  if (auto status = checkOutputs({}, inputs, Replacing::kNoWork, job); !status)
    return tl::unexpected(status.error());
  if (options.scans.size() == 1) {
    const ProgressLine progress(job);
    return measureOne(options, options.scans.front(), job);
  }
  std::vector<BatchTask> tasks;
  tasks.reserve(options.scans.size());
  for (const std::string& scan : options.scans) tasks.push_back({scan, {}, {}});
  return runBatch(tasks, job, [&](const BatchTask& task, engine::JobControl& j) {
    return measureOne(options, task.in, j);
  });
}

// The unit in which a height is read at ease, one of the metric ones: 0.0000113 mm are 11.3 nm.
struct ReadUnit {
  const char* name;
  double mm;
};
ReadUnit readUnit(double height_mm) {
  constexpr ReadUnit kUnits[] = {{"m", 1e3}, {"mm", 1.0}, {"um", 1e-3}};
  for (const ReadUnit& unit : kUnits)
    if (height_mm >= unit.mm) return unit;
  return {"nm", 1e-6};
}

void printOneMeasured(const Report& report) {
  // Of the root mean square height: one unit for all rows.
  const double unit_mm = report["unit_mm"];
  const ReadUnit unit = readUnit(report["sq"].get<double>() * unit_mm);
  const auto samples = report["samples"].get<std::int64_t>();
  fmt::print("{} sample{}, form {}{}\n", samples, samples == 1 ? "" : "s", report["form"].get<std::string>(),
             report["robust"].get<bool>() ? ", robust" : "");
  if (report.contains("tilt_x"))
    fmt::print("tilt {:.4g} degrees along x, {:.4g} along y\n", report["tilt_x"].get<double>(),
               report["tilt_y"].get<double>());
  for (const Row& row : kRows) {
    const Report& value = report[row.key];
    const bool ratio = row.kind == Row::Kind::kRatio, plain = row.kind == Row::Kind::kPlain;
    const double factor = ratio ? 100.0 : plain ? 1.0 : unit_mm / unit.mm;
    const std::string shown = value.is_null() ? "-" : fmt::format("{:.5g}", value.get<double>() * factor);
    const std::string of = ratio                            ? "%"
                           : row.kind == Row::Kind::kHeight ? unit.name
                           : row.kind == Row::Kind::kVolume ? fmt::format("{0}3/{0}2", unit.name)
                                                            : "";
    fmt::print("{:<6} {:>12} {:<8} {}\n", row.name, shown, of, row.text);
  }
}

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

}  // namespace

void addMeasure(Command root, Chosen& chosen) {
  auto options = std::make_shared<MeasureArguments>();
  Command command = addCommand(
      root, chosen, "measure", "Surface texture parameters of ISO 25178-2, about a form",
      [options](engine::JobControl& job) { return measure(*options, job); }, printMeasured, Progress::kOwn,
      batchStatus);
  command.add({{.name = "SCAN",
                .to = &options->scans,
                .text = "The scan, or several, each with a report of its own; - for standard input",
                .kind = ValueKind::kInput,
                .required = true}});
  addFormOptions(command, options->form);
  addScanOptions(command, options->reading);
  command.notes(
      "No S- or L-filter is applied: filter the scan before. Ratios are shares of 1 in a report, per cent in "
      "text. Between samples "
      "the surface is "
      "the bilinear patch.");
  command.examples({{"fettle measure scan.tif", "All parameters about the least-squares plane"},
                    {"fettle measure scan.tif --form poly2 --robust",
                     "About a slightly bent surface, as if steps and spikes were not there"}});
}

}  // namespace fettle::app
