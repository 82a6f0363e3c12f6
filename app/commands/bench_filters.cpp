#include "app/commands/bench_filters.h"

#include <map>
#include <memory>

#include <fmt/format.h>

#include "bench/filters_bench.h"

namespace fettle::app {

namespace {

engine::Result<Report> measure(const bench::FiltersBenchOptions& options, engine::JobControl& job) {
  const auto measured = bench::benchFilters(options, job);
  if (!measured) return tl::unexpected(measured.error());
  Report report{{"machine", measured->machine},
                {"side", options.side},
                {"repeats", options.repeats},
                {"rows", Report::array()}};
  for (const bench::FiltersBenchRow& row : measured->rows)
    report["rows"].push_back({{"kind", engine::name(row.kind)},
                              {"window", row.window},
                              {"ground", bench::groundName(row.ground)},
                              {"threads", row.threads},
                              {"side", row.side},
                              {"samples_per_second", row.median},
                              {"slowest", row.slowest},
                              {"fastest", row.fastest},
                              {"copy_samples_per_second", row.copy},
                              {"share_of_copy", row.median / row.copy},
                              {"samples_per_cpu_second", row.cpu},
                              {"share_of_copy_cpu", row.cpu / row.copy_cpu},
                              {"hash", fmt::format("{:016x}", row.hash)}});
  return report;
}

void print(const Report& report) {
  fmt::print(
      "{}\nwhole filter with its report, million samples/s, median of {} runs; copy: plain copying of floats "
      "by "
      "as many threads, in the same run; CPU: per second of processor time\n\n",
      report["machine"].get<std::string>(), report["repeats"].get<int>());
  fmt::print("{:<12}{:>7}{:>8}{:>9}{:>7}{:>10}{:>10}{:>10}{:>8}{:>8}{:>10}{:>10}  hash\n", "", "window",
             "ground", "threads", "side", "Ms/s", "slowest", "fastest", "copy", "share", "CPU Ms/s",
             "CPU share");
  for (const Report& row : report["rows"])
    fmt::print(
        "{:<12}{:>7}{:>8}{:>9}{:>7}{:>10.1f}{:>10.1f}{:>10.1f}{:>8.0f}{:>8.4f}{:>10.1f}{:>10.4f}  {}\n",
        row["kind"].get<std::string>(), row["window"].get<int>(), row["ground"].get<std::string>(),
        row["threads"].get<int>(), row["side"].get<int>(), row["samples_per_second"].get<double>() * 1e-6,
        row["slowest"].get<double>() * 1e-6, row["fastest"].get<double>() * 1e-6,
        row["copy_samples_per_second"].get<double>() * 1e-6, row["share_of_copy"].get<double>(),
        row["samples_per_cpu_second"].get<double>() * 1e-6, row["share_of_copy_cpu"].get<double>(),
        row["hash"].get<std::string>());
}

}  // namespace

void addBenchFilters(CLI::App& bench, Chosen& chosen) {
  auto options = std::make_shared<bench::FiltersBenchOptions>();
  CLI::App* command = addCommand(
      bench, chosen, "filters",
      "Samples a second of the global filters, beside plain copying in the same run",
      [options](engine::JobControl& job) { return measure(*options, job); }, print);
  std::map<std::string, engine::FilterKind> kinds;
  for (const engine::FilterKind kind : options->kinds) kinds[std::string(engine::name(kind))] = kind;
  std::map<std::string, bench::FilterGround> grounds;
  for (const bench::FilterGround ground : options->grounds) grounds[bench::groundName(ground)] = ground;
  command->add_option("--side", options->side, "Samples along each side of the field")->capture_default_str();
  command->add_option("--kind", options->kinds, "Filters; none: all")
      ->delimiter(',')
      ->transform(CLI::CheckedTransformer(kinds));
  command->add_option("--window", options->windows, "Sides of the window, samples")
      ->delimiter(',')
      ->capture_default_str();
  command->add_option("--ground", options->grounds, "plain, holes, marks; none: all")
      ->delimiter(',')
      ->transform(CLI::CheckedTransformer(grounds));
  command->add_option("--threads", options->threads, "Threads")->delimiter(',')->capture_default_str();
  command->add_option("--repeats", options->repeats, "Runs of each row")->capture_default_str();
  command
      ->add_option("--limit", options->limit_s,
                   "Seconds for all runs of a row; a slower one gets a smaller field")
      ->capture_default_str();
}

}  // namespace fettle::app
