#include "app/texts/catalogue.h"

#include <algorithm>
#include <cstdint>
#include <optional>
#include <utility>

#include "app/texts/format_fields.h"
#include "engine/io/files/input_file.h"
#include "engine/io/files/little_endian.h"

namespace fettle::app {
namespace {

constexpr std::uint32_t kMagic = 0x950412de, kSwapped = 0xde120495;
constexpr std::size_t kHeaderBytes = 28, kRowBytes = 8;
constexpr const char* kRemedy = "make it with msgfmt of the texts in assets/texts/fettle.pot";

// Where the catalogue's strings lie: `table` has a length and a place for each.
struct StringTable {
  std::size_t at = 0, count = 0;

  [[nodiscard]] bool within(std::size_t bytes) const {
    return at <= bytes && count <= (bytes - at) / kRowBytes;
  }
  // Nothing where it does not lie in the file with the zero at its end.
  [[nodiscard]] std::optional<std::string_view> string(std::string_view bytes, std::size_t i) const {
    const std::size_t length = engine::little<std::uint32_t>(bytes.data() + at + kRowBytes * i),
                      place = engine::little<std::uint32_t>(bytes.data() + at + kRowBytes * i + 4);
    if (place >= bytes.size() || length >= bytes.size() - place || bytes[place + length] != '\0')
      return std::nullopt;
    return bytes.substr(place, length);
  }
};

// Unicode 15, table 3-7: no overlong forms, no surrogates, nothing above U+10FFFF.
bool isUtf8(std::string_view text) {
  std::size_t i = 0;
  const auto byte = [&](std::size_t k) { return static_cast<unsigned char>(text[k]); };
  while (i < text.size()) {
    const unsigned char first = byte(i);
    const std::size_t more = first < 0x80   ? 0
                             : first < 0xc2 ? 4
                             : first < 0xe0 ? 1
                             : first < 0xf0 ? 2
                             : first < 0xf5 ? 3
                                            : 4;
    if (more > 3 || more >= text.size() - i) return false;
    for (std::size_t k = 1; k <= more; ++k)
      if ((byte(i + k) & 0xc0U) != 0x80U) return false;
    if ((first == 0xe0 && byte(i + 1) < 0xa0) || (first == 0xed && byte(i + 1) > 0x9f) ||
        (first == 0xf0 && byte(i + 1) < 0x90) || (first == 0xf4 && byte(i + 1) > 0x8f))
      return false;
    i += more + 1;
  }
  return true;
}

// What stands behind `name` in the header's line that begins with it; empty: none does.
std::string_view lineOf(std::string_view header, std::string_view name) {
  while (!header.empty()) {
    const std::string_view line = header.substr(0, header.find('\n'));
    if (line.starts_with(name)) return line.substr(name.size());
    header.remove_prefix(std::min(line.size() + 1, header.size()));
  }
  return {};
}

}  // namespace

engine::Result<Catalogue> Catalogue::read(const std::string& path) {
  auto file = engine::InputFile::open(path);
  if (!file) return tl::unexpected(file.error());
  if (file->size() > kMostBytes)
    return engine::inputError("the catalogue of texts is too large", path, kRemedy);
  std::string bytes(file->size(), '\0');
  const auto got = file->read(0, bytes.data(), bytes.size());
  if (!got) return tl::unexpected(got.error());
  bytes.resize(*got);
  return parse(std::move(bytes), path);
}

engine::Result<Catalogue> Catalogue::parse(std::string bytes, const std::string& where) {
  const auto number = [&](std::size_t at) { return engine::little<std::uint32_t>(bytes.data() + at); };
  if (bytes.size() >= 4 && number(0) == kSwapped)
    return engine::inputError("the catalogue of texts is for other processors", where,
                              "make it with msgfmt --endianness=little");
  if (bytes.size() < kHeaderBytes || bytes.size() > kMostBytes || number(0) != kMagic ||
      number(4) >> 16U > 1U)
    return engine::inputError("this is no catalogue of texts", where, kRemedy);
  const StringTable sources{number(12), number(8)}, texts{number(16), number(8)};
  if (!sources.within(bytes.size()) || !texts.within(bytes.size()))
    return engine::inputError("the catalogue of texts is cut off", where, kRemedy);
  Catalogue made;
  made.bytes_ = std::move(bytes);
  const std::string_view all = made.bytes_;
  bool header = false;
  made.entries_.reserve(sources.count);
  for (std::size_t i = 0; i < sources.count; ++i) {
    const auto source = sources.string(all, i), text = texts.string(all, i);
    if (!source || !text) return engine::inputError("the catalogue of texts is damaged", where, kRemedy);
    if (!isUtf8(*text))
      return engine::inputError("the catalogue of texts is not in UTF-8", where, "make its charset UTF-8");
    if (!source->empty())
      made.take(*source, *text);
    else if (!made.takeHeader(*text))
      return engine::inputError("the header of the catalogue of texts cannot be used", where,
                                "it says the charset UTF-8, and Plural-Forms");
    else
      header = true;
  }
  if (!header) return engine::inputError("the catalogue of texts has no header", where, kRemedy);
  std::ranges::stable_sort(made.entries_, {}, [&](const Entry& entry) { return made.sourceOf(entry); });
  return made;
}

bool Catalogue::takeHeader(std::string_view header) {
  if (lineOf(header, "Content-Type:").find("charset=UTF-8") == std::string_view::npos) return false;
  const std::string_view plural = lineOf(header, "Plural-Forms:");
  if (plural.empty()) return true;
  const auto rule = PluralRule::read(plural);
  if (rule) plural_ = *rule;
  return rule.has_value();
}

void Catalogue::take(std::string_view source, std::string_view text) {
  if (text.empty() || source.find('\4') != std::string_view::npos)
    return;  // not translated; of a context, which none here has
  const std::size_t zero = source.find('\0');
  const bool plural = zero != std::string_view::npos;
  // All forms have the arguments of the one for many: that for one may leave some out.
  const std::string_view one = source.substr(0, zero), many = plural ? source.substr(zero + 1) : source;
  const auto forms = static_cast<std::size_t>(std::ranges::count(text, '\0')) + 1;
  bool fits = plural || forms == 1;
  for (std::string_view rest = text;;) {
    const std::size_t end = rest.find('\0');
    const std::string_view form = rest.substr(0, end);
    fits = fits && fitsFields(many, form) && form.find("##") == std::string_view::npos;
    if (end == std::string_view::npos) break;
    rest.remove_prefix(end + 1);
  }
  if (!fits) {
    refused_.emplace_back(one);
    return;
  }
  const auto placeOf = [&](std::string_view in) {
    return static_cast<std::size_t>(in.data() - bytes_.data());
  };
  entries_.push_back(
      {placeOf(one), one.size(), placeOf(many), plural ? many.size() : 0, placeOf(text), forms});
}

const Catalogue::Entry* Catalogue::entryOf(std::string_view source) const noexcept {
  const auto at =
      std::ranges::lower_bound(entries_, source, {}, [&](const Entry& entry) { return sourceOf(entry); });
  return at != entries_.end() && sourceOf(*at) == source ? &*at : nullptr;
}

const char* Catalogue::find(std::string_view source) const noexcept {
  const Entry* const entry = entryOf(source);
  return entry != nullptr && entry->many_size == 0 ? bytes_.c_str() + entry->text : nullptr;
}

// What was checked is the form for many of the file: it has to be that of the program.
const char* Catalogue::find(std::string_view one, std::string_view many,
                            unsigned long long n) const noexcept {
  const Entry* const entry = entryOf(one);
  if (entry == nullptr || std::string_view(bytes_).substr(entry->many, entry->many_size) != many)
    return nullptr;
  std::size_t form = std::min(plural_.formOf(n), entry->forms - 1);
  const char* text = bytes_.c_str() + entry->text;
  for (; form > 0; --form) text += std::string_view(text).size() + 1;
  return text;
}

}  // namespace fettle::app
