#pragma once

#include <cstddef>
#include <cstdint>

namespace fettle::render {

// What is tuned in the renderer, each with the question that it answers and what turning it does. Cells of a
// patch and levels of a field on the device are in shaders/layout.h, where shaders read them.

// Pictures.

/// Sides of a picture [px]. Largest: single precision places a point to 1/256 of a pixel up to there.
inline constexpr int kSmallestPicture = 16, kLargestPicture = 65536;
/// Longest side of what is drawn in one go [px]: a window, a part of a picture.
inline constexpr int kLargestPiece = 16384;
/// Sides of the parts that a picture of any size is drawn in [px], even. 80 MiB on the device at four rays a
/// pixel, some tenths of a second between two looks at whether the job is cancelled; smaller parts draw more
/// patches twice.
inline constexpr int kPartSide = 1024;
/// What lies so far beyond a part is chosen with it [px]: as far as seams and comparing fragments reach, and
/// more.
inline constexpr int kAroundPartPx = 8;
/// Panels of a picture, side by side; each takes descriptor sets.
inline constexpr std::size_t kMostPanels = 5;
/// Side of the image of letters [texels]: those of some ten font sizes.
inline constexpr int kGlyphImageSide = 1024;
/// Samples that the robust range of the colours is worked out from, about; of larger fields some are left
/// out.
inline constexpr std::int64_t kRangeSamples = std::int64_t{1} << 20;

// How finely.

/// Vertices of a frame, all panels together: 64 k take about 10 ms on two cores.
inline constexpr std::int64_t kFrameVertices = 65536;
inline constexpr std::int64_t kFewestFrameVertices = 4096, kMostFrameVertices = std::int64_t{1} << 28;
/// Screen error of a frame and of a picture that is drawn once [px].
inline constexpr double kFrameErrorPx = 1.0, kStillErrorPx = 0.25;
/// How far seams overlap the patches that they join [rays]: as much as rounding may part them.
inline constexpr float kSeamRays = 0.25F;
/// Around what differs between two frames this is drawn again with it [px]: for seams, and for fragments that
/// compare themselves with a neighbour.
inline constexpr double kDamageMarginPx = 3.0;
/// From so many changed tiles on (a filter's result, not a stroke) all is new: nobody looks for the rectangle
/// that differs in each, nor for where it is seen.
inline constexpr std::size_t kManyTiles = 256;
/// Tiles whose detail (render/detail/detail.h) a frame measures at most, for each version: about 4 ms on two
/// cores.
inline constexpr std::size_t kMeasuredAFrame = 256;

// Memory and transfers.

/// Device bytes of samples, coarse copies and marks up to which all that is shown is uploaded before the
/// first picture: some 3.7 million samples. What takes more comes by need, so that no picture waits for it
/// and the device holds no more than was looked at.
inline constexpr std::uint64_t kWholeBytes = std::uint64_t{16} << 20U;
/// The coarsest copy of a field that comes by need is all that the first picture waits for.
inline constexpr std::uint64_t kFixedBytes = std::uint64_t{8} << 20U;
/// What a view asks for follows its pixels, not the samples or the versions: at most 16 samples of 5 bytes a
/// pixel, where none of its panels shares a page with another. A picture of 3840 x 2160 pixels asks for 0.7
/// GB at worst. A pool of pages takes no more than this, nor than all that is shown takes as a whole, with
/// room for one state more next to a single one.
inline constexpr std::uint64_t kPoolBytes = std::uint64_t{2} << 30U;
/// log2 of the side of a page [samples]; 6: a tile. Pages are smaller where a pool would hold fewer than
/// kFewPages: few large pages would follow a view badly.
inline constexpr int kSmallestLog2Page = 6, kLargestLog2Page = 8;
inline constexpr std::uint64_t kFewPages = 256;
/// The ring that uploads pass through.
inline constexpr std::uint64_t kStagingBytes = std::uint64_t{64} << 20U;
/// Uploaded with a frame while an edit or a filter result comes over, and in one go while nothing is shown.
inline constexpr std::int64_t kUploadBytesAFrame = std::int64_t{6} << 20,
                              kUploadBytesAtOnce = std::int64_t{16} << 20;
/// What a tile by need counts for at least, as bytes: looking for its pages, of which few or none may be on
/// the device, and resetting its measures.
inline constexpr std::int64_t kTileCostBytes = 2048;
/// What a frame's lists begin with; it grows.
inline constexpr std::uint64_t kArenaBytes = std::uint64_t{1} << 16U;

}  // namespace fettle::render
