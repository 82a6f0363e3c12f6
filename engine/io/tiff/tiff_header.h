#pragma once

#include <algorithm>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>

#include "engine/base/error.h"
#include "engine/field/grid.h"
#include "engine/io/export.h"
#include "engine/io/files/gdal_calls.h"
#include "engine/io/files/gdal_session.h"

namespace fettle::engine {

/// The properties of a compression in the header and in the blocks.
struct TiffCoding {
  std::string_view name;
  const char* gdal;       ///< COMPRESS of its driver
  const char* predictor;  ///< tag 317; null: none
  bool tiles;             ///< where the field is larger than one
};
[[nodiscard]] const TiffCoding& tiffCodingOf(TiffCompression compression);

/// Division of the samples of a file. Fields smaller than a tile use strips of their own width.
struct TiffBlocks {
  TiffBlocks(const Grid& grid, TiffCompression compression);

  bool tiled;
  std::int32_t columns, rows;  ///< of a block; the last strip has the remaining rows
  std::int32_t across, down;   ///< blocks
};

struct FreeCslList {
  void operator()(char** list) const noexcept { gdal().CSLDestroy(list); }
};

/// Why a file of this path could not be written, by what GDAL or libtiff said.
[[nodiscard]] tl::unexpected<Error> cannotWriteTiff(const GdalSession& session, const std::string& path);

/// All of a file but its samples, by GDAL: the header, and blocks that are nowhere yet. `path` names the file in errors.
[[nodiscard]] Status writeTiffHeader(const Grid& grid, TiffCompression compression,
                                     const std::string& temporary, const std::string& path);

}  // namespace fettle::engine
