#include "app/reference/completion.h"

#include <algorithm>

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace fettle::app {

namespace {

enum class Completes : std::uint8_t { kNothing, kWords, kFiles, kFolders };

Completes completes(const Parameter& p) {
  if (!offeredBy(p).empty()) return Completes::kWords;
  switch (p.kind) {
    case ValueKind::kInput:
    case ValueKind::kOutput:
    case ValueKind::kFile:
    case ValueKind::kMarks:
    case ValueKind::kLines:
    case ValueKind::kNewFile:
    case ValueKind::kNewScan:
    case ValueKind::kNewMarks:
    case ValueKind::kNewLines:
      return Completes::kFiles;
    case ValueKind::kFolder:
      return Completes::kFolders;
    default:
      return Completes::kNothing;
  }
}

std::vector<std::string> namesOf(const Parameter& p) {
  std::vector<std::string> names{p.longName()};
  if (!p.shortName().empty()) names.push_back(p.shortName());
  return names;
}

std::vector<std::string> commandNames(const CommandTable& command) {
  std::vector<std::string> names;
  names.reserve(command.commands.size());
  for (const CommandTable& below : command.commands) names.push_back(below.name);
  return names;
}

std::vector<std::string> optionNames(const CommandTable& command) {
  std::vector<std::string> names;
  for (const Parameter& p : command.parameters)
    if (!p.positional())
      for (const std::string& name : namesOf(p)) names.push_back(name);
  return names;
}

// "fettle help" takes the words of a command's path, as "fettle" does: "fettle help bench haptic".
bool takesAPath(const CommandTable& command) {
  return command.path == "fettle help";
}

// For '...' in a shell.
std::string inQuotes(const std::string& text) {
  std::string out = "'";
  for (const char c : text) out += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return out + "'";
}

// What a command takes is listed by path; the function finds the path in the words typed so far.
std::string bashScript(const CommandTable& root) {
  std::string commands, options, values, words;
  forEachCommand(root, [&](const CommandTable& command) {
    if (!command.commands.empty())
      commands += fmt::format("    [{}]={}\n", inQuotes(command.path),
                              inQuotes(fmt::format("{}", fmt::join(commandNames(command), " "))));
    options += fmt::format("    [{}]={}\n", inQuotes(command.path),
                           inQuotes(fmt::format("{}", fmt::join(optionNames(command), " "))));
    for (const Parameter& p : command.parameters) {
      if (p.positional() && !offeredBy(p).empty())
        words += fmt::format("    [{}]={}\n", inQuotes(command.path),
                             inQuotes(fmt::format("{}", fmt::join(offeredBy(p), " "))));
      if (p.positional() || p.kind == ValueKind::kFlag) continue;
      std::string value;
      switch (completes(p)) {
        case Completes::kWords:
          value = fmt::format("{} {}", p.between == ',' ? "list" : "words", fmt::join(offeredBy(p), " "));
          break;
        case Completes::kFiles:
          value = "files";
          break;
        case Completes::kFolders:
          value = "folders";
          break;
        case Completes::kNothing:
          value = "nothing";
      }
      for (const std::string& name : namesOf(p))
        values += fmt::format("    [{}]={}\n", inQuotes(command.path + " " + name), inQuotes(value));
    }
  });
  return fmt::format(R"(# bash completion for fettle, made by fettle reference
_fettle() {{
  local -A commands=(
{}  )
  local -A options=(
{}  )
  local -A values=(
{}  )
  local -A arguments=(
{}  )
  local word=${{COMP_WORDS[COMP_CWORD]}} before=${{COMP_WORDS[COMP_CWORD-1]}} path=fettle i
  # "--name=value" comes as three words.
  [[ $word == = ]] && word=
  [[ $before == = ]] && before=${{COMP_WORDS[COMP_CWORD-2]}}
  local help=
  for ((i = 1; i < COMP_CWORD; ++i)); do
    [[ ${{COMP_WORDS[i]}} == -* ]] && continue
    # "help bench haptic" names a command, as "bench haptic" does.
    if [[ $path$help == fettle && ${{COMP_WORDS[i]}} == help ]]; then help=1; continue; fi
    [[ " ${{commands[$path]-}} " == *" ${{COMP_WORDS[i]}} "* ]] || break
    path+=" ${{COMP_WORDS[i]}}"
  done
  COMPREPLY=()
  if [[ -n $help ]]; then
    ((i == COMP_CWORD)) && mapfile -t COMPREPLY < <(compgen -W "${{commands[$path]-}}" -- "$word")
    return 0
  fi
  local takes=${{values["$path $before"]-}}
  case $takes in
    list\ *)
      local typed=
      [[ $word == *,* ]] && typed=${{word%,*}},
      mapfile -t COMPREPLY < <(compgen -P "$typed" -W "${{takes#list }}" -- "${{word##*,}}") ;;
    words\ *) mapfile -t COMPREPLY < <(compgen -W "${{takes#words }}" -- "$word") ;;
    folders) compopt -o filenames 2>/dev/null; mapfile -t COMPREPLY < <(compgen -d -- "$word") ;;
    nothing) ;;
    *)
      if [[ $word == -* ]]; then
        mapfile -t COMPREPLY < <(compgen -W "${{options[$path]}}" -- "$word")
      elif [[ -n ${{commands[$path]-}}${{arguments[$path]-}} ]]; then
        # A word that is no command ends the search for one.
        ((i == COMP_CWORD)) || [[ -n ${{arguments[$path]-}} ]] || return 0
        mapfile -t COMPREPLY < <(compgen -W "${{commands[$path]-}} ${{arguments[$path]-}}" -- "$word")
      else
        compopt -o filenames 2>/dev/null
        mapfile -t COMPREPLY < <(compgen -f -- "$word")
      fi ;;
  esac
}}
complete -F _fettle fettle
)",
                     commands, options, values, words);
}

// In a description of zsh a bracket and a colon end it.
std::string zshText(const std::string& text) {
  std::string out;
  for (const char c : text) {
    if (c == '[' || c == ']' || c == ':' || c == '\\') out += '\\';
    out += c == '\n' ? ' ' : c;
  }
  return out;
}

std::string zshAction(const Parameter& p) {
  switch (completes(p)) {
    case Completes::kWords:
      return p.between == ',' ? fmt::format("_values -s , word {}", fmt::join(offeredBy(p), " "))
                              : fmt::format("({})", fmt::join(offeredBy(p), " "));
    case Completes::kFiles:
      return "_files";
    case Completes::kFolders:
      return "_files -/";
    case Completes::kNothing:
      break;
  }
  return " ";
}

// Only the second word and a third one are asked for: no command lies deeper.
std::string zshHelpFunction(const CommandTable& root) {
  std::string body = fmt::format(
      "_fettle_help() {{\n  case $CURRENT in\n    2) compadd -- {} ;;\n    3)\n      case $words[2] in\n",
      fmt::join(commandNames(root), " "));
  for (const CommandTable& command : root.commands)
    if (!command.commands.empty())
      body +=
          fmt::format("        {}) compadd -- {} ;;\n", command.name, fmt::join(commandNames(command), " "));
  return body + "      esac ;;\n  esac\n}\n";
}

std::string zshFunction(const CommandTable& command) {
  std::string name = command.path;
  std::replace(name.begin(), name.end(), ' ', '_');
  std::string body = fmt::format("_{}() {{\n", name);
  std::string specs;
  for (const Parameter& p : command.parameters) {
    const std::string text = zshText(p.text);
    const std::string shown = zshText(std::string(infoOf(p.kind).shown));
    if (p.positional()) {
      specs += fmt::format(" \\\n    {}",
                           inQuotes(fmt::format("{}:{}:{}", p.several() ? "*" : (p.required ? "" : ":"),
                                                zshText(p.name), zshAction(p))));
      continue;
    }
    for (const std::string& option : namesOf(p))
      specs += fmt::format(
          " \\\n    {}",
          inQuotes(p.kind == ValueKind::kFlag
                       ? fmt::format("{}[{}]", option, text)
                       : fmt::format("{}{}{}[{}]:{}:{}", p.several() ? "*" : "", option,
                                     option.starts_with("--") ? "=" : "", text, shown, zshAction(p))));
  }
  if (command.commands.empty()) return body + "  _arguments -s" + specs + "\n}\n";
  body += "  local line state\n  local -a commands=(\n";
  for (const CommandTable& below : command.commands)
    body += fmt::format("    {}\n", inQuotes(fmt::format("{}:{}", below.name, zshText(below.summary))));
  body += "  )\n  _arguments -C" + specs + " \\\n    '(-): :->command' \\\n    '(-)*:: :->arguments'\n";
  body +=
      "  case $state in\n    command) _describe command commands ;;\n    arguments)\n      case $line[1] "
      "in\n";
  for (const CommandTable& below : command.commands)
    body += fmt::format("        {0}) _{1}_{0} ;;\n", below.name, name);
  return body + "      esac ;;\n  esac\n}\n";
}

std::string zshScript(const CommandTable& root) {
  std::string script = "#compdef fettle\n# zsh completion for fettle, made by fettle reference\n";
  forEachCommand(root, [&](const CommandTable& command) {
    script += takesAPath(command) ? zshHelpFunction(root) : zshFunction(command);
  });
  return script + "_fettle \"$@\"\n";
}

// Which command the words before the cursor name: fish has only a test for a word anywhere.
std::string fishFunction(const CommandTable& root) {
  std::vector<std::string> paths;
  forEachCommand(root, [&](const CommandTable& command) { paths.push_back(inQuotes(command.path)); });
  return fmt::format(R"(function __fettle_command
  set -l known {}
  set -l path fettle
  for word in (commandline -opc)[2..]
    string match -q -- '-*' $word; and continue
    contains -- "$path $word" $known; or break
    set path "$path $word"
  end
  test "$path" = "$argv"
end
# The same of the words after "help".
function __fettle_help
  set -l words (commandline -opc)[2..]
  test "$words[1]" = help; and test (string join ' ' fettle $words[2..]) = "$argv"
end
)",
                     fmt::join(paths, " "));
}

std::string fishScript(const CommandTable& root) {
  std::string script = "# fish completion for fettle, made by fettle reference\n" + fishFunction(root);
  forEachCommand(root, [&](const CommandTable& command) {
    const std::string head =
        fmt::format("complete -c fettle -n {}", inQuotes("__fettle_command " + command.path));
    for (const CommandTable& below : command.commands) {
      const std::string offered =
          fmt::format("-f -a {} -d {}\n", inQuotes(below.name), inQuotes(below.summary));
      script += fmt::format("{} {}", head, offered);
      script +=
          fmt::format("complete -c fettle -n {} {}", inQuotes("__fettle_help " + command.path), offered);
    }
    for (const Parameter& p : command.parameters) {
      if (p.positional() && !offeredBy(p).empty() && !takesAPath(command))
        script +=
            fmt::format("{} -f -a {}\n", head, inQuotes(fmt::format("{}", fmt::join(offeredBy(p), " "))));
      if (p.positional()) continue;
      script += fmt::format("{} -l {}", head, p.longName().substr(2));
      if (!p.shortName().empty()) script += fmt::format(" -s {}", p.shortName().substr(1));
      switch (p.kind == ValueKind::kFlag ? Completes::kNothing : completes(p)) {
        case Completes::kWords:
          script += fmt::format(
              " -x -a {}",
              inQuotes(p.between == ',' ? fmt::format("(__fish_append , {})", fmt::join(offeredBy(p), " "))
                                        : fmt::format("{}", fmt::join(offeredBy(p), " "))));
          break;
        case Completes::kFiles:
          script += " -r -F";
          break;
        case Completes::kFolders:
          script += " -x -a '(__fish_complete_directories)'";
          break;
        case Completes::kNothing:
          if (p.kind != ValueKind::kFlag) script += " -x";
      }
      script += fmt::format(" -d {}\n", inQuotes(p.text.substr(0, p.text.find('\n'))));
    }
  });
  return script;
}

}  // namespace

std::string completionScript(const CommandTable& root, Shell shell) {
  switch (shell) {
    case Shell::kBash:
      return bashScript(root);
    case Shell::kZsh:
      return zshScript(root);
    case Shell::kFish:
      break;
  }
  return fishScript(root);
}

}  // namespace fettle::app
