#pragma once

#include <cstdint>
#include <string_view>
#include <vector>

#include "engine/io/files/input_file.h"

namespace fettle::engine {

/// Reads a file sequentially through a buffer of a few MB, as lines, as words or as raw bytes. After a method
/// returned nothing, status() distinguishes the end of the file from an error.
class TextReader {
 public:
  explicit TextReader(const InputFile& file, std::uint64_t offset = 0);

  /// The next line without its end (LF or CR LF). False at the end. An error when a line is longer than
  /// kLongest. Valid until the next call.
  [[nodiscard]] bool line(std::string_view& text);

  /// The next run of characters other than space, tab, CR, LF. As line().
  [[nodiscard]] bool word(std::string_view& text);

  /// The next `count` bytes (<= kLongest), null if fewer are left in the file. As line().
  [[nodiscard]] const char* bytes(std::size_t count);

  /// Skips bytes; the caller has checked that they exist.
  void skip(std::uint64_t count);

  /// Whether the last line or word is the end of the file, without a line end or space behind it: a file that
  /// was cut within its last number would be read with another number.
  [[nodiscard]] bool lastLineIsOpen() const noexcept { return open_; }

  /// Offset in the file of the next byte.
  [[nodiscard]] std::uint64_t offset() const noexcept { return file_offset_ - (end_ - begin_); }
  [[nodiscard]] const Status& status() const noexcept { return status_; }

  static constexpr std::size_t kLongest = std::size_t{1} << 20;

 private:
  [[nodiscard]] bool refill();

  static constexpr std::size_t kBuffer = std::size_t{4} << 20;
  const InputFile& file_;
  std::uint64_t file_offset_ = 0;  // of the first byte after the buffer
  std::vector<char> buffer_;
  std::size_t begin_ = 0;  // of what was not returned yet
  std::size_t end_ = 0;
  bool open_ = false;
  Status status_;
};

/// Warning where TextReader::lastLineIsOpen().
inline constexpr const char* kOpenLastLine =
    "the last line has no end: the file may be cut short inside its last number";

/// Reads one decimal number (optional sign, exponent, nan, inf; never the locale's comma) from the front of
/// [begin, end) and moves `begin` behind it. Out of range gives infinity or zero, as the exact value would
/// round. False, with `begin` unchanged, if there is no number.
template <class Float>
[[nodiscard]] bool parseNumber(const char*& begin, const char* end, Float& number) noexcept;
extern template bool parseNumber<float>(const char*&, const char*, float&) noexcept;
extern template bool parseNumber<double>(const char*&, const char*, double&) noexcept;

/// Reads a number of only digits, all of `word`. False if it is not one or past 2^64.
[[nodiscard]] bool wholeNumber(std::string_view word, std::uint64_t& number) noexcept;

/// Text of a program that marks UTF-8 at its beginning (EF BB BF), without that mark.
[[nodiscard]] std::string_view withoutByteOrderMark(std::string_view text) noexcept;

/// Whether a line is a remark beside numbers: it begins with #, // or %.
[[nodiscard]] bool isRemark(std::string_view line) noexcept;
/// A remark without the characters that make it one.
[[nodiscard]] std::string_view remarkText(std::string_view line) noexcept;

/// Whether bytes look like text: no control characters except white space.
[[nodiscard]] bool looksLikeText(std::string_view head) noexcept;

}  // namespace fettle::engine
