#include "app/window/screen_text.h"

#include <array>
#include <cstddef>

#include "engine/base/digit.h"

namespace fettle::app {
namespace {

// Whether the text begins at `at` where no word, option or path goes on.
bool beginsThere(std::string_view text, std::size_t at) {
  if (at == 0) return true;
  const char before = text[at - 1];
  return before == ' ' || before == '\n' || before == '\t' || before == '(' || before == '[';
}

// Whether a word ends before `at`: a point with a letter behind it is of a file's name.
bool endsThere(std::string_view text, std::size_t at) {
  constexpr std::string_view kEnds = " \n\t,;:)]^/";
  if (at >= text.size() || kEnds.find(text[at]) != std::string_view::npos) return true;
  return text[at] == '.' && (at + 1 == text.size() || text[at + 1] == ' ' || text[at + 1] == '\n');
}

// Whether a number stands before `at`, with a space or without.
bool hasNumber(std::string_view text, std::size_t at) {
  if (at > 0 && text[at - 1] == ' ') --at;
  return at > 0 && engine::isDigit(text[at - 1]);
}

// As a unit: the same behind the stroke of a fraction, 1/mm2 or um3/um2.
bool isUnit(std::string_view text, std::size_t at, std::size_t end) {
  const bool below = at > 1 && text[at - 1] == '/' && engine::isDigit(text[at - 2]);
  return endsThere(text, end) && (beginsThere(text, at) || hasNumber(text, at) || below);
}

struct Word {
  std::string_view ascii, shown;
  bool (*stands)(std::string_view text, std::size_t at, std::size_t end);
};
constexpr std::array kWords{
    Word{"+-", "\u00b1",
         [](std::string_view text, std::size_t at, std::size_t end) {
           const bool before = beginsThere(text, at);
           return before &&
                  (end == text.size() || text[end] == ' ' || text[end] == '.' || engine::isDigit(text[end]));
         }},
    Word{"um", "\u00b5m",
         [](std::string_view text, std::size_t at, std::size_t end) {
           return endsThere(text, end) && (beginsThere(text, at) || hasNumber(text, at));
         }},
    Word{"um2", "\u00b5m\u00b2", isUnit}, Word{"um3", "\u00b5m\u00b3", isUnit},
    Word{"nm2", "nm\u00b2", isUnit}, Word{"nm3", "nm\u00b3", isUnit}, Word{"mm2", "mm\u00b2", isUnit},
    Word{"mm3", "mm\u00b3", isUnit}, Word{"m2", "m\u00b2", isUnit}, Word{"m3", "m\u00b3", isUnit},
    Word{" degrees", "\u00b0",
         [](std::string_view text, std::size_t at, std::size_t end) {
           return endsThere(text, end) && at > 0 && engine::isDigit(text[at - 1]);
         }},
    // A word of the language, too.
    Word{"us", "\u00b5s", [](std::string_view text, std::size_t at, std::size_t end) {
           return endsThere(text, end) && hasNumber(text, at);
         }}};

}  // namespace

std::string screenText(std::string_view text) {
  std::string shown;
  shown.reserve(text.size());
  for (std::size_t at = 0; at < text.size();) {
    const Word* found = nullptr;
    for (const Word& word : kWords)
      if (text.substr(at).starts_with(word.ascii) && word.stands(text, at, at + word.ascii.size()))
        found = &word;
    if (found == nullptr) {
      shown += text[at++];
      continue;
    }
    shown += found->shown;
    at += found->ascii.size();
  }
  return shown;
}

}  // namespace fettle::app
