#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

namespace fettle::app {

/// Which of several forms of a text a number takes, as a catalogue says it: the part behind "plural=" of its header, an
/// expression of C in n with ?:, ||, &&, ==, !=, <, >, <=, >=, +, -, *, /, %, ! and parentheses.
class PluralRule {
 public:
  static constexpr std::size_t kMostForms = 16;

  /// Two forms: one, and all others.
  PluralRule() = default;
  /// Of "nplurals=3; plural=...;". Nothing where it does not read so, is deeper than any language needs or has too many forms.
  [[nodiscard]] static std::optional<PluralRule> read(std::string_view header);

  [[nodiscard]] std::size_t forms() const noexcept { return forms_; }
  /// From 0; below forms(), whatever the expression gives.
  [[nodiscard]] std::size_t formOf(unsigned long long n) const noexcept;

 private:
  std::size_t forms_ = 2;
  std::string expression_ = "n!=1";
};

}  // namespace fettle::app
