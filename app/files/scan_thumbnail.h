#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "engine/base/error.h"
#include "engine/base/job.h"
#include "engine/field/grid.h"
#include "engine/io/import.h"

namespace fettle::app {

/// A small picture of a scan that is not open, with the heights in it, and what reading it said.
struct ScanThumbnail {
  int width = 0,
      height = 0;  ///< pixels, each at most the asked side; 0: the file is too large for a quick look
  std::vector<float> heights;          ///< row by row, the top one first; NaN: hole [height unit of the grid]
  std::vector<std::uint32_t> colours;  ///< as heights: 0xAABBGGRR, sRGB; holes are transparent
  float low = 0.0F, high = 0.0F;       ///< of nearly all heights, for the colours; equal without any
  float lowest = 0.0F, highest = 0.0F;  ///< of what was read: of the file where all of it was
  std::optional<engine::Grid>
      grid;            ///< of the whole file as it would be opened, where its header or the picture tells
  std::string format;  ///< FormatInfo::name; empty where only a coarse picture was read
  std::vector<std::string> warnings;  ///< of reading all of it; none where only a coarse picture was read
  std::vector<engine::LoneValue> lone_values;  ///< Imported::lone_values
  bool whole = false;                          ///< all of the file was read

  [[nodiscard]] bool empty() const noexcept { return heights.empty(); }
};

/// Files up to this size are read whole for their picture where nothing coarser can be read.
inline constexpr std::uint64_t kMostThumbnailBytes = std::uint64_t{64} << 20;

/// Reads a picture of at most `side` x `side` pixels: from the file's own overview or every n-th sample where
/// importPreview finds that quick, else from all of it. A pixel is the mean of the samples in it; light falls in from the
/// upper left, colours are those of heights. Errors: those of importField. Thread: any; a long job.
[[nodiscard]] engine::Result<ScanThumbnail> readThumbnail(const std::string& path,
                                                          const engine::ImportOptions& options, int side,
                                                          engine::JobControl& job);

/// The picture of a field in memory: what readThumbnail makes of it, without what reading said.
[[nodiscard]] ScanThumbnail thumbnailOf(const engine::Version& field, int side);

}  // namespace fettle::app
