#include "app/reference/command_table.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <type_traits>

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace fettle::app {

namespace {

constexpr std::array<ValueKindInfo, 19> kValueKinds{{
    {ValueKind::kByTarget, "", "", ""},
    {ValueKind::kFlag, "flag", "", "nothing: it is on when it is given"},
    {ValueKind::kText, "text", "TEXT", "any text"},
    {ValueKind::kWord, "word", "WORD", "one of the words that its description names"},
    {ValueKind::kWhole, "whole", "N", "a whole number"},
    {ValueKind::kNumber, "number", "NUMBER", "a number"},
    {ValueKind::kLength, "length", "LENGTH",
     "a number in the scan's own unit, or with one: 0.02, 20um, 0.5mm; nm, um, mm, cm, m, km, in, ft, ftUS"},
    {ValueKind::kSize, "size", "WIDTHxHEIGHT", "two whole numbers, as 1280x800"},
    {ValueKind::kFormat, "format", "EXTENSION", "a file format by its extension, with or without the dot"},
    {ValueKind::kInput, "input", "FILE|-", "a file to read, or - for standard input"},
    {ValueKind::kOutput, "output", "FILE|-", "a file to write, or - for standard output"},
    {ValueKind::kFile, "file", "FILE", "a file to read"},
    {ValueKind::kMarks, "marks", "FILE", "a picture of marks to read, or - for standard input"},
    {ValueKind::kLines, "lines", "FILE", "a file of edge lines to read, or - for standard input"},
    {ValueKind::kNewFile, "new_file", "FILE", "a file to write; it appears whole or not at all"},
    {ValueKind::kNewScan, "new_scan", "FILE", "a scan to write, format by extension"},
    {ValueKind::kNewMarks, "new_marks", "FILE",
     "a picture of marks to write: png, tif; or - for standard output"},
    {ValueKind::kNewLines, "new_lines", "FILE",
     "a file of edge lines to write: csv, geojson, gpkg, dxf; or - for standard output"},
    {ValueKind::kFolder, "folder", "FOLDER", "a folder"},
}};

template <typename T>
constexpr bool kIsList = std::is_same_v<T, std::vector<std::string>*> ||
                         std::is_same_v<T, std::vector<int>*> || std::is_same_v<T, std::vector<double>*> ||
                         std::is_same_v<T, std::function<void(const std::vector<std::string>&)>>;

std::string rangeText(const Parameter& p) {
  const std::string unit = p.unit.empty() ? "" : " " + p.unit;
  if (!p.range) return p.unit.empty() ? "" : "in " + p.unit;
  const auto [lowest, highest] = *p.range;
  constexpr double kMost = std::numeric_limits<double>::max(), kLeast = std::numeric_limits<double>::min();
  if (highest == kMost && lowest == kLeast) return fmt::format("above 0{}", unit);
  if (std::isinf(highest) || highest == kMost) return fmt::format("at least {:g}{}", lowest, unit);
  if (std::isinf(lowest) || lowest == -kMost) return fmt::format("at most {:g}{}", highest, unit);
  // Whole numbers in full: {:g} would write 31623 x 31623 as 1e+09.
  const auto shown = [](double v) {
    return std::abs(v) < 1e9 && v == std::floor(v) ? fmt::format("{:.0f}", v) : fmt::format("{:g}", v);
  };
  return fmt::format("{} to {}{}", shown(lowest), shown(highest), unit);
}

constexpr const char* kOptions = "Options";

}  // namespace

std::span<const ValueKindInfo> valueKinds() {
  return std::span(kValueKinds).subspan(1);
}

const ValueKindInfo& infoOf(ValueKind kind) {
  return kValueKinds.at(static_cast<std::size_t>(kind));
}

bool Parameter::several() const {
  return std::visit([](const auto& target) { return kIsList<std::decay_t<decltype(target)>>; }, to);
}

std::string Parameter::longName() const {
  return name.substr(name.find(',') + 1);
}

std::string Parameter::shortName() const {
  const std::size_t comma = name.find(',');
  return comma == std::string::npos ? "" : name.substr(0, comma);
}

std::string Parameter::standard() const {
  // Its variable has the value of this run by the time that a reference is written.
  if (required) return "";
  const std::string separator(1, between == '\0' ? ' ' : between);
  return std::visit(
      [&](const auto& target) -> std::string {
        using T = std::decay_t<decltype(target)>;
        if constexpr (std::is_same_v<T, std::string*>) {
          return *target;
        } else if constexpr (std::is_same_v<T, double*>) {
          return fmt::format("{:g}", *target);
        } else if constexpr (std::is_same_v<T, int*> || std::is_same_v<T, std::int64_t*> ||
                             std::is_same_v<T, std::uint64_t*>) {
          return fmt::format("{}", *target);
        } else if constexpr (std::is_same_v<T, std::optional<double>*>) {
          return *target ? fmt::format("{:g}", **target) : "";
        } else if constexpr (std::is_same_v<T, std::vector<double>*> ||
                             std::is_same_v<T, std::vector<int>*> ||
                             std::is_same_v<T, std::vector<std::string>*>) {
          return fmt::format("{}", fmt::join(*target, separator));
        } else {
          return "";
        }
      },
      to);
}

std::vector<std::string> groupsOf(const CommandTable& command) {
  std::vector<std::string> groups{kOptions};
  for (const Parameter& p : command.parameters)
    if (!p.positional() && std::find(groups.begin(), groups.end(), p.group) == groups.end() &&
        !p.group.empty())
      groups.push_back(p.group);
  // The rows of every command come first, since it is made with them.
  const auto common = std::find(groups.begin(), groups.end(), kReportGroup);
  if (common != groups.end()) std::rotate(common, common + 1, groups.end());
  const bool plain = std::any_of(command.parameters.begin(), command.parameters.end(),
                                 [](const Parameter& p) { return !p.positional() && p.group.empty(); });
  if (!plain) groups.erase(groups.begin());
  return groups;
}

std::vector<const Parameter*> inGroup(const CommandTable& command, const std::string& group) {
  std::vector<const Parameter*> rows;
  for (const Parameter& p : command.parameters)
    if (!p.positional() && (p.group.empty() ? kOptions : p.group) == group) rows.push_back(&p);
  return rows;
}

std::string signatureOf(const Parameter& p) {
  if (p.positional()) return !p.shown.empty() ? p.shown : p.several() ? p.name + "..." : p.name;
  const std::string_view shown = infoOf(p.kind).shown;
  std::string names = p.shortName().empty() ? p.longName() : p.shortName() + ", " + p.longName();
  if (!p.shown.empty()) return names + " " + p.shown;
  if (shown.empty()) return names;
  std::string values(shown);
  if (p.several()) {
    const std::string between(1, p.between == '\0' ? ' ' : p.between);
    if (p.values > 1)
      for (int k = 1; k < p.values; ++k) values += between + std::string(shown);
    else if (!p.one_word || p.between != '\0')
      values += p.between == '\0' ? "..." : fmt::format("[{}{}...]", between, shown);
  }
  return names + " " + values;
}

std::string usageOf(const CommandTable& command) {
  std::string usage = command.path;
  usage += " [OPTIONS]";
  if (!command.commands.empty()) return usage + " COMMAND";
  for (const Parameter& p : command.parameters)
    if (p.positional())
      usage += p.required ? fmt::format(" {}", signatureOf(p)) : fmt::format(" [{}]", signatureOf(p));
  return usage;
}

std::vector<std::string> wordsOf(const Parameter& p) {
  std::vector<std::string> words;
  words.reserve(p.words.size());
  for (const Word& word : p.words) words.push_back(word.word);
  return words;
}

std::vector<std::string> offeredBy(const Parameter& p) {
  return p.words.empty() ? p.proposed : wordsOf(p);
}

std::string factsOf(const Parameter& p) {
  std::vector<std::string> facts;
  if (!p.words.empty()) facts.push_back(fmt::format("{}", fmt::join(wordsOf(p), ", ")));
  if (const std::string range = rangeText(p); !range.empty()) facts.push_back(range);
  if (p.kind == ValueKind::kLength)
    facts.emplace_back(p.unit.empty() ? "in the scan's unit, or as 20um" : "or as 20um");
  else if (p.unit == kMillimetres)
    facts.emplace_back("or as 20um");
  if (p.several() && p.one_word && p.between == '\0') facts.emplace_back("may be repeated");
  if (!p.otherwise.empty())
    facts.push_back("without it: " + p.otherwise);
  else if (const std::string standard = p.standard(); !standard.empty())
    facts.push_back("default " + standard);
  if (p.required && !p.positional()) facts.emplace_back("required");
  if (!p.excludes.empty()) facts.push_back(fmt::format("not with {}", fmt::join(p.excludes, ", ")));
  return fmt::format("{}", fmt::join(facts, "; "));
}

std::string describe(const Parameter& p) {
  const std::string facts = factsOf(p);
  return facts.empty() ? p.text : fmt::format("{} ({})", p.text, facts);
}

void forEachCommand(const CommandTable& command, const std::function<void(const CommandTable&)>& f) {
  f(command);
  for (const CommandTable& below : command.commands) forEachCommand(below, f);
}

}  // namespace fettle::app
