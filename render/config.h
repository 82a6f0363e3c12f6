#pragma once

#include <cstddef>
#include <cstdint>

namespace fettle::render {

// The constants that tune the renderer: what each one limits and what changing it does. Cells per patch and
// levels of a field on the device are in shaders/layout.h, where shaders read them.

// Pictures.

/// Sides of a picture [px]. Largest: single precision places a point to 1/256 of a pixel up to there.
inline constexpr int kSmallestPicture = 16, kLargestPicture = 65536;
/// Longest side of what is drawn in one piece [px]: a window, a part of a picture.
inline constexpr int kLargestPiece = 16384;
/// Sides of the parts in which a picture of any size is drawn [px], even. 80 MiB on the device at four rays
/// per pixel; some tenths of a second between two checks of whether the job is cancelled. Smaller parts draw
/// more patches twice.
inline constexpr int kPartSide = 1024;
/// Margin around a part within which patches are chosen with it [px]: more than the reach of seams and of
/// fragments that compare themselves with a neighbour.
inline constexpr int kAroundPartPx = 8;
/// Panels of a picture, side by side; each takes descriptor sets.
inline constexpr std::size_t kMostPanels = 5;
/// Side of the glyph image [texels]: enough for about ten font sizes.
inline constexpr int kGlyphImageSide = 1024;
/// About so many samples give the robust range of the colours; larger fields are sampled.
inline constexpr std::int64_t kRangeSamples = std::int64_t{1} << 20;
/// Colours of deviations end at the latest at this multiple of their median. 6: that of noise ends at four
/// sigma, beyond its 99.5th percentile (4.2); smaller ones would clip it, larger ones leave little of it to see
/// beside an edge that moved.
inline constexpr double kUsualChanges = 6.0;
/// Steps of the colours where they are in steps.
inline constexpr int kColourSteps = 12;

/// Distance from which the height around a point counts as what stands around it, along x and y, and on the
/// lines between these [px at the middle of the picture, lying on the field]. Nearer ones show less of the
/// form, farther ones darken what is not close to anything.
inline constexpr double kAroundPx = 8.0, kAroundBetweenPx = 4.0;
/// At most so many steps between the samples that colours come from: on demand, those of a fragment are then
/// in two pages in each direction at most.
inline constexpr int kMostAround = (1 << 5) - 2;

/// Half the side of the square within which a plane shows whether a contour line belongs to the surface or to
/// its noise [px at the middle of the picture, lying on the field]. Larger ones draw lines on flatter slopes of
/// noisy fields, and leave them out on tops and in corners of this size.
inline constexpr double kContourPx = 4.0;

// Level of detail.

/// Vertices of a frame, all panels together: 64 k take about 10 ms on two cores.
inline constexpr std::int64_t kFrameVertices = 65536;
inline constexpr std::int64_t kFewestFrameVertices = 4096, kMostFrameVertices = std::int64_t{1} << 28;
/// Of Sharpness::kRest: frames that draw a picture with four rays per pixel, so that none of them takes long.
inline constexpr int kRestBands = 24;
/// Of FrameInput::Redraw::kInBands: a million vertices take 90 ms on two cores.
inline constexpr int kDetailBands = 32;
/// The same, of the first sharp picture after one with fewer pixels: with the usual vertices it takes 35 to 60 ms at once.
inline constexpr int kSharpBands = 8;
/// Of any bands, where a single one takes half of the vertices: so many frames.
inline constexpr int kRoundsOfSteep = 4;
/// Screen error of a frame and of a picture that is drawn once [px].
inline constexpr double kFrameErrorPx = 1.0, kStillErrorPx = 0.25;
/// How far seams overlap the patches that they join [rays]: as much as rounding may separate them.
inline constexpr float kSeamRays = 0.25F;
/// Margin around what differs between two frames that is drawn again with it [px]: for seams, and for
/// fragments that compare themselves with a neighbour.
inline constexpr double kDamageMarginPx = 3.0;
/// From so many changed tiles on (a filter's result, not a stroke) everything is drawn again: the differing
/// rectangle of each tile and its place on the screen are not computed.
inline constexpr std::size_t kManyTiles = 256;
/// Tiles whose detail (render/detail/detail.h) a frame measures at most, for each version: so many at once, 1 to 3 ms on two cores,
/// and more of them while there is time (LiveOptions::measuring_ms): a window's has this much.
inline constexpr std::size_t kMeasuredPerFrame = 256, kMeasuredAtOnce = 64;
inline constexpr double kWindowMeasuringMs = 4.0;
/// The same of what a window's frame uploads (LiveOptions::uploading_ms): memory that a filter has just filled is read at 0.5 GB/s
/// beside it.
inline constexpr double kWindowUploadingMs = 3.0;

// Computing.

/// Length of a submission that computes [ms], from half of this up to this, two at a time: shorter ones cost round trips, longer
/// ones hold up a display that the device draws as well, and a cancel.
inline constexpr double kLongestComputeMs = 50.0;

// Memory and transfers.

/// Device bytes of samples, coarse copies and marks up to which all that is shown is uploaded before the
/// first picture: about 3.7 million samples. Larger fields are loaded on demand, so that no picture waits for
/// them and the device holds only what was viewed.
inline constexpr std::uint64_t kWholeBytes = std::uint64_t{16} << 20U;
/// Of a field on demand, only the coarsest copy is uploaded before the first picture: so much at most, and less of one that joins
/// it, such as a preview, since the frame in which it comes waits for that.
inline constexpr std::uint64_t kFixedBytes = std::uint64_t{8} << 20U,
                               kFixedBytesOfOthers = std::uint64_t{1} << 20U;
/// What a view requests depends on its pixels, not on samples or versions: at most 16 samples of 5 bytes per
/// pixel, where none of its panels shares a page with another. A picture of 3840 x 2160 pixels requests 0.7
/// GB at worst. A pool of pages takes no more than this, nor more than all that is shown takes as a whole,
/// plus one state where a single one is shown.
inline constexpr std::uint64_t kPoolBytes = std::uint64_t{2} << 30U;
/// log2 of the side of a page [samples]; 6: a tile. Pages are smaller where a pool would hold fewer than
/// kFewPages: few large pages would follow a view badly.
inline constexpr int kSmallestLog2Page = 6, kLargestLog2Page = 8;
inline constexpr std::uint64_t kFewPages = 256;
/// The ring that uploads pass through.
inline constexpr std::uint64_t kStagingBytes = std::uint64_t{64} << 20U;
/// Uploaded with a frame while an edit or a filter result is pending, and per submission while nothing is
/// shown.
inline constexpr std::int64_t kUploadBytesPerFrame = std::int64_t{6} << 20,
                              kUploadBytesPerSubmission = std::int64_t{16} << 20;
/// Least cost of a tile on demand, in bytes: searching its pages, of which few or none may be on the device,
/// and resetting its measures.
inline constexpr std::int64_t kTileCostBytes = 2048;
/// Initial size of the buffer for a frame's lists; it grows.
inline constexpr std::uint64_t kArenaBytes = std::uint64_t{1} << 16U;

}  // namespace fettle::render
