#include "tests/walls/hidden_names.h"

#include <algorithm>
#include <cctype>
#include <optional>
#include <utility>

namespace fettle::tests {

namespace {

bool inName(char c) {
  return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_';
}

// Without comments, text in quotes, and lines of the preprocessor.
std::string codeOf(std::string_view source) {
  std::string code;
  bool line_begins = true;
  for (std::size_t i = 0; i < source.size(); ++i) {
    const char c = source[i];
    const std::string_view rest = source.substr(i);
    if (rest.starts_with("//") || (line_begins && c == '#')) {
      i = std::min(source.find('\n', i), source.size()) - 1;
      continue;
    }
    if (rest.starts_with("/*")) {
      i = std::min(source.find("*/", i), source.size() - 2) + 1;
      continue;
    }
    if (c == '"' || (c == '\'' && (i == 0 || !inName(source[i - 1])))) {
      for (++i; i < source.size() && source[i] != c; ++i) i += source[i] == '\\';
      code += "\"\"";
      continue;
    }
    line_begins = c == '\n' || (line_begins && std::isspace(static_cast<unsigned char>(c)) != 0);
    code += c;
  }
  return code;
}

// The name before the first bracket of a declaration; none of a member's definition, a control word, or where nothing stands before it.
std::optional<std::string> functionIn(std::string_view declaration) {
  const std::size_t bracket = declaration.find('(');
  if (bracket == std::string_view::npos || declaration.substr(0, bracket).find('=') != std::string_view::npos)
    return std::nullopt;
  std::size_t end = bracket;
  while (end > 0 && std::isspace(static_cast<unsigned char>(declaration[end - 1])) != 0) --end;
  std::size_t begin = end;
  while (begin > 0 && inName(declaration[begin - 1])) --begin;
  const std::string_view before = declaration.substr(0, begin);
  const std::size_t type = before.find_last_not_of(" \n\t*&>");
  if (begin == end || type == std::string_view::npos || before.ends_with("::") || before.ends_with('~'))
    return std::nullopt;
  // As the house writes it: functions begin small.
  if (std::islower(static_cast<unsigned char>(declaration[begin])) == 0) return std::nullopt;
  for (const std::string_view word : {"noexcept", "decltype", "alignas", "static_assert", "requires"})
    if (declaration.substr(begin, end - begin) == word) return std::nullopt;
  return std::string(declaration.substr(begin, end - begin));
}

std::set<std::string> reachedBy(const std::string& path, const std::map<std::string, std::string>& tree) {
  std::set<std::string> reached;
  std::vector<std::string> open{path};
  while (!open.empty()) {
    const auto found = tree.find(open.back());
    open.pop_back();
    if (found == tree.end()) continue;
    constexpr std::string_view kInclude = "#include \"";
    for (std::size_t at = found->second.find(kInclude); at != std::string::npos;
         at = found->second.find(kInclude, at + 1)) {
      const std::size_t from = at + kInclude.size();
      const std::string header = found->second.substr(from, found->second.find('"', from) - from);
      if (tree.contains(header) && reached.insert(header).second) open.push_back(header);
    }
  }
  return reached;
}

// Whether it calls a function of this name by it alone.
bool calls(std::string_view code, const std::string& name) {
  for (std::size_t at = code.find(name); at != std::string_view::npos; at = code.find(name, at + 1)) {
    const char before = at > 0 ? code[at - 1] : ' ';
    const std::size_t after = at + name.size();
    if (inName(before) || before == '.' || before == ':' || before == '>') continue;
    if (after < code.size() && code[after] == '(') return true;
  }
  return false;
}

}  // namespace

FreeFunctions freeFunctions(std::string_view source) {
  enum class Scope { kNamed, kUnnamed, kOther };
  const std::string code = codeOf(source);
  FreeFunctions functions;
  std::vector<Scope> scopes;
  std::size_t others = 0, unnamed = 0, begin = 0;
  for (std::size_t i = 0; i < code.size(); ++i) {
    const char c = code[i];
    if (c != '{' && c != '}' && c != ';') continue;
    const std::string_view declaration = std::string_view(code).substr(begin, i - begin);
    begin = i + 1;
    if (c == '}') {
      if (scopes.empty()) continue;
      others -= scopes.back() == Scope::kOther;
      unnamed -= scopes.back() == Scope::kUnnamed;
      scopes.pop_back();
      continue;
    }
    constexpr std::string_view kNamespace = "namespace";
    const std::size_t word = declaration.find(kNamespace);
    if (c == '{' && others == 0 && word != std::string_view::npos &&
        declaration.find("using") == std::string_view::npos) {
      const bool named =
          declaration.find_first_not_of(" \n\t", word + kNamespace.size()) != std::string_view::npos;
      scopes.push_back(named ? Scope::kNamed : Scope::kUnnamed);
      unnamed += !named;
      continue;
    }
    if (others == 0)
      if (auto name = functionIn(declaration))
        (unnamed > 0 ? functions.unnamed : functions.shared).insert(*std::move(name));
    if (c == '{') {
      scopes.push_back(Scope::kOther);
      ++others;
    }
  }
  return functions;
}

std::vector<std::string> hiddenFunctions(const std::vector<std::string>& together,
                                         const std::map<std::string, std::string>& tree) {
  std::vector<std::string> hidden;
  std::map<std::string, std::string> by;  // name -> the source in whose unnamed namespace it is
  for (const std::string& path : together) {
    const auto source = tree.find(path);
    if (source == tree.end()) continue;
    const FreeFunctions own = freeFunctions(source->second);
    const std::string code = codeOf(source->second);
    std::set<std::string> declared = own.shared;
    for (const std::string& header : reachedBy(path, tree)) {
      const FreeFunctions there = freeFunctions(tree.at(header));
      declared.insert(there.shared.begin(), there.shared.end());
    }
    for (const auto& [name, other] : by)
      if (declared.contains(name) && !own.unnamed.contains(name) && calls(code, name))
        hidden.push_back(path + " calls " + name + "(), which one in " + other + " hides");
    for (const std::string& name : own.unnamed) by.emplace(name, path);
  }
  return hidden;
}

}  // namespace fettle::tests
