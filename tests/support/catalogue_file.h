#pragma once

#include <map>
#include <string>
#include <vector>

namespace fettle::tests {

/// A text of assets/texts/fettle.pot.
struct ListedText {
  std::string one;
  std::string many;  ///< empty: it has one form
};
/// All of a list that scripts/texts made, without its header.
[[nodiscard]] std::vector<ListedText> listedTexts(const std::string& path);

/// The bytes of a catalogue as msgfmt writes them: the header, then `texts`, whose sources and translations with several forms
/// have zeros between them.
[[nodiscard]] std::string catalogueBytes(const std::map<std::string, std::string>& texts,
                                         const std::string& plural = "nplurals=2; plural=n != 1;");

/// A translation into no language: vowels with accents, in brackets and a third longer. Fields of formats stay.
[[nodiscard]] std::string pseudoText(const std::string& source);
/// The catalogue of such translations of a list.
[[nodiscard]] std::string pseudoCatalogue(const std::string& list);

}  // namespace fettle::tests
