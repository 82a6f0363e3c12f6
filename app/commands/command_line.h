#pragma once

#include <functional>
#include <initializer_list>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <tl/expected.hpp>

#include "app/reference/command_table.h"

// CLI11 is a header that takes seconds to compile: only command_line.cpp includes it.
namespace CLI {
class App;
}  // namespace CLI

namespace fettle::app {

/// A command, or the whole program as the root of all commands. Small, passed by value; valid as long as the
/// CommandLine. Parameters refer to variables, which must exist until the arguments are parsed.
class Command {
 public:
  Command(CLI::App* app, CommandTable* table) : app_(app), table_(table) {}

  Command subcommand(const std::string& name, const std::string& summary);
  void requireSubcommand();                ///< exactly one of its subcommands must be named
  void onChosen(std::function<void()> f);  ///< called when the command line names this command and is valid
  void notes(const std::string& text);     ///< shown after the parameters
  void examples(std::initializer_list<Example> examples);

  /// Adds rows to the table of its parameters, and to the parser. Throws when a name exists already.
  void add(std::initializer_list<Parameter> rows, const std::string& group = {});

  /// Its rows and those of the commands below it.
  [[nodiscard]] const CommandTable& table() const { return *table_; }

 private:
  CLI::App* app_;
  CommandTable* table_;
};

/// A command line that could not be parsed.
struct Misread {
  std::string what;               ///< the first error, as text
  std::string command;            ///< "bench haptic ": the recognised commands, each followed by a blank
  std::vector<std::string> rest;  ///< words that were not used
  std::vector<std::string> known_commands;  ///< that may follow `command`
  std::vector<std::string> known_options;   ///< of `command`, "--name" and "-n"
};

/// The commands and options of a program, and the parser of its arguments.
class CommandLine {
 public:
  /// With -h,--help for every command, and -V,--version, which shows `version`.
  CommandLine(const std::string& name, const std::string& description, const std::string& version);
  ~CommandLine();
  CommandLine& operator=(CommandLine&&) = delete;

  [[nodiscard]] Command root();

  /// Sets variables and calls the handlers. `arguments` are those of main(), the program's name first.
  /// Returns the text of the help or the version where that is requested, otherwise an empty one.
  [[nodiscard]] tl::expected<std::string, Misread> parse(const std::vector<std::string>& arguments);

 private:
  /// The command that was named, as far as it was recognised.
  [[nodiscard]] std::pair<const CLI::App*, const CommandTable*> usedTable() const;

  std::unique_ptr<CLI::App> app_;
  std::string version_;
  CommandTable table_;
};

}  // namespace fettle::app
