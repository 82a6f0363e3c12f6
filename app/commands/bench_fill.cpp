#include "app/commands/bench.h"

#include <cstdint>
#include <memory>
#include <string>

#include <fmt/format.h>

#include "bench/fill_bench.h"

namespace fettle::app {

namespace {

engine::Result<Report> measureFill(const bench::FillBenchOptions& options, engine::JobControl& job) {
  const auto measured = bench::benchFill(options, job);
  if (!measured) return tl::unexpected(measured.error());
  Report report{{"machine", measured->machine},
                {"repeats", options.repeats},
                {"samples", measured->samples},
                {"rows", Report::array()}};
  for (const bench::FillBenchRow& row : measured->rows)
    report["rows"].push_back({{"holes", row.holes},
                              {"method", row.method},
                              {"filled_holes", row.count},
                              {"filled", row.filled},
                              {"seconds", row.median},
                              {"fastest", row.fastest},
                              {"slowest", row.slowest},
                              {"plain_seconds", row.plain},
                              {"times_plain", row.median / row.plain},
                              {"hash", fmt::format("{:016x}", row.hash)}});
  return report;
}

void printBenchFill(const Report& report) {
  fmt::print(
      "{}\n{} samples; median of {} repeats; plain: one thread copies every sample, in the same run\n\n",
      report["machine"].get<std::string>(), report["samples"].get<std::int64_t>(),
      report["repeats"].get<int>());
  fmt::print("{:<12}{:<12}{:>10}{:>12}{:>9}{:>9}{:>9}{:>9}{:>12}  hash\n", "holes", "method", "holes",
             "samples", "s", "fastest", "slowest", "plain", "times plain");
  for (const Report& row : report["rows"])
    fmt::print("{:<12}{:<12}{:>10}{:>12}{:>9.3f}{:>9.3f}{:>9.3f}{:>9.3f}{:>12.2f}  {}\n",
               row["holes"].get<std::string>(), row["method"].get<std::string>(),
               row["filled_holes"].get<std::int64_t>(), row["filled"].get<std::int64_t>(),
               row["seconds"].get<double>(), row["fastest"].get<double>(), row["slowest"].get<double>(),
               row["plain_seconds"].get<double>(), row["times_plain"].get<double>(),
               row["hash"].get<std::string>());
}

}  // namespace

void addBenchFill(Command bench, Chosen& chosen) {
  auto options = std::make_shared<bench::FillBenchOptions>();
  Command command = addCommand(
      bench, chosen, "fill", "Time of filling holes, and of copying the field",
      [options](engine::JobControl& job) { return measureFill(*options, job); }, printBenchFill);
  command.add({
      {.name = "--side",
       .to = &options->side,
       .text = "Length of each side of the field",
       .range = Range{512.0, 32768.0},
       .unit = "samples"},
      {.name = "--repeats",
       .to = &options->repeats,
       .text = "Times that each is filled",
       .range = Range{1.0, 100.0}},
  });
}

}  // namespace fettle::app
