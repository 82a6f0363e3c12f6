#include <memory>

#include <fmt/format.h>

#include "app/commands/command.h"
#include "app/commands/output_checks.h"
#include "app/commands/scan_files.h"
#include "app/commands/typed_values.h"
#include "app/commands/value_checks.h"
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
    if (auto status = saveMarks(scan->edges, options.edges, job); !status)
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
  command.add({{.name = "OUT",
                .to = &options->out,
                .text = "The scan to write, format by extension; - for standard output",
                .kind = ValueKind::kOutput,
                .required = true}});
  addStreamFormat(command, options->to);
  command.add({
      {.name = "--part", .to = &options->spec.part, .text = "The part", .words = partWords()},
      {.name = "--size",
       .to = &options->size,
       .text = fmt::format("Size of the scan, each side {} to {}", kFieldSides.smallest, kFieldSides.largest),
       .kind = ValueKind::kSize,
       .unit = "samples"},
      {.name = "--noise",
       .to = &options->spec.noise,
       .text = "Scale of the scanner's noise; 1 = realistic, 0 = none",
       .range = Range{0.0, 100.0}},
      {.name = "--outliers",
       .to = &options->spec.outliers,
       .text = "Share of samples near edges that are outliers",
       .range = Range{0.0, 1.0}},
      {.name = "--dropouts",
       .to = &options->spec.dropouts,
       .text = "Scale of dropouts by slope and shadow",
       .range = Range{0.0, 10.0}},
      {.name = "--spot",
       .to = &options->spec.spot,
       .text = "Spot of light that a height is the mean of, a standard deviation; 0 = none, 1 = realistic",
       .range = Range{0.0, 4.0},
       .unit = "samples"},
      {.name = "--seed", .to = &options->spec.seed, .text = "Same seed, same bits", .problem = seedProblem},
  });
  addForceOption(command, options->replacing);
  command.add({
      {.name = "--truth",
       .to = &options->truth,
       .text = "Also write the true surface",
       .kind = ValueKind::kNewScan},
      {.name = "--edges",
       .to = &options->edges,
       .text = "Also write the true edges as a picture, non-zero = edge",
       .kind = ValueKind::kNewMarks,
       .problem = streamProblem},
  });
  command.examples({{"fettle synth scan.tif --size 256x256 --truth truth.tif --edges edges.png",
                     "A scan of the bracket with what is true of it"}});
}

}  // namespace fettle::app
