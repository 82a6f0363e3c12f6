#include "app/commands/bench.h"

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "bench/preview_bench.h"

namespace fettle::app {

namespace {

engine::Result<Report> measurePreviews(const bench::PreviewBenchOptions& options, engine::JobControl& job) {
  const auto measured = bench::benchPreviews(options, job);
  if (!measured) return tl::unexpected(measured.error());
  Report report{{"machine", measured->machine}, {"limit_s", options.limit_s}, {"rows", Report::array()}};
  const auto orNone = [](double value) { return value > 0.0 ? Report(value) : Report(); };
  for (const bench::PreviewBenchRow& row : measured->rows)
    report["rows"].push_back({{"filter", row.filter},
                              {"side", row.side},
                              {"samples_in_view", row.seen},
                              {"first_seconds", orNone(row.first)},
                              {"means_of", row.step},
                              {"off_rms", row.step > 0 ? Report(row.off_rms) : Report()},
                              {"off_max", row.step > 0 ? Report(row.off_most) : Report()},
                              {"off_is_estimated", row.estimated},
                              {"change_rms", orNone(row.change_rms)},
                              {"exact_seconds", orNone(row.exact)},
                              {"whole_seconds", orNone(row.whole)}});
  return report;
}

void printBenchPreviews(const Report& report) {
  fmt::print(
      "{}\nfirst: all that is seen shows the filter; means of n x n samples: it is approximated, off by so "
      "much; change: what "
      "the\nfilter changes; exact: all that is seen has its results; whole: the field has them (in height "
      "units and seconds; "
      "-: not within {:g} s)\n\n",
      report["machine"].get<std::string>(), report["limit_s"].get<double>());
  fmt::print("{:<22}{:>7}{:>10}{:>8}{:>7}{:>11}{:>11}{:>11}{:>9}{:>9}\n", "filter", "side", "seen, M",
             "first", "means", "off rms", "off max", "change rms", "exact", "whole");
  const auto text = [](const Report& value, const char* form) {
    return value.is_null() ? std::string("-") : fmt::format(fmt::runtime(form), value.get<double>());
  };
  for (const Report& row : report["rows"])
    fmt::print(
        "{:<22}{:>7}{:>10.2f}{:>8}{:>7}{:>11}{:>11}{:>11}{:>9}{:>9}{}\n", row["filter"].get<std::string>(),
        row["side"].get<int>(), 1e-6 * static_cast<double>(row["samples_in_view"].get<std::int64_t>()),
        text(row["first_seconds"], "{:.3f}"), row["means_of"].get<int>(), text(row["off_rms"], "{:.3g}"),
        text(row["off_max"], "{:.3g}"), text(row["change_rms"], "{:.3g}"),
        text(row["exact_seconds"], "{:.2f}"), text(row["whole_seconds"], "{:.2f}"),
        row["off_is_estimated"].get<bool>() ? "  estimated" : "");
}

}  // namespace

void addBenchPreviews(Command bench, Chosen& chosen) {
  auto options = std::make_shared<bench::PreviewBenchOptions>();
  Command command = addCommand(
      bench, chosen, "previews",
      "Time until a filter's preview is seen, and how far it is off until it is exact",
      [options](engine::JobControl& job) { return measurePreviews(*options, job); }, printBenchPreviews);
  std::vector<Word> kinds;
  for (const engine::Filter& filter : engine::filters()) kinds.emplace_back(std::string(filter.word));
  const auto take_kinds = [options](const std::vector<std::string>& typed) {
    options->kinds.clear();
    for (const std::string& word : typed) options->kinds.push_back(engine::filterNamed(word)->kind);
  };
  using Words = std::function<void(const std::vector<std::string>&)>;
  command.add({
      {.name = "--side",
       .to = &options->sides,
       .text = "Lengths of the sides of the fields",
       .unit = "samples",
       .between = ','},
      {.name = "--kind",
       .to = Words(take_kinds),
       .text = "Filters",
       .words = kinds,
       .otherwise = "median, gaussian, tv and tgv",
       .between = ','},
      {.name = "--window",
       .to = &options->window,
       .text = "Side of the window, odd",
       .range = Range{1.0, 1001.0},
       .unit = "samples"},
      {.name = "--limit",
       .to = &options->limit_s,
       .text = "Time of a preview, which is cancelled then",
       .unit = "seconds"},
  });
}

}  // namespace fettle::app
