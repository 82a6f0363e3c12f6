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

// CLI11 is a header that costs seconds in every file that includes it: only command_line.cpp does.
namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace fettle::app {

/// What the value of an option must be.
struct Check {
  std::function<std::string(const std::string&)> problem;  ///< of a value as typed; empty: there is none
  std::string shown = {};                                  ///< what the help says of it
};

/// A whole number from `lowest` to `highest`.
[[nodiscard]] Check inRange(int lowest, int highest);

/// One of `words`, without a guess at what another may stand for: see oneOf().
[[nodiscard]] Check memberOf(const std::vector<std::string>& words);

/// One option of a command. Small, to be passed by value; lives as long as the CommandLine.
class Option {
 public:
  explicit Option(CLI::Option* option) : option_(option) {}

  Option& group(const std::string& name);  ///< the heading that the help lists it under
  Option& check(Check check);
  Option& required();
  Option& expected(int values);         ///< exactly so many
  Option& delimiter(char between);      ///< between values that are typed as one word
  Option& showDefault();                ///< the help shows what the variable holds now
  Option& excludes(Option other);       ///< only one of the two may be given
  Option& oneValueEach();               ///< what follows the value is not another one
  Option& typeName(const char* shown);  ///< what the help says that it takes

 private:
  CLI::Option* option_;
};

/// What an option can be read into.
template <typename T>
concept OptionValue =
    std::same_as<T, std::string> || std::same_as<T, std::vector<std::string>> || std::same_as<T, int> ||
    std::same_as<T, std::vector<int>> || std::same_as<T, std::int64_t> || std::same_as<T, std::uint64_t> ||
    std::same_as<T, double> || std::same_as<T, std::optional<double>> || std::same_as<T, std::vector<double>>;

/// A command, or the whole program as the root of all commands. Small, to be passed by value; lives as long
/// as the CommandLine. What is added refers to the variables that are given: they must live until it has been
/// parsed.
class Command {
 public:
  explicit Command(CLI::App* app) : app_(app) {}

  Command subcommand(const std::string& name, const std::string& description);
  void requireSubcommand();                ///< exactly one of its own must be named
  void onChosen(std::function<void()> f);  ///< called when the command line names this command and is right
  void footer(const std::string& text);    ///< ends its help

  /// "--name", or "NAME" for one that is found by its place. Throws when the name is taken.
  template <OptionValue T>
  Option option(const std::string& name, T& variable, const std::string& help);

  /// An option whose value goes to `take`.
  Option onOption(const std::string& name, const std::function<void(const std::string&)>& take,
                  const std::string& help);

  /// An option that takes any of some words, each of which stands for a value.
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

/// A command line that could not be understood.
struct Misread {
  std::string what;                         ///< the first thing that is wrong, in words
  std::string command;                      ///< "bench haptic ": the commands that were, a blank behind each
  std::vector<std::string> rest;            ///< words that nothing took
  std::vector<std::string> known_commands;  ///< that may stand behind `command`
  std::vector<std::string> known_options;   ///< of `command`, "--name" and "-n"
};

/// The commands and options of a program, and how its arguments are understood by them.
class CommandLine {
 public:
  /// With -h,--help for every command, and -V,--version, which shows `version`.
  CommandLine(const std::string& name, const std::string& description, const std::string& version);
  ~CommandLine();
  CommandLine(const CommandLine&) = delete;
  CommandLine& operator=(const CommandLine&) = delete;

  [[nodiscard]] Command root();

  /// Sets variables and calls what is to be called. `arguments` are those of main(), the program's name
  /// first. The text of the help or the version where that is asked for, else an empty one.
  [[nodiscard]] tl::expected<std::string, Misread> parse(const std::vector<std::string>& arguments);

 private:
  std::unique_ptr<CLI::App> app_;
};

}  // namespace fettle::app
