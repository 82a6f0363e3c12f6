#pragma once

#include <optional>
#include <string>
#include <vector>

#include "app/texts/catalogue.h"

namespace fettle::app {

/// What the environment says of languages.
struct LanguageWords {
  std::string file;      ///< $FETTLE_TEXTS: a catalogue, whatever the others say
  std::string language;  ///< $LANGUAGE: several, separated by colons
  std::string locale;    ///< the first of $LC_ALL, $LC_MESSAGES and $LANG that is not empty
};
[[nodiscard]] LanguageWords languageWords();

/// Names of catalogues without their ending, the first one that there is counts: "de_AT", "de" of "de_AT.UTF-8". As in every program with
/// gettext: none in the locale C, else those of $LANGUAGE before the locale's; English, which is the source, ends them.
[[nodiscard]] std::vector<std::string> catalogueNames(const LanguageWords& words);

/// Folders that have them: the user's own ($XDG_DATA_HOME/fettle/texts), then that of the program's assets (../share/fettle/texts).
[[nodiscard]] std::vector<std::string> catalogueFolders();

/// The catalogue of the user's language; nothing where there is none. Errors (kInput): there is one that cannot be used.
[[nodiscard]] engine::Result<std::optional<Catalogue>> chosenCatalogue(
    const LanguageWords& words, const std::vector<std::string>& folders);

}  // namespace fettle::app
