#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "engine/base/error.h"
#include "engine/base/job.h"
#include "engine/field/version.h"

namespace fettle::bench {

/// Layout of the samples of a GeoTIFF.
enum class TiffLayout : std::uint8_t {
  kPlainStrips,   ///< not compressed, strips of 8 KB or one row
  kPlainTiles,    ///< not compressed, tiles of 256 x 256
  kPackedStrips,  ///< Deflate with the predictor for floats, strips of 16 rows
};

/// Writes a field by GDAL alone, the highest row first, with its spacing. Errors: kInput for a path that
/// cannot be written to, kCancelled.
[[nodiscard]] engine::Status writeTiffAs(TiffLayout layout, const engine::Version& field,
                                         const std::string& path, engine::JobControl& job);

/// Seconds that the packaged GDAL alone takes to read the first band of a TIFF into one buffer, in the band's
/// own type: the faster of one call for the whole band and of a call for each row of blocks, in the order of
/// the file, with its own threads for packed blocks. Opening is included; `buffer` is resized and its pages
/// populated before. Empty for a file that its GeoTIFF driver does not open. Errors (kInput): damaged.
[[nodiscard]] engine::Result<std::optional<double>> secondsOfGdal(const std::string& path,
                                                                  std::vector<char>& buffer);

/// The same by one call into memory that was never used: what an import that keeps the samples cannot avoid.
[[nodiscard]] engine::Result<std::optional<double>> secondsOfGdalIntoNewMemory(const std::string& path);

}  // namespace fettle::bench
