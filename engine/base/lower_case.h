#pragma once

#include <string>
#include <string_view>

namespace fettle::engine {

/// Text with the letters of ASCII in lower case, whatever the locale.
[[nodiscard]] inline std::string lowerCase(std::string_view text) {
  std::string lower(text);
  for (char& c : lower)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  return lower;
}

}  // namespace fettle::engine
