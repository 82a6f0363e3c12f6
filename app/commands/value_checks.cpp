#include "app/commands/value_checks.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "app/work/spelling.h"
#include "app/work/streams.h"

namespace fettle::app {

namespace {

std::string outside(const std::string& typed, Range range) {
  // Parsed like options of this type; NaN fails both comparisons.
  char* end = nullptr;
  const auto value = static_cast<double>(std::strtold(typed.c_str(), &end));
  if (!typed.empty() && end == typed.c_str() + typed.size() && value >= range.lowest &&
      value <= range.highest)
    return "";
  if (std::isinf(range.highest))
    return fmt::format("{} is not a number of at least {:g}", typed, range.lowest);
  if (std::isinf(range.lowest))
    return fmt::format("{} is not a number of at most {:g}", typed, range.highest);
  return fmt::format("{} is not a number from {:g} to {:g}", typed, range.lowest, range.highest);
}

std::string noneOf(const std::string& typed, const std::vector<std::string>& words) {
  if (std::find(words.begin(), words.end(), typed) != words.end()) return "";
  const std::string meant = didYouMean(typed, words);
  return fmt::format("{} is not one of {}{}{}", typed, fmt::join(words, ", "), meant.empty() ? "" : "; ",
                     meant);
}

}  // namespace

std::vector<std::function<std::string(const std::string&)>> problemsOf(const Parameter& p) {
  std::vector<std::function<std::string(const std::string&)>> problems;
  if (p.range)
    problems.emplace_back([range = *p.range](const std::string& typed) { return outside(typed, range); });
  if (!p.words.empty())
    problems.emplace_back([words = wordsOf(p)](const std::string& typed) { return noneOf(typed, words); });
  if (p.kind == ValueKind::kFile || p.kind == ValueKind::kNewFile)
    problems.emplace_back([](const std::string& typed) {
      return isStream(typed)
                 ? std::string(
                       "takes no -, standard input or standard output: name a file, ./- for one of "
                       "that name")
                 : std::string();
    });
  // A folder of that name would conflict with every command that writes to standard output.
  if (p.kind == ValueKind::kFolder)
    problems.emplace_back([](const std::string& typed) {
      return isStream(typed)
                 ? std::string("- is standard output, and no folder: name a folder, ./- for one of that name")
                 : std::string();
    });
  if (p.problem) problems.push_back(p.problem);
  return problems;
}

}  // namespace fettle::app
