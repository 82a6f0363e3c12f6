#pragma once

#include <cstdint>
#include <optional>

#include "engine/io/files/input_file.h"

namespace fettle::engine {

/// Properties of a TIFF's first directory that GDAL does not provide completely: resolution tags as exact
/// rationals (GDAL gives 8 digits), and how many bytes of samples the file really holds, so that a false
/// header is detected before memory is allocated for it. Layout: TIFF Revision 6.0 (Aldus, 1992), section 2;
/// BigTIFF (libtiff, 2007).
struct TiffDirectory {
  std::uint64_t width = 0;
  std::uint64_t height = 0;
  std::uint64_t samples_per_pixel = 1;
  std::uint64_t bits = 1;         ///< of one sample of the first band
  std::uint64_t compression = 1;  ///< TIFF tag 259
  std::uint64_t photometric = 1;  ///< tag 262: 0 white is 0, 1 black is 0, 2 colours, 3 palette ...
  std::uint64_t predictor = 1;    ///< tag 317: what was compressed: 1 the numbers, 2, 3 differences of them
  bool little_endian = true;
  std::uint64_t stored_bytes = 0;     ///< of strips or tiles inside the file
  bool cut = false;                   ///< some strip or tile extends past the end of the file
  std::optional<double> x_per_unit;   ///< tag 282, pixels per unit; finite and > 0
  std::optional<double> y_per_unit;   ///< tag 283
  std::uint64_t resolution_unit = 2;  ///< tag 296: 1 none, 2 inch, 3 centimetre

  /// Bytes of all samples when decompressed; saturates.
  [[nodiscard]] std::uint64_t rawBytes() const noexcept;
  /// Largest ratio of the compression.
  [[nodiscard]] double largestRatio() const noexcept;
};

/// Reads the first directory. Errors (kInput): not a TIFF; the directory, the values of any of its tags or
/// the start of the next directory lie outside the file.
[[nodiscard]] Result<TiffDirectory> readTiffDirectory(const InputFile& file);

}  // namespace fettle::engine
