#include "app/reference/man_page.h"

#include <algorithm>

#include <fmt/format.h>

namespace fettle::app {

namespace {

// Text of a page: a backslash, and a dot or quote at the beginning of a line, mean something to roff, and "-" is
// a hyphen unless it is escaped.
std::string roff(const std::string& text) {
  std::string out;
  bool begins = true;
  for (const char c : text) {
    if (begins && (c == '.' || c == '\'')) out += "\\&";
    if (c == '\\')
      out += "\\e";
    else if (c == '-')
      out += "\\-";
    else if (c == '\n')
      out += "\n.br\n";
    else
      out += c;
    begins = c == '\n';
  }
  return out;
}

std::string bold(const std::string& text) {
  return "\\fB" + roff(text) + "\\fR";
}

// "--window" and its value: names bold, values as they are.
std::string term(const Parameter& p) {
  const std::string signature = signatureOf(p);
  const std::size_t names = p.positional() || p.kind == ValueKind::kFlag
                                ? signature.size()
                                : signature.find(' ', signature.find(p.longName()));
  return bold(signature.substr(0, names)) + roff(signature.substr(std::min(names, signature.size())));
}

std::string manEntry(const Parameter& p) {
  std::string text = fmt::format(".TP\n{}\n{}.\n", term(p), roff(describe(p)));
  for (const Word& word : p.words)
    if (!word.text.empty()) text += fmt::format(".br\n{}: {}\n", bold(word.word), roff(word.text));
  return text;
}

std::string upper(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(),
                 [](char c) { return c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c; });
  return text;
}

std::string valuesOf(const CommandTable& root) {
  std::vector<bool> used(valueKinds().size() + 1, false);
  forEachCommand(root, [&](const CommandTable& command) {
    for (const Parameter& p : command.parameters) used.at(static_cast<std::size_t>(p.kind)) = true;
  });
  // Kinds that are shown alike, a file to read and one to write, share an entry.
  std::vector<std::pair<std::string_view, std::string>> entries;
  for (const ValueKindInfo& info : valueKinds()) {
    if (!used.at(static_cast<std::size_t>(info.kind)) || info.shown.empty()) continue;
    const auto same = std::find_if(entries.begin(), entries.end(),
                                   [&](const auto& entry) { return entry.first == info.shown; });
    if (same == entries.end())
      entries.emplace_back(info.shown, info.text);
    else
      same->second += fmt::format("; or {}", info.text);
  }
  std::string text = ".SH VALUES\n";
  for (const auto& [shown, meaning] : entries)
    text += fmt::format(".TP\n{}\n{}.\n", roff(std::string(shown)), roff(meaning));
  return text;
}

constexpr const char* kExitStatus =
    ".SH EXIT STATUS\n"
    "0: done. 1: failed, such as on a full disk, or ended by Ctrl\\-C. 2: the command line or an input is "
    "wrong.\n"
    "An error is one line on standard error: what, where, what to do; with \\fB\\-\\-json\\fR one JSON "
    "object.\n"
    "Output files appear whole or not at all.\n";

}  // namespace

std::string manName(const CommandTable& command) {
  std::string name = command.path;
  std::replace(name.begin(), name.end(), ' ', '-');
  return name;
}

std::string manPage(const CommandTable& command, const CommandTable& root, const ManVersion& version) {
  const std::string name = manName(command);
  std::string page = fmt::format(".TH \"{}\" 1 \"{}\" \"{}\" \"User Commands\"\n", upper(roff(name)),
                                 roff(version.date), roff(version.program));
  page += fmt::format(".SH NAME\n{} \\- {}\n", roff(name), roff(command.summary));
  page += fmt::format(".SH SYNOPSIS\n{}{}\n", bold(command.path),
                      roff(usageOf(command).substr(command.path.size())));
  const auto arguments = [&] {
    return std::any_of(command.parameters.begin(), command.parameters.end(),
                       [](const Parameter& p) { return p.positional(); });
  };
  page += fmt::format(".SH DESCRIPTION\n{}.\n", roff(command.summary));
  if (!command.notes.empty()) page += fmt::format(".PP\n{}\n", roff(command.notes));
  if (!command.commands.empty()) {
    page += ".SH COMMANDS\n";
    for (const CommandTable& below : command.commands)
      page += fmt::format(".TP\n\\fB{}\\fR(1)\n{}.\n", roff(manName(below)), roff(below.summary));
  }
  if (arguments()) page += ".SH ARGUMENTS\n";
  for (const Parameter& p : command.parameters)
    if (p.positional()) page += manEntry(p);
  for (const std::string& group : groupsOf(command)) {
    page += fmt::format(".SH {}\n", upper(group));
    for (const Parameter* p : inGroup(command, group)) page += manEntry(*p);
  }
  if (&command == &root) page += valuesOf(root);
  page += kExitStatus;
  if (!command.examples.empty()) page += ".SH EXAMPLES\n";
  for (const Example& example : command.examples)
    page += fmt::format(".TP\n{}\n{}.\n", bold(example.line), roff(example.text));
  if (&command != &root) page += fmt::format(".SH SEE ALSO\n\\fB{}\\fR(1)\n", roff(manName(root)));
  return page;
}

}  // namespace fettle::app
