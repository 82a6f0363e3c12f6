#include "app/commands/bench.h"

#include <algorithm>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>

#include "bench/preview_bench.h"

namespace fettle::app {

namespace {

// Beside filters what is previewed, too.
constexpr std::string_view kFillKind = "fill", kLevelKind = "level";

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
  report["heights"] = Report::array();
  for (const bench::HeightPreviewRow& row : measured->heights)
    report["heights"].push_back({{"what", row.what},
                                 {"side", row.side},
                                 {"samples_in_view", row.seen},
                                 {"first_seconds", orNone(row.first)},
                                 {"means_of", row.step},
                                 {"exact", row.exact},
                                 {"off_said", row.off_said},
                                 {"off_is_estimated", row.estimated},
                                 {"off_rms", row.off_whole},
                                 {"change_rms", orNone(row.change_rms)},
                                 {"whole_seconds", row.whole},
                                 {"alone_seconds", row.alone},
                                 {"hash", fmt::format("{:016x}", row.hash)}});
  return report;
}

std::string numberOrDash(const Report& value, const char* form) {
  return value.is_null() ? std::string("-") : fmt::format(fmt::runtime(form), value.get<double>());
}

void printHeights(const Report& rows) {
  if (rows.empty()) return;
  fmt::print(
      "\nfirst: a picture is there, of means of n x n samples; exact: what it has of the result's bits; "
      "said: how far it says it "
      "is off,\n~ about; off: how far it is; whole: the result is there; alone: without a preview, the same "
      "bits\n\n");
  fmt::print("{:<22}{:>7}{:>10}{:>8}{:>7}{:>8}{:>12}{:>11}{:>11}{:>9}{:>9}\n", "", "side", "seen, M", "first",
             "means", "exact", "said", "off rms", "change rms", "whole", "alone");
  for (const Report& row : rows)
    fmt::print("{:<22}{:>7}{:>10.2f}{:>8}{:>7}{:>7.0f}%{:>12}{:>11.3g}{:>11}{:>9.2f}{:>9.2f}\n",
               row["what"].get<std::string>(), row["side"].get<int>(),
               1e-6 * static_cast<double>(row["samples_in_view"].get<std::int64_t>()),
               numberOrDash(row["first_seconds"], "{:.3f}"), row["means_of"].get<int>(),
               100.0 * row["exact"].get<double>(),
               fmt::format("{}{:.3g}", row["off_is_estimated"].get<bool>() ? "~" : "",
                           row["off_said"].get<double>()),
               row["off_rms"].get<double>(), numberOrDash(row["change_rms"], "{:.3g}"),
               row["whole_seconds"].get<double>(), row["alone_seconds"].get<double>());
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
  for (const Report& row : report["rows"])
    fmt::print("{:<22}{:>7}{:>10.2f}{:>8}{:>7}{:>11}{:>11}{:>11}{:>9}{:>9}{}\n",
               row["filter"].get<std::string>(), row["side"].get<int>(),
               1e-6 * static_cast<double>(row["samples_in_view"].get<std::int64_t>()),
               numberOrDash(row["first_seconds"], "{:.3f}"), row["means_of"].get<int>(),
               numberOrDash(row["off_rms"], "{:.3g}"), numberOrDash(row["off_max"], "{:.3g}"),
               numberOrDash(row["change_rms"], "{:.3g}"), numberOrDash(row["exact_seconds"], "{:.2f}"),
               numberOrDash(row["whole_seconds"], "{:.2f}"),
               row["off_is_estimated"].get<bool>() ? "  estimated" : "");
  printHeights(report["heights"]);
}

}  // namespace

void addBenchPreviews(Command bench, Chosen& chosen) {
  auto options = std::make_shared<bench::PreviewBenchOptions>();
  Command command = addCommand(
      bench, chosen, "previews", "Time until a preview is seen, and how far it is off until it is exact",
      [options](engine::JobControl& job) { return measurePreviews(*options, job); }, printBenchPreviews);
  std::vector<Word> kinds;
  for (const engine::Filter& filter : engine::filters()) kinds.emplace_back(std::string(filter.word));
  for (const std::string_view word : {kFillKind, kLevelKind}) kinds.emplace_back(std::string(word));
  const auto take_kinds = [options](const std::vector<std::string>& typed) {
    options->kinds.clear();
    const auto isAmong = [&](std::string_view word) { return std::ranges::find(typed, word) != typed.end(); };
    options->fill = isAmong(kFillKind);
    options->level = isAmong(kLevelKind);
    for (const std::string& word : typed)
      if (word != kFillKind && word != kLevelKind) options->kinds.push_back(engine::filterNamed(word)->kind);
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
       .text = "Filters, filled holes, levelled lines",
       .words = kinds,
       .otherwise = "median, gaussian, tv, tgv, fill and level",
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
