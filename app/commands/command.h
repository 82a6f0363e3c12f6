#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "app/report.h"

#include "app/commands/command_line.h"
#include "engine/base/error.h"
#include "engine/base/job.h"

namespace fettle::app {

/// Who shows the progress of a command.
enum class Progress : std::uint8_t {
  kLine,  ///< the progress line that all commands share
  kOwn,   ///< the command itself
};

/// What a command prints as text.
enum class Printing : std::uint8_t {
  kReport,  ///< what it did: not with --quiet
  kResult,  ///< what was asked for: with --quiet as well
};

/// The command that the command line chose, ready to run. `run` does the work and returns the output of
/// --json; `print` prints it as text on stdout (printReport by default).
struct Chosen {
  std::function<engine::Result<Report>(engine::JobControl&)> run;
  std::function<void(const Report&)> print;
  std::function<int(const Report&)> status;  ///< exit status of what `run` reported; empty: 0
  std::string schema;                        ///< of the report (schemaName)
  Progress progress = Progress::kLine;
  Printing printing = Printing::kReport;
  std::vector<std::string> arguments;  ///< the whole command line, the program's name first
  bool json = false;
  bool quiet = false;  ///< prints only errors
};

/// Adds the warnings that --json collected (takeWarnings) to the report's list `warnings`, except those that
/// it contains already, with or without the file's name before them. Without any the report stays unchanged.
void addKeptWarnings(Report& report);

/// "key value" lines; nested objects are indented, null prints as "-". Without its `warnings`: they were
/// printed on stderr.
void printReport(const Report& report);

/// Adds --json and --quiet, which a command takes before and after its name.
void addOutputFlags(Command app, Chosen& chosen);

/// Adds a subcommand with --json and --quiet. `run` is stored in `chosen` when the command line names it.
Command addCommand(Command root, Chosen& chosen, const std::string& name, const std::string& description,
                   std::function<engine::Result<Report>(engine::JobControl&)> run,
                   std::function<void(const Report&)> print = printReport,
                   Progress progress = Progress::kLine, std::function<int(const Report&)> status = {},
                   Printing printing = Printing::kReport);

/// The commands that read scans, compute and write files: those that the Python module has too. A command that opens a
/// window or a device, measures this program or writes its pages is main()'s alone.
void addScanCommands(Command root, Chosen& chosen);

void addInfo(Command root, Chosen& chosen);
void addSynth(Command root, Chosen& chosen);
void addFilter(Command root, Chosen& chosen);
void addLevel(Command root, Chosen& chosen);
void addFill(Command root, Chosen& chosen);
void addRemove(Command root, Chosen& chosen);
void addTransform(Command root, Chosen& chosen);
void addMeasure(Command root, Chosen& chosen);
void addAlign(Command root, Chosen& chosen);
void addMosaic(Command root, Chosen& chosen);
void addFit(Command root, Chosen& chosen);
void addFeatures(Command root, Chosen& chosen);
void addSection(Command root, Chosen& chosen);
void addReport(Command root, Chosen& chosen);
void addMark(Command root, Chosen& chosen);
void addLines(Command root, Chosen& chosen);
void addRecipe(Command root, Chosen& chosen);
void addApply(Command root, Chosen& chosen);
void addJournal(Command root, Chosen& chosen);
void addReplay(Command root, Chosen& chosen);
void addRecord(Command root, Chosen& chosen);
void addRender(Command root, Chosen& chosen);
void addCompare(Command root, Chosen& chosen);
void addConvert(Command root, Chosen& chosen);
void addPlan(Command root, Chosen& chosen);
void addGather(Command root, Chosen& chosen);
void addStatus(Command root, Chosen& chosen);
void addSubmit(Command root, Chosen& chosen);
void addDevices(Command root, Chosen& chosen);
void addView(Command root, Chosen& chosen);
void addAccuracy(Command root, Chosen& chosen);
void addBench(Command root, Chosen& chosen);
void addDemo(Command root, Chosen& chosen);
void addReference(Command root, Chosen& chosen);

}  // namespace fettle::app
