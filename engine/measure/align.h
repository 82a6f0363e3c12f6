#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include <glm/vec2.hpp>

#include "engine/base/error.h"
#include "engine/base/job.h"
#include "engine/field/version.h"
#include "engine/measure/region.h"
#include "engine/measure/rigid_motion.h"

namespace fettle::engine {

/// How the second of two fields may be moved. Height is always free.
struct AlignMoves {
  bool shift = true;     ///< along x and y
  bool rotation = true;  ///< about z
  bool tilt = true;      ///< about x and y

  friend bool operator==(const AlignMoves&, const AlignMoves&) = default;
};

/// What one resolution of alignFields() took, by which the time of larger fields is foreseen (finestAlignment).
struct AlignStage {
  int resolution = 0;           ///< 0: the coarsest; the finest is the last
  std::size_t places = 0;       ///< of the first field's map
  std::size_t points = 0;       ///< of these that are compared
  std::size_t starts = 0;       ///< motions that were refined
  double map_seconds = 0.0;     ///< of reducing and smoothing both fields
  double refine_seconds = 0.0;  ///< of all starts
};

/// What errors call the two fields, and how they say that a turn may be searched for more widely: the words of `fettle align A B`
/// unless whoever shows them has others.
struct AlignWords {
  std::string first = "A", second = "B";
  std::string wider = "--rotation allows a wider search";
};

struct AlignOptions {
  AlignMoves moves;
  Region region = Region::kAll;     ///< the samples of the first field that count
  double most_rotation_deg = 10.0;  ///< rotations about z that the search tries, both ways; 0 .. 180
  /// Whether shift and rotation are searched for over the whole field. Without it the start is where the fields' positions
  /// place them.
  bool search = true;
  std::vector<AlignStage>* stages =
      nullptr;  ///< where what each resolution took is added; lives during the call
  AlignWords words = {};
};

/// A rigid motion that brings a second field onto a first, in millimetres of the first's field coordinates: a point of the
/// second, in its own field coordinates, is moved to motion.moved(point). The centre is the middle of the first field.
struct Alignment {
  RigidMotion motion;
  RigidMotion::Angles angles;
  glm::dvec3 shift_error{0.0};      ///< standard errors of motion.shift [mm]
  RigidMotion::Angles angle_error;  ///< standard errors [degrees]
  /// Covariance of a shift [mm] and of a turn about the centre [rad] beyond the motion, row-major: x, y, z, about x, y, z.
  std::array<double, 36> covariance{};
  double rms_mm = 0.0;  ///< of the smoothed heights' differences that count
  double overlap =
      0.0;  ///< share of the first field's samples of the region under which the second has heights
  double left_out = 0.0;     ///< share of these that do not count: they lie apart
  std::int64_t samples = 0;  ///< that count
  double sigma_mm = 0.0;     ///< of the Gaussian window through which both were compared
  /// The surface repeats itself: moved further by so much [mm] along x and y the second field fits as well.
  std::optional<glm::dvec2> repeat;
};

/// Finds it. Both fields are reduced by means of blocks without spikes (whole samples, so to fewer than 2^22 heights each, nearly alike spacing), single
/// spikes become holes, both go through one Gaussian window of 1.25 spacings, and the motion is that of the least sum of
/// Tukey's biweight of the height differences (Gauss-Newton, from coarse to fine; J. Tukey 1974), so that samples which only
/// one field has - dust, steps, spikes - do not count, as long as they are fewer
/// than half. On steep places the size of a difference that counts grows with the slope, by at most a spacing across:
/// edges decide a part of level faces.
///
/// Start: the greatest normalised correlations of what remains without plane, and without waves longer than a tenth of the
/// field, at all shifts that leave at least a fifth of the smaller field in common and all rotations within the limit
/// (D. Padfield, Masked object registration in the Fourier domain, 2012). Tilts to about 15 degrees are found.
///
/// Standard errors: what independent noise in every sample makes of the motion through both windows (the sandwich of
/// H. White 1980), of the size that the differences have. Where sums over 12 x 12 blocks scatter by more than that
/// explains, at three standard errors of their scatter, it counts instead: noise that neighbours share, and shape that
/// differs. The slopes' part is the product of both fields' slopes, whose noise is independent, so that noise does not
/// look like shape. A motion that it does not decide - a shift along a cylinder, any on a plane, a turn on a sphere - is
/// an error that names it, not a number.
///
/// A surface that repeats itself fits at every period. Where shift and search are free, shifts by which either field is like itself
/// (likelyRepeats) are refined as well, and the shortest of those that leave no more than what was found (fitsAsWell) is Alignment::repeat. Noise
/// through the window that is larger than the pattern hides it, and of a field with itself, whose noise is the same, no other motion fits as well.
///
/// Bit-identical for any number of threads. Memory: some 200 bytes for each of the reduced heights. Errors: kInput for fields
/// without samples, too little overlap, a motion that the surface does not decide; kCancelled. Throws std::bad_alloc.
/// Thread: any; a long job on all workers of the calling arena.
[[nodiscard]] Result<Alignment> alignFields(const Version& first, const Version& second,
                                            const AlignOptions& options, JobControl& job);

/// The finest resolution of alignFields() of fields on two grids.
struct FinestAlignment {
  double spacing_mm = 0.0;  ///< of the heights to which both are reduced
  std::size_t places = 0;   ///< of these in the first field: about 2^20 of larger ones, fewer than 2^22
  std::size_t points = 0;   ///< of these that are compared, at most 300,000
  std::size_t starts = 0;   ///< motions that are refined there, at most; 0 where it is the only resolution
  int resolutions = 1;      ///< it and those before, each of four times the spacing of the next
};
/// Throws std::bad_alloc.
[[nodiscard]] FinestAlignment finestAlignment(const Grid& first, const Grid& second);

}  // namespace fettle::engine
