#pragma once

#include <cstdint>
#include <vector>

#include "engine/field/sample_rect.h"
#include "engine/field/version.h"

namespace fettle::engine {

/// Pieces of a scan side by side in one field, so that a filter is tried on all of them at once, on all threads.
struct Mosaic {
  struct Piece {
    SampleRect from;           ///< in the scan
    std::int32_t column, row;  ///< of its first sample in the mosaic
    /// In the mosaic: what is so far from where the piece was cut that filters do there what they do in the scan. At
    /// the border of the scan, up to it.
    SampleRect judged;
  };

  Version field;  ///< the scan's heights and marks, and holes between the pieces
  std::vector<Piece> pieces;
};

/// The whole of a scan of up to kMosaicWhole samples as one piece. Of a larger one whose noise is `sigma`, 5 x 5 pieces of
/// up to kMosaicSide samples a side, each from a part of the scan, where its edges are of middle height. Columns and
/// rows of holes, kMosaicGap wide, are between them: farther than filters by windows and the search for edges see.
/// Pieces begin at multiples of 256 samples, where the squares of generalised variation do. Throws std::bad_alloc.
[[nodiscard]] Mosaic makeMosaic(const Version& field, double sigma);

inline constexpr std::int32_t kMosaicSide = 224, kMosaicGap = 32, kMosaicMargin = 24;
inline constexpr std::int64_t kMosaicWhole =
    1248 * 1248;  ///< what the pieces of a larger scan have with their gaps

}  // namespace fettle::engine
