#pragma once

#include <string>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "app/texts/catalogue.h"

/// What a person reads in the window, in the language of a catalogue; without one, as it stands in the source. scripts/texts
/// finds the texts by the names of these functions and of those of app/window/panels/widgets.h, and lists them in
/// assets/texts/fettle.pot.
///
/// Threading: useTexts() before any other thread reads one; the rest at once from any.
namespace fettle::app {

/// All texts from now on; once, before the first is shown.
void useTexts(Catalogue catalogue);
/// As in the source again: for tests.
void useSourceTexts();
/// Whether there is a catalogue.
[[nodiscard]] bool textsAreTranslated() noexcept;

/// A text that is translated where it is shown: of a table.
[[nodiscard]] constexpr const char* textOf(const char* text) noexcept {
  return text;
}

/// The text, or its translation. A comparison without a catalogue, a search in a table with one; allocates nothing.
[[nodiscard]] const char* tr(const char* text) noexcept;
[[nodiscard]] std::string_view tr(std::string_view text) noexcept;

/// A format of printf: its translation where that has the same conversions.
[[nodiscard]] const char* trPrintf(const char* format) noexcept;

/// fmt::format() of the translation. A catalogue has none that takes other arguments than its source (Catalogue::refused).
template <class... Args>
[[nodiscard]] std::string trFormat(fmt::format_string<Args...> text, Args&&... args) {
  const fmt::string_view source = text;
  const std::string_view shown = tr(std::string_view(source.data(), source.size()));
  return fmt::vformat(fmt::string_view(shown.data(), shown.size()), fmt::make_format_args(args...));
}

/// The translation for a number of the text for one or of that for many.
[[nodiscard]] std::string_view trForm(std::string_view one, std::string_view many,
                                      unsigned long long n) noexcept;
/// The same, formatted.
template <class... Args>
[[nodiscard]] std::string trPlural(fmt::format_string<Args...> one, fmt::format_string<Args...> many,
                                   unsigned long long n, Args&&... args) {
  const fmt::string_view single = one, several = many;
  const std::string_view shown = trForm({single.data(), single.size()}, {several.data(), several.size()}, n);
  return fmt::vformat(fmt::string_view(shown.data(), shown.size()), fmt::make_format_args(args...));
}

/// The label of a widget, "name" or "name##id": its name translated, its id the same in every language. Without a catalogue
/// `label` itself; else valid until the eighth call after this. Threading: one.
[[nodiscard]] const char* labelOf(const char* label);

}  // namespace fettle::app
