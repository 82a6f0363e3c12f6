#pragma once

#include <cstdint>
#include <string_view>
#include <vector>

#include "engine/io/files/input_file.h"

namespace fettle::engine {

/// Reads a file front to back through a buffer of a few MB, as lines, as words or as raw bytes.
/// After any method gave nothing, status() tells the end of the file from an error.
class TextReader {
 public:
  explicit TextReader(const InputFile& file, std::uint64_t offset = 0);

  /// The next line without its end (LF or CR LF). False at the end. An error when a line is longer than
  /// kLongest. Valid until the next call.
  [[nodiscard]] bool line(std::string_view& text);

  /// The next run of characters other than space, tab, CR, LF. As line().
  [[nodiscard]] bool word(std::string_view& text);

  /// The next `count` bytes (<= kLongest), null if the file has no more that many. As line().
  [[nodiscard]] const char* bytes(std::size_t count);

  /// Skips bytes; the caller has made sure that they are there.
  void skip(std::uint64_t count);

  /// Whether the line or word given last is the file's last and nothing stands behind it, no line end and no
  /// space: a file that was cut within its last number reads as if it held another one.
  [[nodiscard]] bool lastLineIsOpen() const noexcept { return open_; }

  /// Offset in the file of what comes next.
  [[nodiscard]] std::uint64_t offset() const noexcept { return file_offset_ - (end_ - begin_); }
  [[nodiscard]] const Status& status() const noexcept { return status_; }

  static constexpr std::size_t kLongest = std::size_t{1} << 20;

 private:
  [[nodiscard]] bool refill();

  static constexpr std::size_t kBuffer = std::size_t{4} << 20;
  const InputFile& file_;
  std::uint64_t file_offset_ = 0;  // of the first byte not in the buffer
  std::vector<char> buffer_;
  std::size_t begin_ = 0;  // of what was not given out yet
  std::size_t end_ = 0;
  bool open_ = false;
  Status status_;
};

/// What is warned of where TextReader::lastLineIsOpen().
inline constexpr const char* kOpenLastLine =
    "the last line has no end: the file may be cut short inside its last number";

/// Reads one decimal number (optional sign, exponent, nan, inf; never the locale's comma) from the front of
/// [begin, end) and moves `begin` behind it. Out of range gives infinity or zero, as the exact value would
/// round. False, and `begin` unmoved, if there is no number.
template <class Float>
[[nodiscard]] bool parseNumber(const char*& begin, const char* end, Float& number) noexcept;
extern template bool parseNumber<float>(const char*&, const char*, float&) noexcept;
extern template bool parseNumber<double>(const char*&, const char*, double&) noexcept;

/// Reads a number of digits alone, all of `word`. False if it is none or past 2^64.
[[nodiscard]] bool wholeNumber(std::string_view word, std::uint64_t& number) noexcept;

/// Whether bytes look like text: no control characters but white space.
[[nodiscard]] bool looksLikeText(std::string_view head) noexcept;

}  // namespace fettle::engine
