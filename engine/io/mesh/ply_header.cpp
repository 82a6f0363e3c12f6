#include "engine/io/mesh/ply_header.h"

#include <algorithm>
#include <array>
#include <bit>
#include <string_view>

#include <fmt/format.h>

#include "engine/io/files/text_reader.h"
#include "engine/io/grid_notes.h"
#include "engine/io/units.h"

namespace fettle::engine {

namespace {

constexpr int kMostPlyHeaderLines = 1000;

template <class T>
double load(const char* bytes, bool swap) noexcept {
  std::array<char, sizeof(T)> raw;
  for (std::size_t i = 0; i < sizeof(T); ++i) raw[i] = bytes[swap ? sizeof(T) - 1 - i : i];
  return static_cast<double>(std::bit_cast<T>(raw));
}

struct TypeRow {
  PlyType type;
  std::string_view old_name, new_name;
  std::size_t bytes;
  double (*load)(const char* bytes, bool swap) noexcept;
};
constexpr TypeRow kTypes[] = {
    {PlyType::kInt8, "char", "int8", 1, load<std::int8_t>},
    {PlyType::kUint8, "uchar", "uint8", 1, load<std::uint8_t>},
    {PlyType::kInt16, "short", "int16", 2, load<std::int16_t>},
    {PlyType::kUint16, "ushort", "uint16", 2, load<std::uint16_t>},
    {PlyType::kInt32, "int", "int32", 4, load<std::int32_t>},
    {PlyType::kUint32, "uint", "uint32", 4, load<std::uint32_t>},
    {PlyType::kFloat32, "float", "float32", 4, load<float>},
    {PlyType::kFloat64, "double", "float64", 8, load<double>},
};
static_assert(std::ranges::is_sorted(kTypes, {}, &TypeRow::type));  // a type is the index of its row

std::optional<PlyType> typeOf(std::string_view name) {
  for (const TypeRow& row : kTypes)
    if (name == row.old_name || name == row.new_name) return row.type;
  return std::nullopt;
}

std::vector<std::string_view> wordsOf(std::string_view line) {
  std::vector<std::string_view> words;
  for (std::size_t at = line.find_first_not_of(" \t"); at != std::string_view::npos;) {
    const std::size_t end = std::min(line.find_first_of(" \t", at), line.size());
    words.push_back(line.substr(at, end - at));
    at = line.find_first_not_of(" \t", end);
  }
  return words;
}

// "obj_info num_cols 512": texts of specific programs. Other lines are ignored.
void takeObjectInfo(const std::vector<std::string_view>& words, PlyHeader& header) {
  if (words.size() != 3) return;
  if (words[1] == "num_cols" && !wholeNumber(words[2], header.range_columns)) header.range_columns = 0;
  if (words[1] == "num_rows" && !wholeNumber(words[2], header.range_rows)) header.range_rows = 0;
}

// Parses one line into `header`; false if it is invalid.
bool takeLine(const std::vector<std::string_view>& words, PlyHeader& header, bool& format_seen) {
  if (words[0] == "format" && words.size() >= 2) {
    format_seen = true;
    if (words[1] == "ascii")
      header.encoding = PlyEncoding::kAscii;
    else if (words[1] == "binary_little_endian")
      header.encoding = PlyEncoding::kLittleEndian;
    else if (words[1] == "binary_big_endian")
      header.encoding = PlyEncoding::kBigEndian;
    else
      return false;
    return true;
  }
  if (words[0] == "element" && words.size() == 3) {
    PlyElement element{std::string(words[1]), 0, {}};
    if (!wholeNumber(words[2], element.count)) return false;
    header.elements.push_back(std::move(element));
    return true;
  }
  if (words[0] == "property" && !header.elements.empty()) {
    auto& properties = header.elements.back().properties;
    if (words.size() == 3) {
      const auto type = typeOf(words[1]);
      if (type) properties.push_back({std::string(words[2]), *type, std::nullopt});
      return type.has_value();
    }
    if (words.size() == 5 && words[1] == "list") {
      const auto count = typeOf(words[2]);
      const auto type = typeOf(words[3]);
      if (!count || !type || *count >= PlyType::kFloat32) return false;
      properties.push_back({std::string(words[4]), *type, count});
      return true;
    }
  }
  return false;
}

}  // namespace

std::size_t bytesOf(PlyType type) noexcept {
  return kTypes[static_cast<std::size_t>(type)].bytes;
}

double decodePly(const char* bytes, PlyType type, PlyEncoding encoding) noexcept {
  const bool swap = (encoding == PlyEncoding::kLittleEndian) != (std::endian::native == std::endian::little);
  return kTypes[static_cast<std::size_t>(type)].load(bytes, swap);
}

std::optional<std::size_t> PlyElement::stride() const noexcept {
  std::size_t bytes = 0;
  for (const PlyProperty& property : properties) {
    if (property.count_type) return std::nullopt;
    bytes += bytesOf(property.type);
  }
  return bytes;
}

std::optional<std::size_t> PlyElement::indexOf(const std::string& property) const noexcept {
  for (std::size_t i = 0; i < properties.size(); ++i)
    if (properties[i].name == property && !properties[i].count_type) return i;
  return std::nullopt;
}

std::string plyRasterComments(const Grid& grid) {
  std::string text;
  for (const std::string& line : rasterNotes(grid)) text += "comment " + line + '\n';
  return text;
}

Result<PlyHeader> readPlyHeader(const InputFile& file) {
  TextReader text(file);
  PlyHeader header;
  std::string_view line;
  bool format_seen = false;
  RasterNotesReader notes;
  for (int number = 1; number <= kMostPlyHeaderLines && text.line(line); ++number) {
    const std::vector<std::string_view> words = wordsOf(line);
    if (words.empty() || words[0] == "ply") continue;
    if (words[0] == "obj_info") {
      takeObjectInfo(words, header);
      continue;
    }
    if (words[0] == "comment") {
      notes.take(line.substr(line.find("comment") + 7));
      if (!header.unit) header.unit = lengthUnitFromComment(line);
      continue;
    }
    if (words[0] == "end_header") {
      if (!format_seen) break;
      header.body = text.offset();
      header.raster = notes.raster();
      return header;
    }
    if (!takeLine(words, header, format_seen))
      return inputError(fmt::format("line {} of the header is not a line of a PLY header", number),
                        file.path(), "the file is damaged");
  }
  if (!text.status()) return tl::unexpected(text.status().error());
  return inputError("the PLY header has no end or names no format", file.path(),
                    "the file is cut short or damaged");
}

}  // namespace fettle::engine
