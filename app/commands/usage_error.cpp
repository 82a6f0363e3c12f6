#include "app/commands/usage_error.h"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "app/work/spelling.h"

namespace fettle::app {

// `--keep "$MARKS"` with MARKS unset would mean "no marks": the requested protection would be lost without a
// message. Only a title may be empty.
std::optional<engine::Error> emptyArgument(const std::vector<std::string>& arguments) {
  for (std::size_t i = 1; i < arguments.size(); ++i)
    if (arguments[i].empty() && !arguments[i - 1].ends_with("title"))
      return engine::Error{engine::ErrorKind::kInput, fmt::format("argument {} is empty", i),
                           arguments[i - 1], "is a shell variable unset?"};
  return std::nullopt;
}

engine::Error usageError(const Misread& misread, const std::string& help) {
  const auto refused = [&](std::string what, const std::string& meant) {
    return engine::Error{engine::ErrorKind::kInput, std::move(what), "",
                         meant.empty() ? help : fmt::format("{} {}", meant, help)};
  };
  const std::vector<std::string>& rest = misread.rest;
  // A word in the place of a command comes first: everything after it belongs to it.
  const auto word = std::find_if(rest.begin(), rest.end(), [](const auto& w) { return !w.starts_with("-"); });
  if (!misread.known_commands.empty() && word != rest.end())
    return refused(fmt::format("there is no command {}{}", misread.command, *word),
                   didYouMean(*word, misread.known_commands));
  // Then options: a misspelt one leaves the value of another missing, or its own value unused.
  for (const std::string& option : rest) {
    if (!option.starts_with("-") || option == "-") continue;
    const std::string name = option.substr(0, option.find('='));
    // It is a valid option, but before the command.
    if (!misread.command.empty() &&
        std::ranges::find(misread.known_options, name) != misread.known_options.end())
      return engine::Error{engine::ErrorKind::kInput,
                           fmt::format("{} is before the command that takes it", name), "",
                           fmt::format("put it after: fettle {}{}", misread.command, name)};
    return refused(fmt::format("there is no option {}", name),
                   didYouMean(name.starts_with("--") ? name : "-" + name, misread.known_options));
  }
  return refused(misread.what, "");
}

}  // namespace fettle::app
