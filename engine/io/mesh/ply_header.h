#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "engine/field/grid.h"
#include "engine/io/files/input_file.h"

namespace fettle::engine {

// The header of a PLY file (G. Turk, "The PLY Polygon File Format", 1994): elements with properties, in the
// order of the body.

enum class PlyEncoding { kAscii, kLittleEndian, kBigEndian };
enum class PlyType { kInt8, kUint8, kInt16, kUint16, kInt32, kUint32, kFloat32, kFloat64 };

[[nodiscard]] std::size_t bytesOf(PlyType type) noexcept;

/// A number of the body as a double (exact for every type).
[[nodiscard]] double decodePly(const char* bytes, PlyType type, PlyEncoding encoding) noexcept;

struct PlyProperty {
  std::string name;
  PlyType type = PlyType::kFloat32;
  std::optional<PlyType> count_type;  ///< of a list
};

struct PlyElement {
  std::string name;
  std::uint64_t count = 0;
  std::vector<PlyProperty> properties;

  /// Bytes of one item in a binary body; nothing if it holds a list.
  [[nodiscard]] std::optional<std::size_t> stride() const noexcept;
  [[nodiscard]] std::optional<std::size_t> indexOf(const std::string& property) const noexcept;
};

struct PlyHeader {
  PlyEncoding encoding = PlyEncoding::kAscii;
  std::vector<PlyElement> elements;
  std::optional<LengthUnit> unit;  ///< from a comment "units mm"
  std::optional<Grid> raster;      ///< from comments such as plyRasterComments writes
  /// From "obj_info num_cols" and "num_rows": sides of the raster that an element "range_grid" fills.
  std::uint64_t range_columns = 0, range_rows = 0;
  std::uint64_t body = 0;  ///< offset of the first byte behind the header
};

/// The lines of a header that state a field's raster and units, for readPlyHeader; other programs ignore
/// them. Each with its line end.
[[nodiscard]] std::string plyRasterComments(const Grid& grid);

/// Errors (kInput): not a PLY header, one without an end, unknown types, a count that no file can hold.
[[nodiscard]] Result<PlyHeader> readPlyHeader(const InputFile& file);

}  // namespace fettle::engine
