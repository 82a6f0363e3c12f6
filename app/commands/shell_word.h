#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace fettle::app {

/// A word as a POSIX shell takes it: quoted where it is not plain.
[[nodiscard]] std::string quotedWord(const std::string& word);

/// "fettle" and the words of a command, each as the shell takes it.
[[nodiscard]] std::string fettleCommand(const std::vector<std::string>& words);

/// A command line without some options: `flags` alone, `with_value` with the word after them or behind =.
[[nodiscard]] std::vector<std::string> wordsWithout(const std::vector<std::string>& words,
                                                    const std::vector<std::string_view>& flags,
                                                    const std::vector<std::string_view>& with_value);

}  // namespace fettle::app
