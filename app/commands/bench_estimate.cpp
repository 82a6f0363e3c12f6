#include <algorithm>
#include <filesystem>
#include <memory>
#include <string>
#include <system_error>
#include <vector>

#include <fmt/format.h>

#include "app/commands/bench.h"
#include "app/work/streams.h"
#include "app/work/work_estimate.h"
#include "bench/machine.h"
#include "engine/base/memory.h"
#include "engine/base/stopwatch.h"
#include "engine/filter/catalogue.h"
#include "engine/filter/noise_range.h"
#include "engine/formats/formats.h"
#include "engine/scanner/scanner.h"

namespace fettle::app {

namespace {

struct BenchEstimateArguments {
  std::vector<int> sides{1024, 2048};
  std::vector<int> threads{1, 0};
  std::vector<std::string> kinds;
  int passes = 2;
  int repeats = 3;
  std::string format = "tif";
};

double middle(std::vector<double> values) {
  std::ranges::sort(values);
  return values[values.size() / 2];
}

// Expected and real, of several runs: the run of the middle ratio counts.
struct ExpectedAndReal {
  std::vector<double> expected, real;

  void add(double e, double r) {
    expected.push_back(e);
    real.push_back(r);
  }
  [[nodiscard]] Report report() const {
    std::vector<double> ratios;
    for (std::size_t i = 0; i < real.size(); ++i) ratios.push_back(expected[i] / real[i]);
    return {{"expected", middle(expected)},
            {"real", middle(real)},
            {"ratio", middle(ratios)},
            {"least_ratio", *std::ranges::min_element(ratios)},
            {"most_ratio", *std::ranges::max_element(ratios)}};
  }
};

engine::Result<Report> row(const engine::Version& field, const engine::FilterSpec& spec,
                           const BenchEstimateArguments& options, engine::JobControl& job) {
  FilterCompute compute(Compute::kCpu, nullptr);
  ExpectedAndReal time, memory, disk;
  for (int i = 0; i < options.repeats; ++i) {
    const auto folder = ScratchFolder::create();
    if (!folder) return tl::unexpected(folder.error());
    const std::string extension = "." + options.format;
    const std::string out = folder->path() + "/out" + extension;
    const PlannedWork work{field, field, {PlannedFilter{spec, compute}}, out, extension, {}};
    engine::resetPeak();
    const auto estimate = estimateWork(work, true, job);
    if (!estimate) return tl::unexpected(estimate.error());
    if (!*estimate) return engine::failure("nothing was sampled", std::string(engine::name(spec.kind)));
    engine::resetPeak();
    const engine::Stopwatch watch;
    const auto filtered = compute.apply(field, field, spec, job);
    const double filter_seconds = watch.seconds();
    if (!filtered) return tl::unexpected(filtered.error());
    const auto written = engine::exportField(filtered->field, out, {}, job);
    if (!written) return tl::unexpected(written.error());
    std::error_code error;
    const auto bytes = std::filesystem::file_size(out, error);
    time.add((*estimate)->work_seconds, filter_seconds);
    memory.add(static_cast<double>((*estimate)->memory_bytes),
               static_cast<double>(engine::residentMemory().peak));
    disk.add(static_cast<double>((*estimate)->disk_bytes), error ? 1.0 : static_cast<double>(bytes));
  }
  return Report{{"seconds", time.report()}, {"memory_bytes", memory.report()}, {"disk_bytes", disk.report()}};
}

engine::Result<Report> measure(const BenchEstimateArguments& options, engine::JobControl& job) {
  Report report{{"machine", bench::machine()}, {"repeats", options.repeats}, {"rows", Report::array()}};
  for (const int side : options.sides) {
    engine::ScannerSpec scanner;
    scanner.width = scanner.height = side;
    const auto scan = engine::simulateScan(scanner, job);
    if (!scan) return tl::unexpected(scan.error());
    for (const engine::Filter& filter : engine::filters())
      for (const int threads : options.threads) {
        if (!options.kinds.empty() && std::ranges::find(options.kinds, filter.word) == options.kinds.end())
          continue;
        engine::FilterSpec spec;
        spec.kind = filter.kind;
        if (filter.window.exists()) spec.window = 9;
        spec.nesting_mm = engine::usualNesting(filter, scan->scan.grid());
        // What is slow has one pass, as it is used.
        spec.passes = filter.grid > 1 || !filter.sampled ? 1 : options.passes;
        spec.threads = threads;
        const auto ready = engine::withMeasuredRange(spec, scan->scan, job);
        if (!ready) return tl::unexpected(ready.error());
        const auto measured = row(scan->scan, *ready, options, job);
        if (!measured) return tl::unexpected(measured.error());
        Report entry{{"filter", filter.word}, {"side", side}, {"threads", threads}, {"passes", spec.passes}};
        entry.update(*measured);
        report["rows"].push_back(std::move(entry));
      }
  }
  return report;
}

void printBenchEstimate(const Report& report) {
  fmt::print("{}\nexpected by --estimate over real, the middle one of {} runs each, least and most\n\n",
             report["machine"].get<std::string>(), report["repeats"].get<int>());
  fmt::print("{:<12}{:>7}{:>9}{:>8}{:>10}{:>9}{:>16}{:>10}{:>16}{:>10}{:>16}\n", "", "side", "threads",
             "passes", "s real", "ratio", "least..most", "MB real", "ratio", "MB disk", "ratio");
  for (const Report& r : report["rows"]) {
    const auto value = [&r](const char* what, const char* key) { return r[what][key].get<double>(); };
    fmt::print("{:<12}{:>7}{:>9}{:>8}{:>10.3f}{:>9.2f}{:>16}{:>10.0f}{:>16.2f}{:>10.1f}{:>16.2f}\n",
               r["filter"].get<std::string>(), r["side"].get<int>(),
               r["threads"].get<int>() == 0 ? "all" : fmt::format("{}", r["threads"].get<int>()),
               r["passes"].get<int>(), value("seconds", "real"), value("seconds", "ratio"),
               fmt::format("{:.2f}..{:.2f}", value("seconds", "least_ratio"), value("seconds", "most_ratio")),
               value("memory_bytes", "real") * 1e-6, value("memory_bytes", "ratio"),
               value("disk_bytes", "real") * 1e-6, value("disk_bytes", "ratio"));
  }
}

}  // namespace

void addBenchEstimate(Command bench, Chosen& chosen) {
  auto options = std::make_shared<BenchEstimateArguments>();
  Command command = addCommand(
      bench, chosen, "estimate",
      "Time, memory and disk that filters are expected to take, and what they take",
      [options](engine::JobControl& job) { return measure(*options, job); }, printBenchEstimate);
  std::vector<Word> kinds, formats;
  for (const engine::Filter& filter : engine::filters()) kinds.emplace_back(std::string(filter.word));
  for (const engine::FormatInfo& format : engine::formats())
    if (format.writes)
      for (const auto& extension : format.extensions) formats.emplace_back(std::string(extension).substr(1));
  command.add({
      {.name = "--side",
       .to = &options->sides,
       .text = "Lengths of each side, one simulated scan each",
       .range = Range{256.0, 32768.0},
       .unit = "samples",
       .between = ','},
      {.name = "--kind",
       .to = &options->kinds,
       .text = "Filters",
       .words = kinds,
       .otherwise = "all",
       .between = ','},
      {.name = "--threads",
       .to = &options->threads,
       .text = "Numbers of threads, 0: one per core",
       .between = ','},
      {.name = "--passes",
       .to = &options->passes,
       .text = "Passes of the filters with a window",
       .range = Range{1.0, engine::FilterSpec::kMaxPasses}},
      {.name = "--format",
       .to = &options->format,
       .text = "Format that results are written in",
       .words = formats},
      {.name = "--repeats",
       .to = &options->repeats,
       .text = "Estimates and runs of each row",
       .range = Range{1.0, 100.0}},
  });
}

}  // namespace fettle::app
