#pragma once

#include <map>
#include <set>
#include <string>
#include <string_view>
#include <vector>

namespace fettle::tests {

/// The functions that a source declares or defines outside of classes and of other functions, by where.
struct FreeFunctions {
  std::set<std::string> shared;   ///< in named namespaces
  std::set<std::string> unnamed;  ///< in unnamed ones
};
/// By the look of the text, without a compiler: an operator and a macro are none.
[[nodiscard]] FreeFunctions freeFunctions(std::string_view source);

/// Sources that are compiled together have one unnamed namespace. A function in it hides those of its name that headers declare, from every
/// source behind it: a call with numbers goes to it then without a word. `together`: paths of the sources of a unit; `tree`: path -> text
/// of all sources and headers. A line for each name that is hidden from a source that calls it.
[[nodiscard]] std::vector<std::string> hiddenFunctions(const std::vector<std::string>& together,
                                                       const std::map<std::string, std::string>& tree);

}  // namespace fettle::tests
