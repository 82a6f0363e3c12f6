#include "app/commands/shards/plan.h"

#include <algorithm>
#include <cstdint>

#include <fmt/format.h>

#include "app/commands/shell_word.h"
#include "app/terminal.h"

namespace fettle::app {

std::vector<std::string> shardArguments(const std::vector<std::string>& arguments) {
  std::vector<std::string> kept =
      wordsWithout(arguments, {"--json", "-q", "--quiet", "--again"}, {"--shards", "--result"});
  // The program's name, and the command that is planned.
  if (!kept.empty()) kept.erase(kept.begin());
  if (const auto plan = std::ranges::find(kept, "plan"); plan != kept.end()) kept.erase(plan);
  return kept;
}

std::vector<std::string> shardWords(const std::string& command, const std::vector<std::string>& arguments,
                                    int threads) {
  // Shards of a conversion have no such option.
  if (command != "filter") return arguments;
  std::vector<std::string> words = wordsWithout(arguments, {}, {"--threads"});
  words.emplace_back("--threads");
  words.push_back(std::to_string(threads));
  return words;
}

void printPlan(const Report& report) {
  fmt::print("{} shards of {} x {} samples, each with {} rows around it\n", report["shards"].get<int>(),
             report["width"].get<int>(), report["height"].get<int>(), report["halo"].get<int>());
  const int threads = report["threads"].get<int>();
  const std::string command = fettleCommand(shardWords(
      report["command"].get<std::string>(), report["arguments"].get<std::vector<std::string>>(), threads));
  fmt::print("about {} and {} MB of memory for each on this machine, with {} thread{}\n\n",
             durationText(report["seconds_per_shard"].get<double>()),
             report["memory_per_shard"].get<std::uint64_t>() / 1000000, threads, threads == 1 ? "" : "s");
  fmt::print("    {} --shard K/{}\n    fettle gather {}\n", command, report["shards"].get<int>(),
             quotedWord(report["out"].get<std::string>()));
}

void addPlan(Command root, Chosen& chosen) {
  Command plan = root.subcommand("plan", "Prepare work on one scan that several processes or machines share");
  plan.requireSubcommand();
  addPlanFilter(plan, chosen);
  addPlanConvert(plan, chosen);
}

}  // namespace fettle::app
