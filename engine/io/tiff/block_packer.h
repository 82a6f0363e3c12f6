#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

namespace fettle::engine {

/// Compresses blocks of float32 samples as TIFF calls Deflate (8) or ZSTD (50000) with the floating-point
/// predictor (3): of each row first the highest bytes of all samples, then the next ones, each byte as its
/// difference to the one before; then a zlib stream (RFC 1950) or a Zstandard frame (RFC 8878). Lossless.
/// Source: Adobe Photoshop TIFF Technical Note 3, 2005.
///
/// Zlib streams by ISA-L, level 2: 117 to 129 million samples per second and core, where libdeflate's levels
/// 1 and 6 reach 36 to 41 and 16 to 24 (256 x 256 samples per block, 2.5 GHz Xeon with AVX-512), and 1.0 %
/// larger than libdeflate's level 6 on a noisy part, 5 % on a clean one, 9 % on a simulated scan (ISA-L's
/// levels 1 and 3 are no smaller there). ISA-L chooses its loops by the processor: the bytes may differ
/// between processors, the decompressed data does not.
///
/// Threading: one thread per object.
class BlockPacker {
 public:
  enum class Stream : std::uint8_t { kDeflate, kZstd };

  explicit BlockPacker(Stream stream = Stream::kDeflate);
  ~BlockPacker();
  BlockPacker(BlockPacker&&) noexcept;
  BlockPacker& operator=(BlockPacker&&) noexcept;

  /// `samples`: rows x columns, row-major, without gaps, at most 4 GB. The result is valid until the next
  /// call; empty when the library fails, which only a fault in it can cause.
  [[nodiscard]] std::span<const std::uint8_t> pack(std::span<const float> samples, std::size_t columns);

 private:
  struct State;
  [[nodiscard]] bool deflate();
  [[nodiscard]] bool zstandard();

  std::unique_ptr<State> state_;
  std::vector<std::uint8_t> row_;
  std::vector<std::uint8_t> differences_;
  std::vector<std::uint8_t> packed_;
};

}  // namespace fettle::engine
