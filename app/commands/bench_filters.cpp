#include "app/commands/bench.h"

#include <algorithm>
#include <map>
#include <memory>
#include <string>

#include <fmt/format.h>

#include "bench/filters_bench.h"
#include "render/compute/tgv_compute.h"

namespace fettle::app {

namespace {

std::string_view elementWord(engine::Element element) {
  return engine::kElementWords[static_cast<std::size_t>(element)];
}

struct OperationName {
  const char* key;
  double bench::Operations::*count;
};
constexpr OperationName kOperationNames[] = {
    {"products", &bench::Operations::products}, {"extrema", &bench::Operations::extrema},
    {"chords", &bench::Operations::chords},     {"sums", &bench::Operations::sums},
    {"tests", &bench::Operations::tests},       {"moves", &bench::Operations::moves},
    {"flips", &bench::Operations::flips},       {"selections", &bench::Operations::selections},
    {"sorts", &bench::Operations::sorts}};

Report countsOf(const bench::Operations& operations) {
  Report counts;
  for (const OperationName& name : kOperationNames) counts[name.key] = operations.*name.count;
  return counts;
}

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
    const bool rolls = engine::filterOf(row.kind).has_element;
    const double cost = bench::suggestedCost(row);
    report["rows"].push_back({{"kind", engine::name(row.kind)},
                              {"element", rolls ? Report(elementWord(row.element)) : Report()},
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
                              {"suggested_cost_ns", cost > 0.0 ? Report(cost) : Report()},
                              {"share_target", target.share},
                              {"over_one_thread_target", target.over_one},
                              {"bound_filter_s", row.bound.filter},
                              {"bound_tiles_s", row.bound.tiles},
                              {"bound_operations_s", row.bound.operations},
                              {"bound_whole", row.bound.whole},
                              {"bound_counts", countsOf(row.bound.counted)},
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

// "17 extrema", "46.1 sums, 1.3 tests".
std::string countsText(const Report& row) {
  std::string text;
  for (const OperationName& name : kOperationNames)
    if (const double count = row["bound_counts"][name.key].get<double>(); count > 0.0)
      text += fmt::format("{}{:.4g} {}", text.empty() ? "" : ", ", count, name.key);
  return text;
}

void printBenchFilters(const Report& report) {
  fmt::print(
      "{}\nwhole filter with its report, million samples/s, median of {} runs; share: of plain copying of "
      "floats by as many threads, in the same run, and its target; x one: of the rate with one thread, and "
      "its target; *: met; CPU: per second of processor time; cost: ns per sample that --suggest takes for "
      "it\n\n",
      report["machine"].get<std::string>(), report["repeats"].get<int>());
  fmt::print("{:<16}{:>7}{:>8}{:>9}{:>7}{:>10}{:>10}{:>10}{:>8}{:>16}{:>16}{:>10}{:>10}{:>6}  hash\n", "",
             "window", "ground", "threads", "side", "Ms/s", "slowest", "fastest", "copy", "share target ",
             "x one target ", "CPU Ms/s", "CPU share", "cost");
  for (const Report& row : report["rows"]) {
    const auto number = [&row](const char* key) { return row[key].get<double>(); };
    const bool several = row["threads"].get<int>() > 1;
    fmt::print(
        "{:<16}{:>7}{:>8}{:>9}{:>7}{:>10.2f}{:>10.2f}{:>10.2f}{:>8.0f}{:>16}{:>16}{:>10.1f}{:>10.4f}{:>6}  "
        "{}\n",
        fmt::format("{}{}{}", row["kind"].get<std::string>(), row["element"].is_null() ? "" : " ",
                    row["element"].is_null() ? "" : row["element"].get<std::string>()),
        row["window"].get<int>(), row["ground"].get<std::string>(), row["threads"].get<int>(),
        row["side"].get<int>(), number("samples_per_second") * 1e-6, number("slowest") * 1e-6,
        number("fastest") * 1e-6, number("copy_samples_per_second") * 1e-6,
        valueAndTarget(number("share_of_copy"), number("share_target"), 4),
        valueAndTarget(several ? number("over_one_thread") : 0.0, number("over_one_thread_target"), 2),
        number("samples_per_cpu_second") * 1e-6, number("share_of_copy_cpu"),
        row["suggested_cost_ns"].is_null() ? "" : fmt::format("{:g}", number("suggested_cost_ns")),
        row["hash"].get<std::string>());
    if (number("bound_tiles_s") > 0.0) {
      const double tiles = number("bound_tiles_s"), operations = number("bound_operations_s");
      fmt::print(
          "{:<16}cannot do without, alone, in ns per sample: {:.3f} for reading tiles and writing new ones",
          "", tiles * 1e9);
      if (operations > 0.0) fmt::print(", {:.3f} for its operations ({})", operations * 1e9, countsText(row));
      fmt::print("; all of it {:.3f}, ", number("bound_filter_s") * 1e9);
      if (row["bound_whole"].get<bool>())
        fmt::print("{:.0f} % of that bound's rate\n",
                   100.0 * (tiles + operations) / number("bound_filter_s"));
      else
        fmt::print("of which what it works out is not counted: no bound\n");
    }
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
  std::vector<Word> kinds, grounds;
  for (const engine::Filter& filter : engine::filters()) kinds.emplace_back(std::string(filter.word));
  std::map<std::string, bench::FilterGround> ground_named;
  for (const bench::FilterGround ground : options->grounds) {
    grounds.emplace_back(bench::groundName(ground));
    ground_named[bench::groundName(ground)] = ground;
  }
  const auto take_kinds = [options](const std::vector<std::string>& typed) {
    options->kinds.clear();
    for (const std::string& word : typed) options->kinds.push_back(engine::filterNamed(word)->kind);
  };
  const auto take_grounds = [options, ground_named](const std::vector<std::string>& typed) {
    options->grounds.clear();
    for (const std::string& word : typed) options->grounds.push_back(ground_named.at(word));
  };
  std::vector<Word> elements;
  elements.reserve(std::size(engine::kElementWords));
  for (const std::string_view word : engine::kElementWords) elements.emplace_back(std::string(word), "");
  const auto take_elements = [options](const std::vector<std::string>& typed) {
    options->elements.clear();
    for (const std::string& word : typed)
      options->elements.push_back(static_cast<engine::Element>(
          std::ranges::find(engine::kElementWords, word) - engine::kElementWords.begin()));
  };
  using Words = std::function<void(const std::vector<std::string>&)>;
  command.add({
      {.name = "--side",
       .to = &options->side,
       .text = "Length of each side of the field",
       .range = Range{64.0, 32768.0},
       .unit = "samples"},
      {.name = "--kind",
       .to = Words(take_kinds),
       .text = "Filters",
       .words = kinds,
       .otherwise = "those that do not keep edges",
       .between = ','},
      {.name = "--element",
       .to = Words(take_elements),
       .text = "Bodies of the filters that roll one",
       .words = elements,
       .otherwise = "all",
       .between = ','},
      {.name = "--window",
       .to = &options->windows,
       .text = "Sides of the window, odd",
       .unit = "samples",
       .between = ','},
      {.name = "--ground",
       .to = Words(take_grounds),
       .text = "Grounds",
       .words = grounds,
       .otherwise = "all",
       .between = ','},
      {.name = "--threads", .to = &options->threads, .text = "Numbers of threads", .between = ','},
      {.name = "--gpu",
       .to = on_device.get(),
       .text = fmt::format("Measure {} on a graphics device as well, against the processor in the same run",
                           engine::filterWords(engine::runsOnDevices))},
      {.name = "--bound",
       .to = &options->bounds,
       .text = "What each filter cannot do without, measured alone, for the rows of one thread"},
      {.name = "--repeats", .to = &options->repeats, .text = "Runs of each row", .range = Range{1.0, 100.0}},
      {.name = "--limit",
       .to = &options->limit_s,
       .text = "Time for all runs of a row; a slower one gets a smaller field",
       .unit = "seconds"},
  });
}

}  // namespace fettle::app
