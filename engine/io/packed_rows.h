#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "engine/io/input_file.h"

namespace fettle::engine {

/// A block of a little-endian TIFF that Deflate packed.
struct PackedBlock {
  std::uint64_t offset = 0;      ///< in the file
  std::uint64_t bytes = 0;       ///< in the file
  std::size_t columns = 0;       ///< numbers a row
  std::size_t number_bytes = 0;  ///< 1, 2, 4 or 8
  std::uint64_t predictor = 1;   ///< tag 317: 1, 2 (differences of integers) or 3 (of the bytes of floats)
};

/// Unpacks the first rows of a block and leaves the rest: GDAL unpacks whole blocks. `out` gets rows *
/// columns numbers. False: the block is damaged, or holds fewer rows. Source of the predictors: TIFF
/// Revision 6.0 (Aldus, 1992), section 14; Adobe Photoshop TIFF Technical Note 3 (2005). Thread: any.
[[nodiscard]] bool unpackFirstRows(const InputFile& file, const PackedBlock& block, std::size_t rows,
                                   std::vector<char>& out);

}  // namespace fettle::engine
