#pragma once

#include <algorithm>
#include <concepts>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <tl/expected.hpp>

// CLI11 is a header that takes seconds to compile: only command_line.cpp includes it.
namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace fettle::app {

/// A condition for the value of an option.
struct Check {
  std::function<std::string(const std::string&)> problem;  ///< of a value as typed; empty: none
  std::string shown = {};                                  ///< its description in the help
};

/// A whole number from `lowest` to `highest`.
[[nodiscard]] Check inRange(int lowest, int highest);

/// One of `words`, without a suggestion for others: see oneOf().
[[nodiscard]] Check memberOf(const std::vector<std::string>& words);

/// One option of a command. Small, passed by value; valid as long as the CommandLine.
class Option {
 public:
  explicit Option(CLI::Option* option) : option_(option) {}

  Option& group(const std::string& name);  ///< the heading under which the help lists it
  Option& check(Check check);
  Option& required();
  Option& expected(int values);         ///< exactly so many values
  Option& delimiter(char between);      ///< between values that are typed as one word
  Option& showDefault();                ///< the help shows the current value of the variable
  Option& excludes(Option other);       ///< only one of the two may be given
  Option& oneValueEach();               ///< the word after the value is not another value
  Option& typeName(const char* shown);  ///< the type shown in the help

 private:
  CLI::Option* option_;
};

/// The types of an option's variable.
template <typename T>
concept OptionValue =
    std::same_as<T, std::string> || std::same_as<T, std::vector<std::string>> || std::same_as<T, int> ||
    std::same_as<T, std::vector<int>> || std::same_as<T, std::int64_t> || std::same_as<T, std::uint64_t> ||
    std::same_as<T, double> || std::same_as<T, std::optional<double>> || std::same_as<T, std::vector<double>>;

/// A command, or the whole program as the root of all commands. Small, passed by value; valid as long as the
/// CommandLine. Options refer to the given variables, which must exist until the arguments are parsed.
class Command {
 public:
  explicit Command(CLI::App* app) : app_(app) {}

  Command subcommand(const std::string& name, const std::string& description);
  void requireSubcommand();                ///< exactly one of its subcommands must be named
  void onChosen(std::function<void()> f);  ///< called when the command line names this command and is valid
  void footer(const std::string& text);    ///< added at the end of its help

  /// "--name", or "NAME" for a positional argument. Throws when the name exists already.
  template <OptionValue T>
  Option option(const std::string& name, T& variable, const std::string& help);

  /// An option whose value is passed to `take`.
  Option onOption(const std::string& name, const std::function<void(const std::string&)>& take,
                  const std::string& help);

  /// An option with any of some words, each of which represents a value.
  template <typename T>
  Option choices(const std::string& name, const std::map<std::string, T>& words, std::vector<T>& chosen,
                 const std::string& help) {
    std::map<std::string, int> numbers;
    for (const auto& [word, value] : words) numbers[word] = static_cast<int>(value);
    return onNumbers(
        name, numbers,
        [&chosen](const std::vector<int>& typed) {
          chosen.resize(typed.size());
          std::transform(typed.begin(), typed.end(), chosen.begin(), [](int n) { return static_cast<T>(n); });
        },
        help);
  }

  /// "--name", or "-n,--name".
  Option flag(const std::string& name, bool& variable, const std::string& help);

  /// A flag that calls `f` when it is given.
  Option onFlag(const std::string& name, std::function<void()> f, const std::string& help);

 private:
  Option onNumbers(const std::string& name, const std::map<std::string, int>& words,
                   const std::function<void(const std::vector<int>&)>& take, const std::string& help);

  CLI::App* app_;
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
  std::unique_ptr<CLI::App> app_;
};

}  // namespace fettle::app
