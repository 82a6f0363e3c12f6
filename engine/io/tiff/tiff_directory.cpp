#include "engine/io/tiff/tiff_directory.h"

#include <algorithm>
#include <array>
#include <limits>
#include <vector>

#include <fmt/format.h>

namespace fettle::engine {

namespace {

enum Tag : std::uint64_t {
  kWidth = 256,
  kHeight = 257,
  kBits = 258,
  kCompression = 259,
  kPhotometric = 262,
  kStripOffsets = 273,
  kSamplesPerPixel = 277,
  kStripBytes = 279,
  kXResolution = 282,
  kYResolution = 283,
  kResolutionUnit = 296,
  kPredictor = 317,
  kTileOffsets = 324,
  kTileBytes = 325,
};

// The numbers of a directory that are taken as they are.
struct Number {
  Tag tag;
  std::uint64_t TiffDirectory::*member;
};
constexpr Number kNumbers[] = {
    {kWidth, &TiffDirectory::width},
    {kHeight, &TiffDirectory::height},
    {kBits, &TiffDirectory::bits},
    {kCompression, &TiffDirectory::compression},
    {kPhotometric, &TiffDirectory::photometric},
    {kSamplesPerPixel, &TiffDirectory::samples_per_pixel},
    {kPredictor, &TiffDirectory::predictor},
    {kResolutionUnit, &TiffDirectory::resolution_unit},
};

struct Entry {
  std::uint64_t tag = 0;
  std::uint64_t type = 0;
  std::uint64_t count = 0;
  std::uint64_t at = 0;  // offset of its values in the file
};

// Bytes of one value of a type; 0 for types outside the specifications, which readers must skip. From type 1 on: BYTE,
// ASCII, SHORT, LONG, RATIONAL, SBYTE, UNDEFINED, SSHORT, SLONG, SRATIONAL, FLOAT, DOUBLE, IFD; from 16 on: LONG8, SLONG8,
// IFD8.
std::size_t bytesOf(std::uint64_t type) {
  constexpr std::array<std::size_t, 19> kBytes{0, 1, 1, 2, 4, 8, 1, 1, 2, 4, 8, 4, 8, 4, 0, 0, 8, 8, 8};
  return type < kBytes.size() ? kBytes[type] : 0;
}

bool isUnsignedInteger(std::uint64_t type) {
  return type == 1 || type == 3 || type == 4 || type == 16;
}

class Reader {
 public:
  Reader(const InputFile& file, bool little, bool big_tiff)
      : file_(file), little_(little), big_tiff_(big_tiff) {}

  // An unsigned integer of 1 to 8 bytes; nothing past the end of the file.
  std::optional<std::uint64_t> number(std::uint64_t offset, std::size_t bytes) const {
    std::array<char, 8> raw{};
    if (offset > file_.size() || bytes > file_.size() - offset) return std::nullopt;
    const auto got = file_.read(offset, raw.data(), bytes);
    if (!got || *got != bytes) return std::nullopt;
    return decode(raw.data(), bytes);
  }

  // Values of SHORT, LONG, LONG8 or BYTE entries, in pieces so that a false count allocates no memory.
  bool visit(const Entry& entry, auto&& each) const {
    if (!isUnsignedInteger(entry.type) || reachesPastTheEnd(entry)) return false;
    const std::size_t bytes = bytesOf(entry.type);
    std::vector<char> piece;
    for (std::uint64_t done = 0; done < entry.count;) {
      const auto now = static_cast<std::size_t>(std::min<std::uint64_t>(entry.count - done, 8192));
      piece.resize(now * bytes);
      const auto got = file_.read(entry.at + done * bytes, piece.data(), piece.size());
      if (!got || *got != piece.size()) return false;
      for (std::size_t i = 0; i < now; ++i) each(done + i, decode(piece.data() + i * bytes, bytes));
      done += now;
    }
    return true;
  }

  std::optional<Entry> entry(std::uint64_t offset) const {
    const std::size_t word = big_tiff_ ? 8 : 4;
    const auto tag = number(offset, 2);
    const auto type = number(offset + 2, 2);
    const auto count = number(offset + 4, word);
    if (!tag || !type || !count) return std::nullopt;
    Entry e{*tag, *type, *count, offset + 4 + word};
    const std::size_t bytes = bytesOf(e.type);
    if (bytes != 0 && e.count > word / bytes) {
      const auto at = number(e.at, word);
      if (!at) return std::nullopt;
      e.at = *at;
    }
    return e;
  }

  bool reachesPastTheEnd(const Entry& e) const {
    const std::size_t bytes = bytesOf(e.type);
    if (bytes == 0 || e.count == 0) return false;
    return e.at > file_.size() || e.count > (file_.size() - e.at) / bytes;
  }

  std::optional<double> rational(const Entry& e) const {
    if (e.type != 5 || e.count < 1) return std::nullopt;
    const auto above = number(e.at, 4);
    const auto below = number(e.at + 4, 4);
    if (!above || !below || *above == 0 || *below == 0) return std::nullopt;
    return static_cast<double>(*above) / static_cast<double>(*below);
  }

 private:
  std::uint64_t decode(const char* raw, std::size_t bytes) const {
    std::uint64_t value = 0;
    for (std::size_t i = 0; i < bytes; ++i)
      value |= std::uint64_t{static_cast<unsigned char>(raw[i])} << (8 * (little_ ? i : bytes - 1 - i));
    return value;
  }

  const InputFile& file_;
  bool little_;
  bool big_tiff_;
};

}  // namespace

std::uint64_t TiffDirectory::rawBytes() const noexcept {
  const long double bytes = static_cast<long double>(width) * static_cast<long double>(height) *
                            static_cast<long double>(samples_per_pixel) * static_cast<long double>(bits) /
                            8.0L;
  return bytes >= 1.8e19L ? std::numeric_limits<std::uint64_t>::max() : static_cast<std::uint64_t>(bytes);
}

double TiffDirectory::largestRatio() const noexcept {
  switch (compression) {
    case 1:
      return 1.0;
    case 5:
      return 2731.0;  // LZW: 12 bits represent at most 4096 bytes
    case 8:
    case 32946:
      return 1032.0;  // Deflate: 2 bits represent at most 258 bytes
    case 32773:
      return 64.0;  // PackBits: 2 bytes represent at most 128
    default:
      return 1e5;  // Zstandard, LZMA, LERC: long runs
  }
}

Result<TiffDirectory> readTiffDirectory(const InputFile& file) {
  const auto damaged = [&] {
    return inputError("the TIFF's directory lies outside the file", file.path(),
                      "the file is cut short or damaged");
  };
  std::array<char, 4> head{};
  const Result<std::size_t> got = file.read(0, head.data(), head.size());
  if (!got) return tl::unexpected(got.error());
  const bool little = head[0] == 'I';
  const int version = static_cast<unsigned char>(little ? head[2] : head[3]);
  const bool big_tiff = version == 43;
  const Reader reader(file, little, big_tiff);
  const auto start = big_tiff ? reader.number(8, 8) : reader.number(4, 4);
  if (!start) return damaged();
  const auto count = reader.number(*start, big_tiff ? 8 : 2);
  if (!count) return damaged();
  const std::uint64_t entry_bytes = big_tiff ? 20 : 12;
  const std::uint64_t first = *start + (big_tiff ? 8 : 2);
  if (*count > 65535 || *count * entry_bytes > file.size() || first > file.size() - *count * entry_bytes)
    return damaged();

  TiffDirectory directory;
  directory.little_endian = little;
  std::optional<Entry> offsets;
  std::optional<Entry> sizes;
  for (std::uint64_t i = 0; i < *count; ++i) {
    const auto entry = reader.entry(first + i * entry_bytes);
    if (!entry) return damaged();
    // The library would continue without such a tag, even without the no-data value or the coordinate system.
    if (reader.reachesPastTheEnd(*entry))
      return inputError(fmt::format("the values of tag {} reach past the end of the file", entry->tag),
                        file.path(), "the file is cut short");
    const auto scalar = [&](std::uint64_t& into) {
      Entry one = *entry;
      one.count = std::min<std::uint64_t>(one.count, 1);
      reader.visit(one, [&](std::uint64_t, std::uint64_t value) { into = value; });
    };
    for (const Number& number : kNumbers)
      if (entry->tag == number.tag) scalar(directory.*number.member);
    if (entry->tag == kXResolution) directory.x_per_unit = reader.rational(*entry);
    if (entry->tag == kYResolution) directory.y_per_unit = reader.rational(*entry);
    if (entry->tag == kStripOffsets || entry->tag == kTileOffsets) offsets = entry;
    if (entry->tag == kStripBytes || entry->tag == kTileBytes) sizes = entry;
  }
  // The next directory may hold the mask of the samples; 0: there is none.
  const auto next = reader.number(first + *count * entry_bytes, big_tiff ? 8 : 4);
  if (!next || *next >= file.size())
    return inputError("the next directory lies past the end of the file", file.path(),
                      "the file is cut short");
  if (offsets && sizes) {
    std::vector<std::uint64_t> at;
    if (!reader.visit(*offsets, [&](std::uint64_t, std::uint64_t value) { at.push_back(value); }))
      return damaged();
    const bool read = reader.visit(*sizes, [&](std::uint64_t i, std::uint64_t bytes) {
      if (i >= at.size()) return;
      const std::uint64_t inside = at[i] < file.size() ? std::min(bytes, file.size() - at[i]) : 0;
      directory.cut = directory.cut || inside < bytes;
      directory.stored_bytes += inside;
    });
    if (!read) return damaged();
  } else if (offsets) {
    directory.stored_bytes = file.size();  // some writers omit the sizes of uncompressed strips
  }
  return directory;
}

}  // namespace fettle::engine
