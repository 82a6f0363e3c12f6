#include "app/reference/help_text.h"

#include <algorithm>

#include <fmt/format.h>

namespace fettle::app {

namespace {

constexpr std::size_t kWidth = 100;
constexpr std::size_t kColumn = 30;

std::string entry(const std::string& name, const std::string& text) {
  std::string line = "  " + name;
  // A name that reaches into the column of texts has a line of its own.
  if (line.size() + 2 > kColumn)
    line += "\n" + std::string(kColumn, ' ');
  else
    line.resize(kColumn, ' ');
  return line + wrapped(text, kWidth - kColumn, kColumn) + "\n";
}

// With a line for each word that has a meaning.
std::string entry(const Parameter& p) {
  std::string text = entry(signatureOf(p), describe(p));
  for (const Word& word : p.words)
    if (!word.text.empty())
      text += std::string(kColumn + 2, ' ') +
              wrapped(fmt::format("{}: {}", word.word, word.text), kWidth - kColumn - 4, kColumn + 4) + "\n";
  return text;
}

}  // namespace

std::string wrapped(const std::string& text, std::size_t width, std::size_t indent) {
  const std::string next_line = "\n" + std::string(indent, ' ');
  std::string lines;
  std::size_t used = 0;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t blank = std::min(text.find_first_of(" \n", at), text.size());
    const std::size_t length = blank - at;
    if (used > 0 && used + 1 + length > width) {
      lines += next_line;
      used = 0;
    } else if (used > 0) {
      lines += ' ';
      ++used;
    }
    lines.append(text, at, length);
    used += length;
    at = blank + 1;
    if (blank < text.size() && text[blank] == '\n') {
      lines += next_line;
      used = 0;
    }
  }
  return lines;
}

std::string helpText(const CommandTable& command) {
  std::string help = wrapped(command.summary, kWidth, 0) + "\n\nUsage: " + usageOf(command) + "\n";
  bool arguments = false;
  for (const Parameter& p : command.parameters) {
    if (!p.positional()) continue;
    if (!arguments) help += "\n";
    arguments = true;
    help += entry(p);
  }
  if (!command.commands.empty()) {
    help += "\nCommands:\n";
    for (const CommandTable& below : command.commands) help += entry(below.name, below.summary);
  }
  for (const std::string& group : groupsOf(command)) {
    help += fmt::format("\n{}:\n", group);
    for (const Parameter* p : inGroup(command, group)) help += entry(*p);
  }
  if (!command.notes.empty()) help += "\n" + wrapped(command.notes, kWidth, 0) + "\n";
  if (!command.examples.empty()) help += "\nExamples:\n";
  for (const Example& example : command.examples)
    help += fmt::format("  {}\n      {}\n", example.line, wrapped(example.text, kWidth - 6, 6));
  return help;
}

}  // namespace fettle::app
