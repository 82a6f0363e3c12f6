#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "app/texts/plural_rule.h"
#include "engine/base/error.h"

namespace fettle::app {

/// The texts of the window in another language: a file that msgfmt made (.mo, GNU gettext manual, "The Format of GNU MO Files").
/// Every number of the file is checked against its size before it is followed, and a translation that cannot stand for its
/// source is left out, so that whatever is found can be shown, and formatted with the arguments of its source.
///
/// Threading: immutable.
class Catalogue {
 public:
  static constexpr std::size_t kMostBytes = 16U << 20U;

  /// Errors (kInput): not readable, larger than kMostBytes, not such a file, not in UTF-8.
  [[nodiscard]] static engine::Result<Catalogue> read(const std::string& path);
  /// The same of its bytes; `where`: named in errors.
  [[nodiscard]] static engine::Result<Catalogue> parse(std::string bytes, const std::string& where);

  /// The translation, as long as the catalogue lives; null: none. O(log entries), allocates nothing.
  [[nodiscard]] const char* find(std::string_view source) const noexcept;
  /// The form for a number, of a text with one for 1 and one for many.
  [[nodiscard]] const char* find(std::string_view one, std::string_view many,
                                 unsigned long long n) const noexcept;

  [[nodiscard]] std::size_t size() const noexcept { return entries_.size(); }
  /// Sources whose translation was left out: other replacement fields, another number of forms, "##", which ends a label.
  [[nodiscard]] const std::vector<std::string>& refused() const noexcept { return refused_; }

 private:
  struct Entry {
    std::size_t source, source_size;  // in bytes_
    std::size_t many, many_size;      // 0: it has one form
    std::size_t text;                 // of the first form; each ends with a zero
    std::size_t forms;
  };

  [[nodiscard]] std::string_view sourceOf(const Entry& entry) const noexcept {
    return std::string_view(bytes_).substr(entry.source, entry.source_size);
  }
  [[nodiscard]] const Entry* entryOf(std::string_view source) const noexcept;
  [[nodiscard]] bool takeHeader(std::string_view header);
  void take(std::string_view source, std::string_view text);

  // Offsets and not pointers: short strings move with their owner.
  std::string bytes_;
  std::vector<Entry> entries_;  // by source
  std::vector<std::string> refused_;
  PluralRule plural_;
};

}  // namespace fettle::app
