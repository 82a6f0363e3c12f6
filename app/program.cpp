#include "app/program.h"

#include <csignal>
#include <cstdio>

#include <exception>
#include <new>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>

#include <fmt/format.h>

#include "app/terminal.h"

namespace fettle::app {

namespace {

using engine::Error;
using engine::ErrorKind;
using engine::JobControl;

// A report that did not reach standard output is a failure, whatever else went well.
int finish(int status) {
  if (std::fflush(stdout) != 0 || std::ferror(stdout) != 0)
    return report({ErrorKind::kInput, "the report could not be written", "standard output", ""});
  return status;
}

int runChosen(const Chosen& chosen) {
  JobControl job;
  const InterruptGuard interrupt(job);
  const auto result = [&] {
    std::optional<ProgressLine> progress;
    if (chosen.progress == Progress::kLine) progress.emplace(job);
    return chosen.run(job);
  }();
  if (!result) return report(result.error());
  // Printing throws when standard output is full or closed; the work is done then, and says so by its files.
  if (chosen.json)
    // A path may hold bytes that are not UTF-8: they are replaced in the report, never in the file system.
    fmt::print("{}\n", result->dump(2, ' ', false, Report::error_handler_t::replace));
  else
    chosen.print(*result);
  return finish(chosen.status ? chosen.status(*result) : 0);
}

// `--keep "$MARKS"` with MARKS unset would mean "no marks": the protection that was asked for, silently gone.
// Only a title may be empty.
std::optional<Error> emptyArgument(int argc, char** argv) {
  for (int i = 1; i < argc; ++i) {
    const std::string_view before = argv[i - 1];
    if (*argv[i] == '\0' && !before.ends_with("title"))
      return Error{ErrorKind::kInput, fmt::format("argument {} is empty", i), std::string(before),
                   "is a shell variable unset?"};
  }
  return std::nullopt;
}

}  // namespace

int runProgram(int argc, char** argv, const std::function<void(CLI::App&, Chosen&)>& add_commands) {
  // A limit on file sizes then fails the write, as a full disk does, instead of ending the program between a
  // temporary file and its removal.
  std::signal(SIGXFSZ, SIG_IGN);
  std::signal(SIGPIPE, SIG_IGN);
  if (const auto error = emptyArgument(argc, argv)) return report(*error);
  CLI::App root{"Fettle cleans up large scanned height fields by touch.", "fettle"};
  root.require_subcommand(1);
  root.set_version_flag("--version", "fettle " FETTLE_VERSION);
  Chosen chosen;
  add_commands(root, chosen);

  try {
    root.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return finish(root.exit(error));  // --help and --version
    std::string command;
    for (const CLI::App* used : root.get_subcommands()) command = used->get_name() + " ";
    // "A subcommand is required" is no answer to one that is misspelt.
    const auto rest = root.remaining(true);
    if (dynamic_cast<const CLI::RequiredError*>(&error) != nullptr && !rest.empty() &&
        !rest[0].starts_with("-"))
      return report({ErrorKind::kInput, fmt::format("there is no command {}{}", command, rest[0]), "",
                     fmt::format("see fettle {}--help", command)});
    return report({ErrorKind::kInput, error.what(), "", fmt::format("see fettle {}--help", command)});
  }
  try {
    return runChosen(chosen);
  } catch (const std::system_error& error) {
    return report({ErrorKind::kInput, "the report could not be written", "standard output", error.what()});
  } catch (const std::bad_alloc&) {
    return report({ErrorKind::kFailed, "memory ran out", "", "close other programs or take a smaller scan"});
  } catch (const std::exception& error) {
    return report({ErrorKind::kFailed, error.what(), "", "this should not happen, please report it"});
  }
}

}  // namespace fettle::app
