#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "engine/io/files/input_file.h"

namespace fettle::engine {

/// A block of a little-endian TIFF compressed with Deflate.
struct PackedBlock {
  std::uint64_t offset = 0;      ///< in the file
  std::uint64_t bytes = 0;       ///< in the file
  std::size_t columns = 0;       ///< numbers per row
  std::size_t number_bytes = 0;  ///< 1, 2, 4 or 8
  std::uint64_t predictor = 1;   ///< tag 317: 1, 2 (differences of integers) or 3 (of the bytes of floats)
};

/// Decompresses blocks without GDAL, which only decompresses whole ones, and whose libtiff takes longer to
/// undo the predictor of floats (8 ns per sample) than ISA-L takes to inflate them. Source of the predictors:
/// TIFF Revision 6.0 (Aldus, 1992), section 14; Adobe Photoshop TIFF Technical Note 3 (2005). Threading: one
/// thread per object.
class BlockUnpacker {
 public:
  BlockUnpacker();
  ~BlockUnpacker();
  BlockUnpacker(BlockUnpacker&&) noexcept;
  BlockUnpacker& operator=(BlockUnpacker&&) noexcept;

  /// The first rows of a block, or all. `out` begins with rows * columns numbers, under 2 GB. False: the
  /// block is damaged (its checksum is verified when it ends there), or holds fewer rows.
  [[nodiscard]] bool unpack(const InputFile& file, const PackedBlock& block, std::size_t rows,
                            std::vector<char>& out);

 private:
  struct Stream;
  std::unique_ptr<Stream> stream_;
  std::vector<char> packed_;
  std::vector<char> row_;
};

}  // namespace fettle::engine
