#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "engine/base/error.h"
#include "engine/base/job.h"

namespace fettle::app {

/// What a command found out: one object with stable keys, in the order in which people read them.
using Report = nlohmann::ordered_json;

/// Who shows how far a command is.
enum class Progress : std::uint8_t {
  kLine,  ///< the progress line that all commands share
  kOwn,   ///< the command itself
};

/// The command that the command line chose, ready to run. `run` does the work and returns what --json prints;
/// `print` shows the same to a person on stdout (printReport by default).
struct Chosen {
  std::function<engine::Result<Report>(engine::JobControl&)> run;
  std::function<void(const Report&)> print;
  std::function<int(const Report&)> status;  ///< exit status of what `run` reported; empty: 0
  Progress progress = Progress::kLine;
  bool json = false;
  bool quiet = false;  ///< nothing is said but errors
};

/// Puts the warnings that --json kept back (takeWarnings) into the report's list `warnings`, but for those
/// that it holds already, with or without the file's name before them. Without any the report stays as it is.
void addKeptWarnings(Report& report);

/// "key  value" lines; nested objects are indented, null prints as "-".
void printReport(const Report& report);

/// Adds --json and --quiet, which a command takes before and behind its name.
void addOutputFlags(CLI::App& app, Chosen& chosen);

/// Adds a subcommand with --json and --quiet. `run` is stored in `chosen` when the command line names it.
CLI::App* addCommand(CLI::App& root, Chosen& chosen, const std::string& name, const std::string& description,
                     std::function<engine::Result<Report>(engine::JobControl&)> run,
                     std::function<void(const Report&)> print = printReport,
                     Progress progress = Progress::kLine, std::function<int(const Report&)> status = {});

/// For CLI::Option::check: a number from `lowest` to `highest`. CLI::Range lets NaN through.
[[nodiscard]] CLI::Validator within(double lowest, double highest);

/// For CLI::Option::check: one of these words. Another is refused with what it may stand for.
[[nodiscard]] CLI::Validator oneOf(const std::vector<std::string>& words);

void addInfo(CLI::App& root, Chosen& chosen);
void addSynth(CLI::App& root, Chosen& chosen);
void addFilter(CLI::App& root, Chosen& chosen);
void addMark(CLI::App& root, Chosen& chosen);
void addReplay(CLI::App& root, Chosen& chosen);
void addRecord(CLI::App& root, Chosen& chosen);
void addRender(CLI::App& root, Chosen& chosen);
void addCompare(CLI::App& root, Chosen& chosen);
void addConvert(CLI::App& root, Chosen& chosen);
void addDevices(CLI::App& root, Chosen& chosen);
void addView(CLI::App& root, Chosen& chosen);
void addAccuracy(CLI::App& root, Chosen& chosen);
void addBench(CLI::App& root, Chosen& chosen);
void addDemo(CLI::App& root, Chosen& chosen);

}  // namespace fettle::app
