#include "app/commands/fit_text.h"

#include <string>

#include <fmt/format.h>

#include "app/commands/command.h"
#include "app/commands/noise_text.h"
#include "app/work/fit_files.h"
#include "app/work/layer_over.h"

namespace fettle::app {

namespace {

void printFitLines(const std::vector<FitLine>& lines) {
  for (const FitLine& line : lines) fmt::print("  {:<19} {}\n", line.name, line.text);
}

}  // namespace

void printFits(const Report& report) {
  if (report.contains("text")) return printReport(report);
  printNoise(report);
  printLayer(report);
  for (const Report& fit : report["fits"]) {
    fmt::print("{}\n", fitTitle(fit));
    if (fit["left_out"].get<std::int64_t>() > 0)
      fmt::print("  {} samples lie apart and do not count\n", fit["left_out"].get<std::int64_t>());
    printFitLines(fitLines(fit));
  }
  for (const Report& one : report["not_fitted"])
    fmt::print("region {}: {} samples, {}\n", one["region"].get<int>(), one["samples"].get<std::int64_t>(),
               one["reason"].get<std::string>());
  if (!report.contains("between")) return;
  fmt::print("between {} and {}:\n", report["between"]["first"].get<int>(),
             report["between"]["second"].get<int>());
  printFitLines(relationLines(report["between"]));
}

}  // namespace fettle::app
