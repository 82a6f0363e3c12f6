#include "app/commands/call.h"

#include <exception>
#include <new>

#include "app/commands/usage_error.h"
#include "app/reference/reference_page.h"

namespace fettle::app {

engine::Result<Report> callCommand(const std::vector<std::string>& arguments,
                                   const std::function<void(Command, Chosen&)>& add_commands,
                                   const std::string& help, engine::JobControl& job) try {
  std::vector<std::string> words{"fettle"};
  words.insert(words.end(), arguments.begin(), arguments.end());
  if (auto error = emptyArgument(words)) return tl::unexpected(*std::move(error));
  CommandLine line("fettle", "", "");
  line.root().requireSubcommand();
  Chosen chosen;
  chosen.arguments = words;
  add_commands(line.root(), chosen);
  const auto text = line.parse(words);
  if (!text) return tl::unexpected(usageError(text.error(), help));
  if (!chosen.run) return engine::inputError("no command is named", "", help);
  return chosen.run(job);
} catch (const std::bad_alloc&) {
  return engine::failure("memory ran out", "", "close other programs or take a smaller scan");
} catch (const std::exception& error) {
  return engine::failure(error.what(), "", "this should not happen, please report it");
}

Report commandTables(const std::function<void(Command, Chosen&)>& add_commands) {
  CommandLine line("fettle", "", "");
  Chosen chosen;
  add_commands(line.root(), chosen);
  return tableReport(line.root().table());
}

}  // namespace fettle::app
