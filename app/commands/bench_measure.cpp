#include "app/commands/bench.h"

#include <cstdint>
#include <memory>
#include <string>

#include <fmt/format.h>

#include "bench/measure_bench.h"

namespace fettle::app {

namespace {

engine::Result<Report> measureSteps(const bench::MeasureBenchOptions& options, engine::JobControl& job) {
  const auto measured = bench::benchMeasure(options, job);
  if (!measured) return tl::unexpected(measured.error());
  Report report{{"machine", measured->machine},
                {"repeats", options.repeats},
                {"samples", measured->samples},
                {"rows", Report::array()}};
  for (const bench::MeasureBenchRow& row : measured->rows)
    report["rows"].push_back({{"step", row.step},
                              {"seconds", row.median},
                              {"fastest", row.fastest},
                              {"slowest", row.slowest},
                              {"plain_seconds", row.plain},
                              {"times_plain", row.median / row.plain},
                              {"hash", fmt::format("{:016x}", row.bits)}});
  return report;
}

void printBenchMeasure(const Report& report) {
  fmt::print(
      "{}\n{} samples; median of {} repeats; plain: one thread copies every sample, in the same run\n\n",
      report["machine"].get<std::string>(), report["samples"].get<std::int64_t>(),
      report["repeats"].get<int>());
  fmt::print("{:<28}{:>9}{:>9}{:>9}{:>9}{:>12}  hash\n", "step", "s", "fastest", "slowest", "plain",
             "times plain");
  for (const Report& row : report["rows"])
    fmt::print("{:<28}{:>9.4f}{:>9.4f}{:>9.4f}{:>9.4f}{:>12.3f}  {}\n", row["step"].get<std::string>(),
               row["seconds"].get<double>(), row["fastest"].get<double>(), row["slowest"].get<double>(),
               row["plain_seconds"].get<double>(), row["times_plain"].get<double>(),
               row["hash"].get<std::string>());
}

}  // namespace

void addBenchMeasure(Command bench, Chosen& chosen) {
  auto options = std::make_shared<bench::MeasureBenchOptions>();
  Command command = addCommand(
      bench, chosen, "measure",
      "Time of levels, sections, parameters, transforms and removed samples, and of copying the field",
      [options](engine::JobControl& job) { return measureSteps(*options, job); }, printBenchMeasure);
  command.add({
      {.name = "--side",
       .to = &options->side,
       .text = "Length of each side of the field",
       .range = Range{512.0, 32768.0},
       .unit = "samples"},
      {.name = "--repeats",
       .to = &options->repeats,
       .text = "Times that each step is run",
       .range = Range{1.0, 100.0}},
  });
}

}  // namespace fettle::app
