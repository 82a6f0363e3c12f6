#include "app/commands/program.h"

#include <cerrno>
#include <csignal>
#include <cstdio>

#include <algorithm>
#include <exception>
#include <new>
#include <optional>
#include <string>
#include <system_error>
#include <vector>

#include <fmt/format.h>

#include "app/commands/usage_error.h"
#include "app/reference/report_schema.h"
#include "app/terminal.h"

namespace fettle::app {

namespace {

using engine::ErrorKind;
using engine::JobControl;

int reportUnwritten(const char* remedy) {
  return report({ErrorKind::kFailed, "the report could not be written", "standard output", remedy});
}

constexpr const char* kVersion = "fettle " FETTLE_VERSION;

// A report that did not reach standard output is a failure, regardless of other results; not that a reader, as head, had
// enough of it.
int finish(int status) {
  const bool flushed = std::fflush(stdout) == 0;
  const int error = errno;
  if (!flushed && error == EPIPE) return status;
  if (!flushed && error == ENOSPC) return reportUnwritten("the disk is full: free space on it");
  if (!flushed || std::ferror(stdout) != 0) return reportUnwritten("");
  return status;
}

// -0 is written as 0.
void withoutNegativeZero(Report& report) {
  if (report.is_number_float() && report.get<double>() == 0.0) report = 0.0;
  if (!report.is_structured()) return;
  for (Report& each : report) withoutNegativeZero(each);
}

int runChosen(const Chosen& chosen) {
  JobControl job;
  const InterruptGuard interrupt(job);
  auto result = [&] {
    std::optional<ProgressLine> progress;
    if (chosen.progress == Progress::kLine) progress.emplace(job);
    return chosen.run(job);
  }();
  if (!result) return report(result.error());
  withoutNegativeZero(*result);
  const int status = chosen.status ? chosen.status(*result) : 0;
  try {
    // Printing throws when standard output is full or closed; the work is done then, as its files show.
    if (chosen.json) {
      addKeptWarnings(*result);
      Report object{{"schema", chosen.schema}};
      object.update(*result);
      // A path may contain bytes that are not UTF-8: they are replaced in the report, never in the file system.
      fmt::print("{}\n", object.dump(2, ' ', false, Report::error_handler_t::replace));
    } else if (!chosen.quiet || chosen.printing == Printing::kResult) {
      chosen.print(*result);
    }
  } catch (const std::system_error& error) {
    if (error.code() == std::errc::broken_pipe) return status;
    throw;
  }
  return finish(status);
}

// "help filter" is "filter --help", and "help" is "--help"; also with --json and --quiet, which do not change
// it.
void takeHelpForOption(std::vector<std::string>& arguments) {
  if (arguments.empty()) return;
  const auto help = std::find_if(arguments.begin() + 1, arguments.end(),
                                 [](const std::string& a) { return !a.starts_with("-"); });
  if (help == arguments.end() || *help != "help") return;
  arguments.erase(help);
  std::erase_if(arguments, [](const std::string& a) { return a.starts_with("-"); });
  arguments.emplace_back("--help");
}

}  // namespace

int runProgram(int argc, char** argv, const std::function<void(Command, Chosen&)>& add_commands) {
  // A limit on file sizes then fails the write, like a full disk, instead of ending the program between a
  // temporary file and its removal.
  std::signal(SIGXFSZ, SIG_IGN);
  std::signal(SIGPIPE, SIG_IGN);
  std::vector<std::string> arguments(argv, argv + argc);
  // Errors of the command line itself have the requested form, too.
  Voice voice;
  voice.json = std::find(arguments.begin(), arguments.end(), "--json") != arguments.end();
  setVoice(voice);
  if (const auto error = emptyArgument(arguments)) return report(*error);
  takeHelpForOption(arguments);
  CommandLine line("fettle", "Clean up large scanned height fields by touch", kVersion);
  Command root = line.root();
  root.requireSubcommand();
  Chosen chosen;
  chosen.arguments = arguments;
  addOutputFlags(root, chosen);
  add_commands(root, chosen);
  // Replaced by takeHelpForOption() before it can be chosen.
  std::vector<std::string> unused;
  std::vector<Word> commands;
  for (const CommandTable& command : root.table().commands) commands.emplace_back(command.name);
  root.subcommand("help", "The help of a command, as its --help: fettle help filter")
      .add({{.name = "COMMAND", .to = &unused, .text = "The command", .words = commands}});

  const auto text = line.parse(arguments);
  if (!text)
    return report(usageError(text.error(), fmt::format("see fettle {}--help", text.error().command)));
  if (voice.json && *text == kVersion + std::string("\n")) {
    fmt::print("{}\n", Report{{"schema", schemaName("fettle version")}, {"version", FETTLE_VERSION}}.dump(2));
    return finish(0);
  }
  if (!text->empty()) {
    if (std::fputs(text->c_str(), stdout) < 0 && errno == EPIPE) return 0;
    return finish(0);
  }
  voice.json = chosen.json;
  voice.quiet = chosen.quiet;
  setVoice(voice);
  try {
    return runChosen(chosen);
  } catch (const std::system_error& error) {
    return reportUnwritten(error.what());
  } catch (const std::bad_alloc&) {
    return report({ErrorKind::kFailed, "memory ran out", "", "close other programs or take a smaller scan"});
  } catch (const std::exception& error) {
    return report({ErrorKind::kFailed, error.what(), "", "this should not happen, please report it"});
  }
}

}  // namespace fettle::app
