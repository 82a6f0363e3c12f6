#include "app/commands/command_line.h"

#include <algorithm>
#include <string_view>
#include <type_traits>
#include <utility>
#include <variant>

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include "app/commands/value_checks.h"
#include "app/reference/help_text.h"
#include "app/work/typed_lengths.h"

namespace fettle::app {

namespace {

Misread misreadOf(const CLI::App& root, const std::string& what) {
  Misread misread;
  misread.what = what;
  misread.rest = root.remaining(true);
  const CLI::App* used = &root;
  while (!used->get_subcommands().empty()) {
    used = used->get_subcommands().front();
    misread.command += used->get_name() + " ";
  }
  for (const CLI::App* command : used->get_subcommands([](const CLI::App*) { return true; }))
    misread.known_commands.push_back(command->get_name());
  for (const CLI::Option* option : used->get_options()) {
    for (const std::string& name : option->get_lnames()) misread.known_options.push_back("--" + name);
    for (const std::string& name : option->get_snames())
      misread.known_options.push_back(std::string("-").append(name));
  }
  return misread;
}

// The kind of a row that names none.
ValueKind kindOf(const Parameter& p) {
  if (p.kind != ValueKind::kByTarget) return p.kind;
  if (!p.words.empty()) return ValueKind::kWord;
  return std::visit(
      [](const auto& target) {
        using T = std::decay_t<decltype(target)>;
        if constexpr (std::is_same_v<T, std::monostate> || std::is_same_v<T, bool*> ||
                      std::is_same_v<T, std::function<void()>>)
          return ValueKind::kFlag;
        else if constexpr (std::is_same_v<T, double*> || std::is_same_v<T, std::optional<double>*> ||
                           std::is_same_v<T, std::vector<double>*>)
          return ValueKind::kNumber;
        else if constexpr (std::is_same_v<T, int*> || std::is_same_v<T, std::vector<int>*> ||
                           std::is_same_v<T, std::int64_t*> || std::is_same_v<T, std::uint64_t*>)
          return ValueKind::kWhole;
        else
          return ValueKind::kText;
      },
      p.to);
}

CLI::Option* optionFor(CLI::App& app, const Parameter& p) {
  return std::visit(
      [&](const auto& target) -> CLI::Option* {
        using T = std::decay_t<decltype(target)>;
        if constexpr (std::is_same_v<T, std::monostate>)
          return nullptr;
        else if constexpr (std::is_same_v<T, bool*>)
          return app.add_flag(p.name, *target);
        else if constexpr (std::is_same_v<T, std::function<void()>>)
          return app.add_flag_callback(p.name, target);
        else if constexpr (std::is_same_v<T, std::function<void(const std::string&)>>)
          return app.add_option_function<std::string>(p.name, target);
        else if constexpr (std::is_same_v<T, std::function<void(const std::vector<std::string>&)>>)
          return app.add_option_function<std::vector<std::string>>(p.name, target);
        else
          return app.add_option(p.name, *target);
      },
      p.to);
}

// A length or place in millimetres with another unit behind it, as the number that a row of millimetres takes; a plain number stays as it is typed.
// What is wrong with it, or an empty text.
std::string inMillimetres(std::string& typed) {
  const auto length = typedLengthOf(typed);
  if (!length || length->unit.empty()) return {};  // the parser says what is no number
  if (!length->unit_mm) return lengthProblem(typed);
  typed = fmt::format("{}", length->value * *length->unit_mm);
  return {};
}

void addToParser(CLI::App& app, const Parameter& p) {
  CLI::Option* option = optionFor(app, p);
  if (option == nullptr) return;
  option->required(p.required);
  option->type_name(std::string(infoOf(p.kind).shown));  // in its messages
  if (p.between != '\0') option->delimiter(p.between);
  if (p.values > 1) option->expected(p.values);
  // Of values in one word the words after it are others: "--crop 0,0,5,5 IN OUT", "--only height SCAN".
  if (p.one_word || p.between != '\0') option->allow_extra_args(false);
  for (const std::string& other : p.excludes) option->excludes(app.get_option(other));
  if (p.kind == ValueKind::kNumber && p.unit == kMillimetres)
    option->transform(CLI::Validator(inMillimetres, ""));
  for (const auto& problem : problemsOf(p)) option->check(problem, "");
}

}  // namespace

Command Command::subcommand(const std::string& name, const std::string& summary) {
  CommandTable& below = table_->commands.emplace_back();
  below.path = table_->path + " " + name;
  below.name = name;
  below.summary = summary;
  Command command(app_->add_subcommand(name, summary), &below);
  command.add({{.name = "-h,--help", .text = "Show this, and end"}}, kReportGroup);
  return command;
}

void Command::requireSubcommand() {
  app_->require_subcommand(1);
}

void Command::onChosen(std::function<void()> f) {
  app_->callback(std::move(f));
}

void Command::notes(const std::string& text) {
  table_->notes = text;
}

void Command::examples(std::initializer_list<Example> examples) {
  table_->examples = examples;
}

void Command::add(std::initializer_list<Parameter> rows, const std::string& group) {
  for (const Parameter& row : rows) {
    Parameter p = row;
    p.kind = kindOf(p);
    if (p.group.empty()) p.group = group;
    addToParser(*app_, p);
    table_->parameters.push_back(std::move(p));
  }
}

namespace {

bool isCalled(const Parameter& p, std::string_view word) {
  return word == p.longName() || (!word.empty() && word == p.shortName());
}

// What is wrong with the number of values of an option, in the words of its row; empty where no row has the name.
std::string countProblem(const CommandTable& table, const std::string& what) {
  // "--crop: ..." or "Could not convert: --crop = 1,2,3,IN": of too few values the word behind them was taken for one.
  const std::size_t named = what.find("--");
  const std::string option = named == std::string::npos
                                 ? what.substr(0, what.find(':'))
                                 : what.substr(named, what.find_first_of(": ", named) - named);
  for (const Parameter& p : table.parameters) {
    if (!isCalled(p, option)) continue;
    if (p.values > 1) return option + " takes " + p.shown;
    if (what.find("At Most 1") != std::string::npos) return option + " is given more than once";
  }
  return {};
}

// Of an option that takes a fixed number of values the values of two would be taken together.
std::string givenTwice(const CommandTable& table, const std::vector<std::string>& arguments) {
  for (const Parameter& p : table.parameters) {
    if (p.values <= 1 && !(p.one_word && p.between != '\0')) continue;
    const auto names = [&p](const std::string& argument) {
      return argument.starts_with("--") && isCalled(p, argument.substr(0, argument.find('=')));
    };
    if (std::ranges::count_if(arguments, names) > 1) return p.longName() + " is given more than once";
  }
  return {};
}

}  // namespace

CommandLine::CommandLine(const std::string& name, const std::string& description, const std::string& version)
    : app_(std::make_unique<CLI::App>(description, name)), version_(version) {
  table_.path = table_.name = name;
  table_.summary = description;
  app_->set_version_flag("-V,--version", version);
  root().add({{.name = "-h,--help", .text = "Show this, and end"},
              {.name = "-V,--version", .text = "Show the version, and end"}},
             kReportGroup);
}

CommandLine::~CommandLine() = default;

Command CommandLine::root() {
  return {app_.get(), &table_};
}

std::pair<const CLI::App*, const CommandTable*> CommandLine::usedTable() const {
  const CLI::App* used = app_.get();
  const CommandTable* table = &table_;
  while (!used->get_subcommands().empty()) {
    used = used->get_subcommands().front();
    table = &*std::find_if(table->commands.begin(), table->commands.end(),
                           [&](const CommandTable& below) { return below.name == used->get_name(); });
  }
  return {used, table};
}

tl::expected<std::string, Misread> CommandLine::parse(const std::vector<std::string>& arguments) try {
  app_->parse(std::vector<std::string>(arguments.rbegin(), arguments.rend() - (arguments.empty() ? 0 : 1)));
  if (const std::string problem = givenTwice(*usedTable().second, arguments); !problem.empty())
    return tl::unexpected(misreadOf(*app_, problem));
  return std::string();
} catch (const CLI::ParseError& error) {
  // "fitler --help" and "bench hapitc --help" request the help of a command that does not exist, not that
  // of the program.
  const auto [used, table] = usedTable();
  const bool takes_command = !used->get_subcommands([](const CLI::App*) { return true; }).empty();
  const auto rest = used->remaining();
  const bool misspelt = takes_command && !rest.empty() && !rest[0].starts_with("-");
  if (error.get_exit_code() != 0 || misspelt) {
    std::string what;
    if (dynamic_cast<const CLI::ArgumentMismatch*>(&error) != nullptr ||
        dynamic_cast<const CLI::ConversionError*>(&error) != nullptr)
      what = countProblem(*table, error.what());
    return tl::unexpected(misreadOf(*app_, what.empty() ? error.what() : what));
  }
  if (dynamic_cast<const CLI::CallForVersion*>(&error) != nullptr) return version_ + "\n";
  return helpText(*table);
}

}  // namespace fettle::app
