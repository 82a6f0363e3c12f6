#include "app/commands/bench.h"

#include <map>
#include <memory>
#include <string>

#include <fmt/format.h>

#include "bench/filters_bench.h"
#include "render/compute/tgv_compute.h"

namespace fettle::app {

namespace {

engine::Result<Report> measure(bench::FiltersBenchOptions options, bool on_device, engine::JobControl& job) {
  std::unique_ptr<engine::TgvDevice> device;
  if (on_device) {
    auto made = render::TgvCompute::create({});
    if (!made) return tl::unexpected(made.error());
    device = *std::move(made);
    options.device = device.get();
  }
  const auto measured = bench::benchFilters(options, job);
  if (!measured) return tl::unexpected(measured.error());
  Report report{{"machine", measured->machine},
                {"device", measured->device.empty() ? Report() : Report(measured->device)},
                {"side", options.side},
                {"repeats", options.repeats},
                {"rows", Report::array()}};
  for (const bench::FiltersBenchRow& row : measured->rows) {
    const bench::FilterTarget target = bench::targetOf(row);
    report["rows"].push_back({{"kind", engine::name(row.kind)},
                              {"window", row.window},
                              {"ground", bench::groundName(row.ground)},
                              {"threads", row.threads},
                              {"compute", row.on_device ? "gpu" : "cpu"},
                              {"side", row.side},
                              {"samples_per_second", row.median},
                              {"slowest", row.slowest},
                              {"fastest", row.fastest},
                              {"copy_samples_per_second", row.copy},
                              {"share_of_copy", row.median / row.copy},
                              {"samples_per_cpu_second", row.cpu},
                              {"share_of_copy_cpu", row.cpu / row.copy_cpu},
                              {"over_one_thread", row.over_one},
                              {"over_cpu", row.on_device ? Report(row.over_processor) : Report()},
                              {"off_cpu_range_sigmas", row.on_device ? Report(row.most_off) : Report()},
                              {"share_target", target.share},
                              {"over_one_thread_target", target.over_one},
                              {"hash", fmt::format("{:016x}", row.hash)}});
  }
  return report;
}

// "value target", with a star where the target is met; empty where the row has no such value.
std::string valueAndTarget(double value, double target, int digits) {
  if (value == 0.0) return {};
  if (target == 0.0) return fmt::format("{:.{}f}{:>8}", value, digits, "");
  return fmt::format("{:.{}f} {:>6}{}", value, digits, fmt::format("{:g}", target),
                     value >= target ? '*' : ' ');
}

void printBenchFilters(const Report& report) {
  fmt::print(
      "{}\nwhole filter with its report, million samples/s, median of {} runs; share: of plain copying of "
      "floats by as many threads, in the same run, and its target; x one: of the rate with one thread, and "
      "its target; *: met; CPU: per second of processor time\n\n",
      report["machine"].get<std::string>(), report["repeats"].get<int>());
  fmt::print("{:<12}{:>7}{:>8}{:>9}{:>7}{:>10}{:>10}{:>10}{:>8}{:>16}{:>16}{:>10}{:>10}  hash\n", "",
             "window", "ground", "threads", "side", "Ms/s", "slowest", "fastest", "copy", "share target ",
             "x one target ", "CPU Ms/s", "CPU share");
  for (const Report& row : report["rows"]) {
    const auto number = [&row](const char* key) { return row[key].get<double>(); };
    const bool several = row["threads"].get<int>() > 1;
    fmt::print(
        "{:<12}{:>7}{:>8}{:>9}{:>7}{:>10.2f}{:>10.2f}{:>10.2f}{:>8.0f}{:>16}{:>16}{:>10.1f}{:>10.4f}  {}\n",
        row["kind"].get<std::string>(), row["window"].get<int>(), row["ground"].get<std::string>(),
        row["threads"].get<int>(), row["side"].get<int>(), number("samples_per_second") * 1e-6,
        number("slowest") * 1e-6, number("fastest") * 1e-6, number("copy_samples_per_second") * 1e-6,
        valueAndTarget(number("share_of_copy"), number("share_target"), 4),
        valueAndTarget(several ? number("over_one_thread") : 0.0, number("over_one_thread_target"), 2),
        number("samples_per_cpu_second") * 1e-6, number("share_of_copy_cpu"), row["hash"].get<std::string>());
    if (!row["over_cpu"].is_null())
      fmt::print("{:<12}on {}: {:.2f} of the rate above, at most {:.2g} of the noise off its result\n", "",
                 report["device"].get<std::string>(), number("over_cpu"), number("off_cpu_range_sigmas"));
  }
}

}  // namespace

void addBenchFilters(Command bench, Chosen& chosen) {
  auto options = std::make_shared<bench::FiltersBenchOptions>();
  auto on_device = std::make_shared<bool>(false);
  Command command = addCommand(
      bench, chosen, "filters",
      "Samples per second of the global filters, and of plain copying in the same run",
      [options, on_device](engine::JobControl& job) { return measure(*options, *on_device, job); },
      printBenchFilters);
  std::map<std::string, engine::FilterKind> kinds;
  for (const engine::Filter& filter : engine::filters()) kinds[std::string(filter.word)] = filter.kind;
  std::map<std::string, bench::FilterGround> grounds;
  for (const bench::FilterGround ground : options->grounds) grounds[bench::groundName(ground)] = ground;
  command.option("--side", options->side, "Samples along each side of the field").showDefault();
  command.choices("--kind", kinds, options->kinds, "Filters; none: those that do not keep edges")
      .delimiter(',');
  command.option("--window", options->windows, "Sides of the window, samples").delimiter(',').showDefault();
  command.choices("--ground", grounds, options->grounds, "plain, holes, marks; none: all").delimiter(',');
  command.option("--threads", options->threads, "Threads").delimiter(',').showDefault();
  command.flag("--gpu", *on_device,
               fmt::format("Measure {} on a graphics device as well, against the processor in the same run",
                           engine::filterWords(engine::runsOnDevices)));
  command.option("--repeats", options->repeats, "Runs of each row").showDefault();
  command
      .option("--limit", options->limit_s, "Seconds for all runs of a row; a slower one gets a smaller field")
      .showDefault();
}

}  // namespace fettle::app
