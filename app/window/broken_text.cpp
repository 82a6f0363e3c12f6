#include "app/window/broken_text.h"

#include <algorithm>
#include <cstddef>

#include "engine/base/digit.h"

namespace fettle::app {
namespace {

constexpr std::size_t kLongestUnit = 6;  // bytes, "N/mm", "µm," with its comma

// Whether a line must not end between two words.
bool belongTogether(std::string_view word, std::string_view next) {
  if (word.empty() || next.empty()) return false;
  if (word == "x") return engine::isDigit(next.front());
  if (!engine::isDigit(word.back())) return false;
  return next.size() <= kLongestUnit && !engine::isDigit(next.front()) && next.front() != '(';
}

}  // namespace

std::string brokenText(std::string_view text, float width,
                       const std::function<float(std::string_view)>& measure) {
  std::string lines;
  std::size_t line = 0;   // in `lines`, where the last one begins
  std::size_t space = 0;  // where it may be broken; `line`: nowhere yet
  std::string_view before;
  for (std::size_t at = 0; at <= text.size();) {
    const std::size_t end = std::min(text.find_first_of(" \n", at), text.size());
    const std::string_view word = text.substr(at, end - at);
    if (lines.size() > line && !belongTogether(before, word)) space = lines.size() - 1;
    lines += word;
    if (space > line && measure(std::string_view(lines).substr(line)) > width) {
      lines[space] = '\n';
      line = space = space + 1;
    }
    before = word;
    if (end == text.size()) break;
    lines += text[end];
    if (text[end] == '\n') {
      line = space = lines.size();
      before = {};
    }
    at = end + 1;
  }
  return lines;
}

}  // namespace fettle::app
