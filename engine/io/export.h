#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "engine/base/error.h"
#include "engine/base/job.h"
#include "engine/field/version.h"

namespace fettle::engine {

/// Compression of the samples of a TIFF. docs/formats.md lists which programs read which.
enum class TiffCompression : std::uint8_t {
  kNone,     ///< strips of uncompressed floats, which every program reads; the default
  kLzw,      ///< strips, no predictor: for older programs; no smaller where heights are noisy
  kDeflate,  ///< tiles, floating-point predictor
  kZstd,     ///< the same, faster in both directions, read by fewer programs
};

/// "none", "lzw", "deflate", "zstd"; nothing for others.
[[nodiscard]] std::optional<TiffCompression> tiffCompressionFromName(std::string_view name);

struct ExportOptions {
  /// 16-bit PNG: height per count [height_unit], finite and > 0. Without it Grid::height_per_count, and where
  /// that is 0 or the heights do not fit it, the range of the field spread over 1 .. 65535.
  std::optional<double> height_per_count;
  /// PLY: the surface as triangles instead of points. STL is always triangles.
  bool mesh = false;
  /// Mesh: as few triangles as possible with every sample within this distance of the surface [height_unit],
  /// finite, >= 0; without it two per cell. Implies mesh.
  std::optional<double> max_error;
  /// STL: the unit of its numbers; without it that of x and y. In the same unit as the field's every bit is kept, in another
  /// one each number is multiplied once and rounded to float: by no more than 6e-8 of it.
  std::optional<LengthUnit> mesh_unit;
  /// SDF: as text instead of binary.
  bool ascii = false;
  /// TIFF: laid out for reading parts over a network, with overviews (means of 2 x 2, 4 x 4 ... samples).
  bool cloud_optimised = false;
  /// Session: the scan that the field was made from, with the same grid and sign. The session begins with it,
  /// and where the two differ the field is a step from there. Without it the session begins with the field.
  std::optional<Version> original;
  /// Session: steps that made the field with which it begins, as a recipe (docs/formats.md); kept as its note "recipe".
  /// Empty: none.
  std::string recipe = {};
  /// Session: all steps that led to the field, those of `recipe` first, where `original` is not the field; kept as its note
  /// "steps". Empty: not known.
  std::string steps = {};
  /// TIFF: without a value kNone, and kDeflate where cloud-optimised.
  std::optional<TiffCompression> tiff_compression;
};

struct Exported {
  std::string format;                 ///< FormatInfo::name of the writer
  std::vector<std::string> warnings;  ///< what the format could not keep; one line each, no full stop
};

}  // namespace fettle::engine
