#include "engine/io/files/text_reader.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstring>
#include <limits>

namespace fettle::engine {

namespace {

bool isSpace(char c) noexcept {
  return c == ' ' || c == '\t' || c == '\r' || c == '\n' || c == '\f' || c == '\v';
}

}  // namespace

TextReader::TextReader(const InputFile& file, std::uint64_t offset)
    : file_(file), file_offset_(offset), buffer_(kBuffer) {}

bool TextReader::refill() {
  if (!status_) return false;
  std::memmove(buffer_.data(), buffer_.data() + begin_, end_ - begin_);
  end_ -= begin_;
  begin_ = 0;
  const Result<std::size_t> got = file_.read(file_offset_, buffer_.data() + end_, buffer_.size() - end_);
  if (!got) {
    status_ = tl::unexpected(got.error());
    return false;
  }
  end_ += *got;
  file_offset_ += *got;
  return *got > 0;
}

bool TextReader::line(std::string_view& text) {
  for (std::size_t searched = begin_;;) {
    const void* found = std::memchr(buffer_.data() + searched, '\n', end_ - searched);
    const std::size_t stop =
        found != nullptr ? static_cast<std::size_t>(static_cast<const char*>(found) - buffer_.data()) : end_;
    if (stop - begin_ > kLongest) {
      status_ = inputError("a line is longer than 1 MB", file_.path(), "is this a text file?");
      return false;
    }
    if (found != nullptr || (searched = stop - begin_, !refill())) {
      // Without a line end the rest is the last line.
      const std::size_t last = found != nullptr ? stop : end_;
      if (!status_ || (found == nullptr && begin_ == end_)) return false;
      text = {buffer_.data() + begin_, last - begin_};
      if (text.ends_with('\r')) text.remove_suffix(1);
      begin_ = found != nullptr ? last + 1 : last;
      open_ = found == nullptr;
      return true;
    }
  }
}

bool TextReader::word(std::string_view& text) {
  do {
    while (begin_ < end_ && isSpace(buffer_[begin_])) ++begin_;
  } while (begin_ == end_ && refill());
  if (begin_ == end_) return false;
  std::size_t stop = begin_;
  for (;;) {
    while (stop < end_ && !isSpace(buffer_[stop])) ++stop;
    if (stop < end_) break;
    const std::size_t length = stop - begin_;
    if (length > kLongest) {
      status_ = inputError("a word is longer than 1 MB", file_.path(), "is this a text file?");
      return false;
    }
    const bool more = refill();
    stop = begin_ + length;
    if (!more) break;
  }
  if (!status_) return false;
  text = {buffer_.data() + begin_, stop - begin_};
  begin_ = stop;
  open_ = stop == end_;
  return true;
}

const char* TextReader::bytes(std::size_t count) {
  while (end_ - begin_ < count)
    if (!refill()) return nullptr;
  const char* first = buffer_.data() + begin_;
  begin_ += count;
  return first;
}

void TextReader::skip(std::uint64_t count) {
  const std::uint64_t held = std::min<std::uint64_t>(count, end_ - begin_);
  begin_ += held;
  file_offset_ += count - held;
}

template <class Float>
bool parseNumber(const char*& begin, const char* end, Float& number) noexcept {
  const char* at = begin;
  if (at < end && *at == '+') {
    ++at;
    if (at < end && *at == '-') return false;
  }
  const auto [stop, error] = std::from_chars(at, end, number);
  if (error == std::errc::invalid_argument) return false;
  if (error == std::errc::result_out_of_range) {
    // Outside the range of the type: too large, or so near 0 that it rounds to 0. The exponent decides.
    const std::string_view text(at, static_cast<std::size_t>(stop - at));
    double wide = 0.0;
    if (sizeof(Float) < sizeof(double) && std::from_chars(at, end, wide).ec == std::errc{}) {
      number = std::abs(wide) < 1.0 ? Float{0} : std::numeric_limits<Float>::infinity();
    } else {
      // A long string of zeros, "0.000...1" or "1000...", has no exponent; the leading digit then decides.
      const std::size_t exponent = text.find_first_of("eE");
      const bool tiny = exponent != std::string_view::npos ? text.substr(exponent + 1).starts_with('-')
                                                           : text.find_first_of("123456789") > text.find('.');
      number = tiny ? Float{0} : std::numeric_limits<Float>::infinity();
    }
    if (text.starts_with('-')) number = -number;
  }
  // "1.#QNAN", "-1.#IND00", "1.#INF": older Windows libraries write numbers that are not finite in this form.
  if (stop < end && *stop == '#') {
    const std::string_view rest(stop, static_cast<std::size_t>(end - stop));
    const bool infinite = rest.starts_with("#INF");
    if (!infinite && !rest.starts_with("#QNAN") && !rest.starts_with("#SNAN") && !rest.starts_with("#IND"))
      return false;
    const char* after = stop + 1;
    while (after < end && ((*after >= 'A' && *after <= 'Z') || (*after >= '0' && *after <= '9'))) ++after;
    number = infinite ? std::numeric_limits<Float>::infinity() : std::numeric_limits<Float>::quiet_NaN();
    begin = after;
    return true;
  }
  begin = stop;
  return true;
}
template bool parseNumber<float>(const char*&, const char*, float&) noexcept;
template bool parseNumber<double>(const char*&, const char*, double&) noexcept;

bool wholeNumber(std::string_view word, std::uint64_t& number) noexcept {
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), number);
  return error == std::errc{} && end == word.data() + word.size();
}

std::string_view withoutByteOrderMark(std::string_view text) noexcept {
  constexpr std::string_view kMark = "\xEF\xBB\xBF";
  if (text.starts_with(kMark)) text.remove_prefix(kMark.size());
  return text;
}

bool isRemark(std::string_view line) noexcept {
  return line.starts_with('#') || line.starts_with("//") || line.starts_with('%');
}

std::string_view remarkText(std::string_view line) noexcept {
  line.remove_prefix(line.starts_with("//") ? 2 : 1);
  return line;
}

bool looksLikeText(std::string_view head) noexcept {
  return std::ranges::none_of(head, [](char c) {
    const auto byte = static_cast<unsigned char>(c);
    return (byte < 0x20 && !isSpace(c)) || byte == 0x7f;
  });
}

}  // namespace fettle::engine
