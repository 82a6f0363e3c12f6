#include "tests/support/catalogue_file.h"

#include <cstdint>
#include <fstream>
#include <string_view>

namespace fettle::tests {
namespace {

// "a\"b\n" of a list, without its quotes.
std::string unquoted(std::string_view line) {
  std::string text;
  const std::size_t begin = line.find('"') + 1, end = line.rfind('"');
  for (std::size_t i = begin; i < end; ++i) {
    if (line[i] != '\\') {
      text += line[i];
      continue;
    }
    ++i;
    text += line[i] == 'n' ? '\n' : line[i] == 't' ? '\t' : line[i];
  }
  return text;
}

void append32(std::string& bytes, std::size_t number) {
  const auto value = static_cast<std::uint32_t>(number);
  for (int shift = 0; shift < 32; shift += 8) bytes += static_cast<char>(value >> shift & 0xffU);
}

std::string accented(char c) {
  switch (c) {
    case 'a':
      return "\u00e1";
    case 'e':
      return "\u00e9";
    case 'i':
      return "\u00ed";
    case 'o':
      return "\u00f3";
    case 'u':
      return "\u00fa";
    case 'A':
      return "\u00c1";
    case 'E':
      return "\u00c9";
    case 'I':
      return "\u00cd";
    case 'O':
      return "\u00d3";
    case 'U':
      return "\u00da";
    default:
      return std::string(1, c);
  }
}

// Where what begins at a brace or a percent sign ends; `i` itself: it is no field and no conversion.
std::size_t fieldEnd(std::string_view text, std::size_t i) {
  if (text[i] == '{') {
    int depth = 0;
    for (std::size_t k = i; k < text.size(); ++k) {
      depth += text[k] == '{' ? 1 : text[k] == '}' ? -1 : 0;
      if (depth == 0) return k + 1;
    }
  }
  if (text[i] == '%') {
    const std::size_t letter = text.find_first_not_of("0123456789.", i + 1);
    if (letter != std::string_view::npos &&
        (text[letter] == '%' ||
         (letter > i && std::string_view("dfgsc").find(text[letter]) != std::string_view::npos)))
      return letter + 1;
  }
  return i;
}

}  // namespace

std::vector<ListedText> listedTexts(const std::string& path) {
  std::ifstream in(path);
  std::vector<ListedText> texts;
  std::string* part = nullptr;
  std::string unused;
  for (std::string line; std::getline(in, line);) {
    if (line.starts_with("msgid_plural ")) {
      part = &texts.back().many;
    } else if (line.starts_with("msgid ")) {
      texts.emplace_back();
      part = &texts.back().one;
    } else if (line.starts_with("msgstr")) {
      part = &unused;
    } else if (!line.starts_with('"')) {
      part = nullptr;
    }
    if (part != nullptr) *part += unquoted(line);
  }
  std::erase_if(texts, [](const ListedText& text) { return text.one.empty(); });
  return texts;
}

std::string catalogueBytes(const std::map<std::string, std::string>& texts, const std::string& plural) {
  std::map<std::string, std::string> all = texts;
  all[""] = "Content-Type: text/plain; charset=UTF-8\nPlural-Forms: " + plural + "\n";
  constexpr std::size_t kHeader = 28, kRow = 8;
  const std::size_t strings = kHeader + 2 * kRow * all.size();
  std::string sources, translations, data;
  const auto add = [&](std::string& table, const std::string& text) {
    append32(table, text.size());
    append32(table, strings + data.size());
    data += text + '\0';
  };
  for (const auto& [source, text] : all) add(sources, source);
  for (const auto& [source, text] : all) add(translations, text);
  std::string bytes;
  append32(bytes, 0x950412de);
  append32(bytes, 0);
  append32(bytes, all.size());
  append32(bytes, kHeader);
  append32(bytes, kHeader + kRow * all.size());
  append32(bytes, 0);
  append32(bytes, 0);
  return bytes + sources + translations + data;
}

std::string pseudoText(const std::string& source) {
  std::string text;
  std::size_t letters = 0;
  for (std::size_t i = 0; i < source.size();) {
    if (const std::size_t end = fieldEnd(source, i); end > i) {
      text += source.substr(i, end - i);
      i = end;
      continue;
    }
    text += accented(source[i++]);
    ++letters;
  }
  // In words, which a line can end between.
  for (std::size_t i = 0; i < letters / 3; ++i) {
    if (i > 0 && i % 8 == 0) text += ' ';
    text += '~';
  }
  return "[" + text + "]";
}

std::string pseudoCatalogue(const std::string& list) {
  std::map<std::string, std::string> texts;
  for (const ListedText& text : listedTexts(list))
    if (text.many.empty())
      texts[text.one] = pseudoText(text.one);
    else
      texts[text.one + '\0' + text.many] = pseudoText(text.one) + '\0' + pseudoText(text.many);
  return catalogueBytes(texts);
}

}  // namespace fettle::tests
