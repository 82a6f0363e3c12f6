#include "app/commands/shell_word.h"

#include <algorithm>
#include <cctype>
#include <string_view>

namespace fettle::app {

std::string quotedWord(const std::string& word) {
  const auto plain = [](char c) {
    return std::isalnum(static_cast<unsigned char>(c)) != 0 ||
           std::string_view("/._-+=:,@%").find(c) != std::string_view::npos;
  };
  if (!word.empty() && std::ranges::all_of(word, plain)) return word;
  std::string out = "'";
  for (const char c : word)
    if (c == '\'')
      out += "'\\''";
    else
      out += c;
  return out + "'";
}

std::string fettleCommand(const std::vector<std::string>& words) {
  std::string command = "fettle";
  for (const std::string& word : words) (command += ' ') += quotedWord(word);
  return command;
}

std::vector<std::string> wordsWithout(const std::vector<std::string>& words,
                                      const std::vector<std::string_view>& flags,
                                      const std::vector<std::string_view>& with_value) {
  std::vector<std::string> kept;
  for (std::size_t i = 0; i < words.size(); ++i) {
    const std::string_view word = words[i];
    if (std::ranges::find(flags, word) != flags.end()) continue;
    if (std::ranges::find(with_value, word.substr(0, word.find('='))) != with_value.end()) {
      if (word.find('=') == std::string_view::npos) ++i;
      continue;
    }
    kept.emplace_back(word);
  }
  return kept;
}

}  // namespace fettle::app
