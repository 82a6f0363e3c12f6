#include "app/texts/format_fields.h"

#include <algorithm>
#include <optional>
#include <vector>

namespace fettle::app {
namespace {

constexpr std::size_t kMostArguments = 64;

struct FormatField {
  std::size_t argument = 0;
  std::string_view spec;  // behind the colon
  bool operator==(const FormatField&) const = default;
};

struct FormatFields {
  std::vector<FormatField> fields;
  bool nested = false;  // a spec takes arguments of its own
};

// Reads the number of an argument, or counts it; nothing where numbers are mixed or not plain.
class ArgumentNumbers {
 public:
  std::optional<std::size_t> take(std::string_view number) {
    if (number.empty()) {
      if (said_) return std::nullopt;
      counted_ = true;
      return next_++;
    }
    if (counted_) return std::nullopt;
    said_ = true;
    std::size_t value = 0;
    for (const char c : number) {
      if (c < '0' || c > '9') return std::nullopt;
      value = 10 * value + static_cast<std::size_t>(c - '0');
      if (value >= kMostArguments) return std::nullopt;
    }
    return value;
  }

 private:
  std::size_t next_ = 0;
  bool counted_ = false, said_ = false;
};

// The field that begins behind a brace; `text` then goes on behind its end.
std::optional<FormatField> takeField(std::string_view& text, ArgumentNumbers& numbers, bool& nested) {
  const std::size_t end = text.find_first_of(":}");
  if (end == std::string_view::npos) return std::nullopt;
  const auto argument = numbers.take(text.substr(0, end));
  if (!argument) return std::nullopt;
  FormatField field{*argument, {}};
  if (text[end] == ':') {
    std::size_t i = end + 1;
    while (i < text.size() && text[i] != '}') {
      if (text[i] != '{') {
        ++i;
        continue;
      }
      nested = true;
      const std::size_t close = text.find('}', i);
      if (close == std::string_view::npos || !numbers.take(text.substr(i + 1, close - i - 1)))
        return std::nullopt;
      i = close + 1;
    }
    if (i >= text.size()) return std::nullopt;
    field.spec = text.substr(end + 1, i - end - 1);
    text.remove_prefix(i + 1);
  } else {
    text.remove_prefix(end + 1);
  }
  return field;
}

// Nothing where it is no format.
std::optional<FormatFields> fieldsOf(std::string_view text) {
  FormatFields all;
  ArgumentNumbers numbers;
  while (true) {
    const std::size_t at = text.find_first_of("{}");
    if (at == std::string_view::npos) return all;
    const char brace = text[at];
    text.remove_prefix(at + 1);
    if (!text.empty() && text.front() == brace) {
      text.remove_prefix(1);
      continue;
    }
    if (brace == '}') return std::nullopt;
    const auto field = takeField(text, numbers, all.nested);
    if (!field) return std::nullopt;
    all.fields.push_back(*field);
  }
}

// The next conversion of a printf format, from its % to its letter; empty: none. "%%" counts, since it is written as one sign.
std::string_view takeConversion(std::string_view& text) noexcept {
  const std::size_t at = text.find('%');
  if (at == std::string_view::npos) {
    text = {};
    return {};
  }
  const std::size_t letter = text.find_first_not_of("0123456789.+-# *hlLqjzt", at + 1);
  const std::size_t end = letter == std::string_view::npos ? text.size() : letter + 1;
  const std::string_view conversion = text.substr(at, end - at);
  text.remove_prefix(end);
  return conversion;
}

}  // namespace

bool fitsFields(std::string_view source, std::string_view translation) {
  const auto wanted = fieldsOf(source), given = fieldsOf(translation);
  if (!wanted || !given) return false;
  if (wanted->nested || given->nested) return wanted->fields == given->fields;
  return std::ranges::all_of(given->fields, [&](const FormatField& field) {
    return std::ranges::find(wanted->fields, field) != wanted->fields.end();
  });
}

bool sameConversions(std::string_view source, std::string_view translation) noexcept {
  while (!source.empty() || !translation.empty())
    if (takeConversion(source) != takeConversion(translation)) return false;
  return true;
}

}  // namespace fettle::app
