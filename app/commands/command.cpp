#include "app/commands/command.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "app/reference/report_schema.h"
#include "app/terminal.h"
#include "app/work/spelling.h"
#include "app/work/streams.h"

namespace fettle::app {

namespace {

std::string text(const Report& value) {
  if (value.is_null()) return "-";
  if (value.is_string()) return value.get<std::string>();
  if (value.is_number_float()) {
    const double number = value.get<double>();
    // What could not be found; null in JSON.
    return std::isfinite(number) ? fmt::format("{:.9g}", number) : "-";
  }
  return value.dump();
}

// "row 3, column 5, height 9.792"; a string as it is.
std::string line(const Report& object) {
  if (!object.is_object()) return text(object);
  std::string joined;
  for (const auto& [key, value] : object.items())
    joined += fmt::format("{}{} {}", joined.empty() ? "" : ", ", key, text(value));
  return joined;
}

bool isList(const Report& value) {
  return value.is_array() && !value.empty() && (value.front().is_object() || value.front().is_string());
}

void printIndented(const Report& report, int indent) {
  std::size_t widest = 0;
  for (const auto& [key, value] : report.items()) widest = std::max(widest, key.size());
  for (const auto& [key, value] : report.items()) {
    if (value.is_object()) {
      fmt::print("{:{}}{}\n", "", indent, key);
      printIndented(value, indent + 2);
    } else if (isList(value)) {
      fmt::print("{:{}}{}\n", "", indent, key);
      for (const Report& entry : value) fmt::print("{:{}}  {}\n", "", indent, line(entry));
    } else if (!(value.is_array() && value.empty())) {
      fmt::print("{:{}}{:<{}}  {}\n", "", indent, key, widest, text(value));
    }
  }
}

}  // namespace

void addKeptWarnings(Report& report) {
  for (const std::string& warning : takeWarnings()) {
    Report& list = report["warnings"];
    if (!list.is_array()) list = Report::array();
    const bool there = std::any_of(list.begin(), list.end(), [&](const Report& held) {
      return held.is_string() && warning.ends_with(held.get<std::string>());
    });
    if (!there) list.push_back(warning);
  }
}

void printReport(const Report& report) {
  // Warnings were printed on stderr when they occurred.
  Report shown = report;
  shown.erase("warnings");
  printIndented(shown, 0);
}

void addOutputFlags(Command app, Chosen& chosen) {
  app.add({{.name = "--json",
            .to = &chosen.json,
            .text = "Print one JSON object on stdout instead of text, an error as one on stderr"},
           {.name = "-q,--quiet",
            .to = &chosen.quiet,
            .text = "Print only errors: no report, warnings or progress"}},
          kReportGroup);
}

Command addCommand(Command root, Chosen& chosen, const std::string& name, const std::string& description,
                   std::function<engine::Result<Report>(engine::JobControl&)> run,
                   std::function<void(const Report&)> print, Progress progress,
                   std::function<int(const Report&)> status, Printing printing) {
  Command command = root.subcommand(name, description);
  addOutputFlags(command, chosen);
  command.onChosen([&chosen, schema = schemaName(command.table().path), run = std::move(run),
                    print = std::move(print), progress, status = std::move(status), printing] {
    chosen.run = run;
    chosen.schema = schema;
    chosen.print = print;
    chosen.progress = progress;
    chosen.status = status;
    chosen.printing = printing;
  });
  return command;
}

}  // namespace fettle::app
