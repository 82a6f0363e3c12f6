#include "app/commands/command_line.h"

#include <sstream>
#include <utility>

#include <CLI/CLI.hpp>

namespace fettle::app {

namespace {

Check checkOf(CLI::Validator validator) {
  const std::string shown = validator.get_description();
  return {[validator = std::move(validator)](const std::string& typed) { return validator(typed); }, shown};
}

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

}  // namespace

Check inRange(int lowest, int highest) {
  return checkOf(CLI::Range(lowest, highest));
}

Check memberOf(const std::vector<std::string>& words) {
  return checkOf(CLI::IsMember(words));
}

Option& Option::group(const std::string& name) {
  option_->group(name);
  return *this;
}

Option& Option::check(Check check) {
  option_->check(std::move(check.problem), std::move(check.shown));
  return *this;
}

Option& Option::required() {
  option_->required();
  return *this;
}

Option& Option::expected(int values) {
  option_->expected(values);
  return *this;
}

Option& Option::delimiter(char between) {
  option_->delimiter(between);
  return *this;
}

Option& Option::showDefault() {
  option_->capture_default_str();
  return *this;
}

Option& Option::excludes(Option other) {
  option_->excludes(other.option_);
  return *this;
}

Option& Option::oneValueEach() {
  option_->allow_extra_args(false);
  return *this;
}

Option& Option::typeName(const char* shown) {
  option_->type_name(shown);
  return *this;
}

Command Command::subcommand(const std::string& name, const std::string& description) {
  return Command(app_->add_subcommand(name, description));
}

void Command::requireSubcommand() {
  app_->require_subcommand(1);
}

void Command::onChosen(std::function<void()> f) {
  app_->callback(std::move(f));
}

void Command::footer(const std::string& text) {
  app_->footer(text);
}

template <OptionValue T>
Option Command::option(const std::string& name, T& variable, const std::string& help) {
  return Option(app_->add_option(name, variable, help));
}

template Option Command::option(const std::string&, std::string&, const std::string&);
template Option Command::option(const std::string&, std::vector<std::string>&, const std::string&);
template Option Command::option(const std::string&, int&, const std::string&);
template Option Command::option(const std::string&, std::vector<int>&, const std::string&);
template Option Command::option(const std::string&, std::int64_t&, const std::string&);
template Option Command::option(const std::string&, std::uint64_t&, const std::string&);
template Option Command::option(const std::string&, double&, const std::string&);
template Option Command::option(const std::string&, std::optional<double>&, const std::string&);
template Option Command::option(const std::string&, std::vector<double>&, const std::string&);

Option Command::onOption(const std::string& name, const std::function<void(const std::string&)>& take,
                         const std::string& help) {
  return Option(app_->add_option_function<std::string>(name, take, help));
}

Option Command::onNumbers(const std::string& name, const std::map<std::string, int>& words,
                          const std::function<void(const std::vector<int>&)>& take, const std::string& help) {
  CLI::Option* option = app_->add_option_function<std::vector<int>>(name, take, help);
  option->type_name("ENUM")->transform(CLI::CheckedTransformer(words));
  return Option(option);
}

Option Command::flag(const std::string& name, bool& variable, const std::string& help) {
  return Option(app_->add_flag(name, variable, help));
}

Option Command::onFlag(const std::string& name, std::function<void()> f, const std::string& help) {
  return Option(app_->add_flag_callback(name, std::move(f), help));
}

CommandLine::CommandLine(const std::string& name, const std::string& description, const std::string& version)
    : app_(std::make_unique<CLI::App>(description, name)) {
  app_->set_version_flag("-V,--version", version);
}

CommandLine::~CommandLine() = default;

Command CommandLine::root() {
  return Command(app_.get());
}

tl::expected<std::string, Misread> CommandLine::parse(const std::vector<std::string>& arguments) try {
  app_->parse(std::vector<std::string>(arguments.rbegin(), arguments.rend() - (arguments.empty() ? 0 : 1)));
  return std::string();
} catch (const CLI::ParseError& error) {
  // "fitler --help" and "bench hapitc --help" request the help of a command that does not exist, not that
  // of the program.
  const CLI::App* used = app_.get();
  while (!used->get_subcommands().empty()) used = used->get_subcommands().front();
  const bool takes_command = !used->get_subcommands([](const CLI::App*) { return true; }).empty();
  const auto rest = used->remaining();
  const bool misspelt = takes_command && !rest.empty() && !rest[0].starts_with("-");
  if (error.get_exit_code() != 0 || misspelt) return tl::unexpected(misreadOf(*app_, error.what()));
  std::ostringstream shown;  // --help and --version
  app_->exit(error, shown, shown);
  return shown.str();
}

}  // namespace fettle::app
