#include "app/commands/shards/plan.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <string_view>

#include <fmt/format.h>

#include "app/terminal.h"

namespace fettle::app {

std::vector<std::string> shardArguments(const std::vector<std::string>& arguments) {
  constexpr std::array<std::string_view, 4> kFlags{"--json", "-q", "--quiet", "--again"};
  constexpr std::array<std::string_view, 2> kWithValue{"--shards", "--result"};
  std::vector<std::string> kept;
  bool planned = false;
  for (std::size_t i = 1; i < arguments.size(); ++i) {
    const std::string_view word = arguments[i];
    if (!planned && word == "plan") {
      planned = true;
      continue;
    }
    if (std::ranges::find(kFlags, word) != kFlags.end()) continue;
    if (std::ranges::find(kWithValue, word.substr(0, word.find('='))) != kWithValue.end()) {
      if (word.find('=') == std::string_view::npos) ++i;
      continue;
    }
    kept.emplace_back(word);
  }
  return kept;
}

void printPlan(const Report& report) {
  std::string command = "fettle";
  for (const Report& word : report["arguments"]) (command += ' ') += word.get<std::string>();
  fmt::print("{} shards of {} x {} samples, each with {} rows around it\n", report["shards"].get<int>(),
             report["width"].get<int>(), report["height"].get<int>(), report["halo"].get<int>());
  fmt::print("about {} and {} MB of memory for each on this machine\n\n",
             durationText(report["seconds_per_shard"].get<double>()),
             report["memory_per_shard"].get<std::uint64_t>() / 1000000);
  fmt::print("    {} --shard K/{}\n    fettle gather {}\n", command, report["shards"].get<int>(),
             report["out"].get<std::string>());
}

void addPlan(Command root, Chosen& chosen) {
  Command plan = root.subcommand("plan", "Prepare work on one scan that several processes or machines share");
  plan.requireSubcommand();
  addPlanFilter(plan, chosen);
  addPlanConvert(plan, chosen);
}

}  // namespace fettle::app
