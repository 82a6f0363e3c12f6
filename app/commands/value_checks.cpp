#include "app/commands/value_checks.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <limits>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "app/work/spelling.h"
#include "app/work/streams.h"

namespace fettle::app {

namespace {

// The number of an option as its parser reads it; NaN where the text is none.
double numberOf(const std::string& typed, bool whole) {
  char* end = nullptr;
  const auto value = whole ? static_cast<double>(std::strtoll(typed.c_str(), &end, 0))
                           : static_cast<double>(std::strtold(typed.c_str(), &end));
  return !typed.empty() && end == typed.c_str() + typed.size() ? value
                                                               : std::numeric_limits<double>::quiet_NaN();
}

std::string outside(const std::string& typed, Range range, bool whole) {
  const double value = numberOf(typed, whole);  // NaN fails both comparisons
  if (value >= range.lowest && value <= range.highest) return "";
  const char* number = whole ? "whole number" : "number";
  if (std::isinf(range.highest))
    return fmt::format("{} is not a {} of at least {:g}", typed, number, range.lowest);
  if (std::isinf(range.lowest))
    return fmt::format("{} is not a {} of at most {:g}", typed, number, range.highest);
  return fmt::format("{} is not a {} from {} to {}", typed, number, range.lowest, range.highest);
}

std::string noneOf(const std::string& typed, const std::vector<std::string>& words) {
  if (std::find(words.begin(), words.end(), typed) != words.end()) return "";
  const std::string meant = didYouMean(typed, words);
  return fmt::format("{} is not one of {}{}{}", typed, fmt::join(words, ", "), meant.empty() ? "" : "; ",
                     meant);
}

}  // namespace

std::string streamProblem(const std::string& typed) {
  if (!isStream(typed)) return {};
  return "takes no -, standard input or standard output: name a file, ./- for one of that name";
}

std::vector<std::function<std::string(const std::string&)>> problemsOf(const Parameter& p) {
  std::vector<std::function<std::string(const std::string&)>> problems;
  if (p.range)
    problems.emplace_back([range = *p.range, whole = p.kind == ValueKind::kWhole](const std::string& typed) {
      return outside(typed, range, whole);
    });
  // Text may go on behind its first word.
  if (!p.words.empty() && p.kind != ValueKind::kText)
    problems.emplace_back([words = wordsOf(p)](const std::string& typed) { return noneOf(typed, words); });
  constexpr std::array kFiles{ValueKind::kFile, ValueKind::kNewFile, ValueKind::kNewScan};
  if (std::ranges::find(kFiles, p.kind) != kFiles.end()) problems.emplace_back(streamProblem);
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
