#include "app/reference/reference_page.h"

#include <cmath>

#include <fmt/format.h>

namespace fettle::app {

namespace {

// In a cell of a table a bar ends the cell, and a line is the row.
std::string cell(const std::string& text) {
  std::string out;
  for (const char c : text) {
    if (c == '|' || c == '<' || c == '*' || c == '_') out += '\\';
    out += c == '\n' ? std::string("<br>") : std::string(1, c);
  }
  return out;
}

// In a code span nothing is escaped but the bar of the table.
std::string code(const std::string& text) {
  std::string out = "`";
  for (const char c : text) out += c == '|' ? std::string("\\|") : std::string(1, c);
  return out + "`";
}

void addRow(std::string& page, const Parameter& p) {
  std::string text = p.text;
  for (const Word& word : p.words)
    if (!word.text.empty()) text += fmt::format("\n{}: {}", word.word, word.text);
  page += fmt::format("| {} | {} | {} |\n", code(signatureOf(p)), cell(text), cell(factsOf(p)));
}

constexpr const char* kTableHead = "| parameter | does | range, default |\n|---|---|---|\n";

// A number as a number; null where nothing or words stand for it.
Report defaultOf(const Parameter& p) {
  const std::string standard = p.standard();
  if (standard.empty() || !p.otherwise.empty()) return {};
  const bool number = p.kind == ValueKind::kWhole || p.kind == ValueKind::kNumber;
  return number && !p.several() ? Report::parse(standard, nullptr, false) : Report(standard);
}

Report reportOf(const Parameter& p) {
  Report row{{"name", p.longName()},
             {"short", p.shortName().empty() ? Report() : Report(p.shortName())},
             {"positional", p.positional()},
             {"kind", infoOf(p.kind).word},
             {"values", p.several() ? (p.values > 1 ? Report(p.values) : Report("any")) : Report(1)},
             {"required", p.required},
             {"unit", p.unit.empty() ? Report() : Report(p.unit)},
             {"range", Report()},
             {"words", Report::array()},
             {"proposed", p.proposed},
             {"default", defaultOf(p)},
             {"otherwise", p.otherwise.empty() ? Report() : Report(p.otherwise)},
             {"between", p.between == '\0' ? Report() : Report(std::string(1, p.between))},
             {"excludes", p.excludes},
             {"group", p.group.empty() ? Report() : Report(p.group)},
             {"text", p.text}};
  const auto bound = [](double v) { return std::isinf(v) ? Report() : Report(v); };
  if (p.range) row["range"] = {bound(p.range->lowest), bound(p.range->highest)};
  for (const Word& word : p.words) row["words"].push_back({{"word", word.word}, {"text", word.text}});
  return row;
}

Report reportOf(const CommandTable& command) {
  Report report{{"name", command.name},       {"path", command.path},          {"summary", command.summary},
                {"notes", command.notes},     {"parameters", Report::array()}, {"examples", Report::array()},
                {"commands", Report::array()}};
  for (const Parameter& p : command.parameters) report["parameters"].push_back(reportOf(p));
  for (const Example& e : command.examples)
    report["examples"].push_back({{"line", e.line}, {"text", e.text}});
  for (const CommandTable& below : command.commands) report["commands"].push_back(reportOf(below));
  return report;
}

}  // namespace

std::string referencePage(const CommandTable& root) {
  std::string page =
      "# Reference of all commands\n\nMade by `fettle reference`; the same text is in `fettle help "
      "COMMAND`.\n";
  forEachCommand(root, [&](const CommandTable& command) {
    page += fmt::format("\n## {}\n\n{}.\n\n    {}\n", command.path, command.summary, usageOf(command));
    std::string rows;
    for (const Parameter& p : command.parameters)
      if (p.positional()) addRow(rows, p);
    if (!rows.empty()) page += fmt::format("\n{}{}", kTableHead, rows);
    for (const std::string& group : groupsOf(command)) {
      // The rows of every command stand once, with the program.
      if (group == kReportGroup && &command != &root) continue;
      page += fmt::format("\n**{}**\n\n{}", group, kTableHead);
      for (const Parameter* p : inGroup(command, group)) addRow(page, *p);
    }
    if (!command.notes.empty()) page += fmt::format("\n{}\n", cell(command.notes));
    for (const Example& example : command.examples)
      page += fmt::format("\n{}:\n\n    {}\n", example.text, example.line);
  });
  return page;
}

Report tableReport(const CommandTable& root) {
  Report report{{"schema", 1}, {"kinds", Report::array()}};
  for (const ValueKindInfo& info : valueKinds())
    report["kinds"].push_back({{"kind", info.word}, {"shown", info.shown}, {"text", info.text}});
  report["program"] = reportOf(root);
  return report;
}

}  // namespace fettle::app
