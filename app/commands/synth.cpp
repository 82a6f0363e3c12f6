#include <memory>

#include <fmt/format.h>

#include "app/commands/command.h"
#include "app/commands/output_checks.h"
#include "app/commands/scan_files.h"
#include "app/commands/typed_values.h"
#include "engine/io/raster/marks.h"
#include "engine/scanner/scanner.h"

namespace fettle::app {

namespace {

struct SynthArguments {
  std::string out;
  std::string to;
  std::string size = "1024x1024";
  std::string truth;
  std::string edges;
  engine::ScannerSpec spec;
  Replacing replacing = Replacing::kNoWork;
};

engine::Result<Report> synth(SynthArguments options, engine::JobControl& job) {
  const auto size = parseSize(options.size, "--size", kFieldSides);
  if (!size) return tl::unexpected(size.error());
  options.spec.width = size->first;
  options.spec.height = size->second;
  if (auto status = checkOutputs({{options.out, OutputKind::kField, options.to},
                                  {options.truth, OutputKind::kField},
                                  {options.edges, OutputKind::kMarks}},
                                 {}, options.replacing, job);
      !status)
    return tl::unexpected(status.error());
  const auto scan = engine::simulateScan(options.spec, job);
  if (!scan) return tl::unexpected(scan.error());
  if (auto status = saveField(scan->scan, options.out, job, {}, options.to); !status)
    return tl::unexpected(status.error());
  if (!options.truth.empty())
    if (auto status = saveField(scan->truth, options.truth, job); !status)
      return tl::unexpected(status.error());
  if (!options.edges.empty())
    if (auto status = engine::exportMarks(scan->edges, options.edges); !status)
      return tl::unexpected(status.error());
  const engine::FieldSummary summary = engine::summarize(scan->scan);
  return Report{{"width", options.spec.width}, {"height", options.spec.height}, {"part", options.spec.part},
                {"noise", options.spec.noise}, {"seed", options.spec.seed},     {"sigma_mm", scan->sigma_mm},
                {"no_data", summary.no_data},  {"hash", hashOf(scan->scan)}};
}

}  // namespace

void addSynth(Command root, Chosen& chosen) {
  auto options = std::make_shared<SynthArguments>();
  Command command = addCommand(root, chosen, "synth",
                               "Simulate a laser scan of a machined part, with its truth and its true edges",
                               [options](engine::JobControl& job) { return synth(*options, job); });
  std::string names;
  std::vector<std::string> parts;
  for (const engine::PartInfo& part : engine::parts()) {
    parts.emplace_back(part.name);
    names += fmt::format("\n  {}: {}", part.name, part.description);
  }
  command.option("OUT", options->out, "The scan to write, format by extension; - for standard output")
      .required();
  addStreamFormat(command, options->to);
  command.option("--part", options->spec.part, "The part:" + names).check(oneOf(parts)).showDefault();
  command.option("--size", options->size, "Samples, WIDTHxHEIGHT").showDefault();
  command.option("--noise", options->spec.noise, "Scale of the scanner's noise; 1 = realistic, 0 = none")
      .showDefault();
  command.option("--outliers", options->spec.outliers, "Share of samples near edges that are outliers")
      .showDefault();
  command.option("--dropouts", options->spec.dropouts, "Scale of dropouts by slope and shadow").showDefault();
  command
      .option("--spot", options->spec.spot,
              "Spot of light that a height is the mean of, a standard deviation in samples; 0 = none, 1 = "
              "realistic")
      .showDefault();
  command.option("--seed", options->spec.seed, "Same seed, same bits").check({seedProblem}).showDefault();
  addForceOption(command, options->replacing);
  command.option("--truth", options->truth, "Also write the true surface").check(fileName());
  command.option("--edges", options->edges, "Also write the true edges as a picture, non-zero = edge")
      .check(fileName());
}

}  // namespace fettle::app
