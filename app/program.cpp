#include "app/program.h"

#include <cerrno>
#include <csignal>
#include <cstdio>

#include <algorithm>
#include <exception>
#include <new>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

#include <fmt/format.h>

#include "app/spelling.h"
#include "app/terminal.h"

namespace fettle::app {

namespace {

using engine::Error;
using engine::ErrorKind;
using engine::JobControl;

int reportUnwritten(const char* remedy) {
  return report({ErrorKind::kFailed, "the report could not be written", "standard output", remedy});
}

// A report that did not reach standard output is a failure, whatever else went well.
int finish(int status) {
  const bool flushed = std::fflush(stdout) == 0;
  const int error = errno;
  if (!flushed && error == ENOSPC) return reportUnwritten("the disk is full: make room on it");
  if (!flushed || std::ferror(stdout) != 0) return reportUnwritten("");
  return status;
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
  // Printing throws when standard output is full or closed; the work is done then, and says so by its files.
  if (chosen.json) {
    addKeptWarnings(*result);
    // A path may hold bytes that are not UTF-8: they are replaced in the report, never in the file system.
    fmt::print("{}\n", result->dump(2, ' ', false, Report::error_handler_t::replace));
  } else if (!chosen.quiet) {
    chosen.print(*result);
  }
  return finish(chosen.status ? chosen.status(*result) : 0);
}

// `--keep "$MARKS"` with MARKS unset would mean "no marks": the protection that was asked for, silently gone.
// Only a title may be empty.
std::optional<Error> emptyArgument(const std::vector<std::string>& arguments) {
  for (std::size_t i = 1; i < arguments.size(); ++i)
    if (arguments[i].empty() && !arguments[i - 1].ends_with("title"))
      return Error{ErrorKind::kInput, fmt::format("argument {} is empty", i), arguments[i - 1],
                   "is a shell variable unset?"};
  return std::nullopt;
}

// "help filter" is "filter --help", and "help" alone "--help".
void takeHelpForOption(std::vector<std::string>& arguments) {
  if (arguments.size() < 2 || arguments[1] != "help") return;
  arguments.erase(arguments.begin() + 1);
  std::erase_if(arguments, [](const std::string& a) { return a.starts_with("-"); });
  arguments.emplace_back("--help");
}

std::vector<std::string> commandNames(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::App* command : app.get_subcommands([](const CLI::App*) { return true; }))
    names.push_back(command->get_name());
  return names;
}

std::vector<std::string> optionNames(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::Option* option : app.get_options())
    for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
  return names;
}

// The error of a command line that could not be parsed: the word that is wrong, and what it may stand for.
Error usageError(const CLI::App& root, const CLI::ParseError& error) {
  const CLI::App* used = &root;
  std::string command;
  while (!used->get_subcommands().empty()) {
    used = used->get_subcommands().front();
    command += used->get_name() + " ";
  }
  const std::string help = fmt::format("see fettle {}--help", command);
  const auto refused = [&](std::string what, const std::string& meant) {
    return Error{ErrorKind::kInput, std::move(what), "",
                 meant.empty() ? help : fmt::format("{} {}", meant, help)};
  };
  const std::vector<std::string> rest = root.remaining(true);
  // A word that stands in the place of a command comes first: all behind it belongs to it.
  const bool takes_commands = !commandNames(*used).empty();
  const auto word = std::find_if(rest.begin(), rest.end(), [](const auto& w) { return !w.starts_with("-"); });
  if (takes_commands && word != rest.end())
    return refused(fmt::format("there is no command {}{}", command, *word),
                   didYouMean(*word, commandNames(*used)));
  // Then options: one that is misspelt leaves the value of another missing, or its own value over.
  for (const std::string& option : rest) {
    if (!option.starts_with("-") || option == "-") continue;
    const std::string name = option.substr(0, option.find('='));
    const std::string meant = didYouMean(name.starts_with("--") ? name : "-" + name, optionNames(*used));
    return refused(fmt::format("there is no option {}", name), meant);
  }
  return refused(error.what(), "");
}

}  // namespace

int runProgram(int argc, char** argv, const std::function<void(CLI::App&, Chosen&)>& add_commands) {
  // A limit on file sizes then fails the write, as a full disk does, instead of ending the program between a
  // temporary file and its removal.
  std::signal(SIGXFSZ, SIG_IGN);
  std::signal(SIGPIPE, SIG_IGN);
  std::vector<std::string> arguments(argv, argv + argc);
  // Errors of the command line itself have the form that is asked for, too.
  Voice voice;
  voice.json = std::find(arguments.begin(), arguments.end(), "--json") != arguments.end();
  setVoice(voice);
  if (const auto error = emptyArgument(arguments)) return report(*error);
  takeHelpForOption(arguments);
  CLI::App root{"Fettle cleans up large scanned height fields by touch.", "fettle"};
  root.require_subcommand(1);
  root.set_version_flag("-V,--version", "fettle " FETTLE_VERSION);
  Chosen chosen;
  addOutputFlags(root, chosen);
  add_commands(root, chosen);
  // Replaced by takeHelpForOption() before it could be chosen.
  root.add_subcommand("help", "The help of a command, as its --help: fettle help filter");

  try {
    std::vector<std::string> backwards(arguments.rbegin(), arguments.rend() - (argc > 0 ? 1 : 0));
    root.parse(std::move(backwards));
  } catch (const CLI::ParseError& error) {
    // "fitler --help" asks for the help of a command that is not there, not for that of the program.
    const auto rest = root.remaining();
    const bool misspelt = root.get_subcommands().empty() && !rest.empty() && !rest[0].starts_with("-");
    if (error.get_exit_code() == 0 && !misspelt) return finish(root.exit(error));  // --help and --version
    return report(usageError(root, error));
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
