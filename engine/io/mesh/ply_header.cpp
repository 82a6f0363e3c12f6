#include "engine/io/mesh/ply_header.h"

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

std::optional<PlyType> typeOf(std::string_view name) {
  struct NamedType {
    std::string_view old_name, new_name;
    PlyType type;
  };
  static constexpr std::array<NamedType, 8> kTypeNames{{{"char", "int8", PlyType::kInt8},
                                                        {"uchar", "uint8", PlyType::kUint8},
                                                        {"short", "int16", PlyType::kInt16},
                                                        {"ushort", "uint16", PlyType::kUint16},
                                                        {"int", "int32", PlyType::kInt32},
                                                        {"uint", "uint32", PlyType::kUint32},
                                                        {"float", "float32", PlyType::kFloat32},
                                                        {"double", "float64", PlyType::kFloat64}}};
  for (const NamedType& named : kTypeNames)
    if (name == named.old_name || name == named.new_name) return named.type;
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

template <class T>
T load(const char* bytes, bool swap) noexcept {
  std::array<char, sizeof(T)> raw;
  for (std::size_t i = 0; i < sizeof(T); ++i) raw[i] = bytes[swap ? sizeof(T) - 1 - i : i];
  return std::bit_cast<T>(raw);
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
  static constexpr std::array<std::size_t, 8> kBytes{1, 1, 2, 2, 4, 4, 4, 8};
  return kBytes[static_cast<std::size_t>(type)];
}

double decodePly(const char* bytes, PlyType type, PlyEncoding encoding) noexcept {
  const bool swap = (encoding == PlyEncoding::kLittleEndian) != (std::endian::native == std::endian::little);
  switch (type) {
    case PlyType::kInt8:
      return load<std::int8_t>(bytes, swap);
    case PlyType::kUint8:
      return load<std::uint8_t>(bytes, swap);
    case PlyType::kInt16:
      return load<std::int16_t>(bytes, swap);
    case PlyType::kUint16:
      return load<std::uint16_t>(bytes, swap);
    case PlyType::kInt32:
      return load<std::int32_t>(bytes, swap);
    case PlyType::kUint32:
      return load<std::uint32_t>(bytes, swap);
    case PlyType::kFloat32:
      return static_cast<double>(load<float>(bytes, swap));
    case PlyType::kFloat64:
      return load<double>(bytes, swap);
  }
  return 0.0;
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
