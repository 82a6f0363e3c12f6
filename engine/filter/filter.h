#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "engine/base/error.h"
#include "engine/base/job.h"
#include "engine/field/version.h"

namespace fettle::engine {

/// The global filters; what the program knows of each is a row of catalogue.h. Those up to kTotalVariation use a
/// window of n x n samples around each sample, n odd.
///
/// Of a window only the samples that exist count: none beyond the border, no hole. A hole stays a hole; every
/// other sample becomes
///   kBox       the mean of the window's samples.
///   kGaussian  their mean with weights w(dx) * w(dy), renormalised to the samples there are. sigma = 0:
///              binomial, w(d) = C(n - 1, (n - 1) / 2 + d); sigma > 0: w(d) = exp(-d^2 / (2 sigma^2)), cut at
///              the window.
///   kMedian    their median; for an even count the mean of the two middle ones.
///   kBilateral their mean with weights exp(-(dx^2 + dy^2) / (2 sigma^2)) * w(dz), renormalised; sigma = 0:
///              n / 4. dz is the sample's height less the centre's, R = range_sigma: w = (1 - dz^2 / (32
///              R^2))^16, a Gaussian of standard deviation R to within 0.019, and none beyond 5.65 R. What
///              stands out by more than that stays, outliers too. Keeps steps of some R.
///   kTotalVariation  what (n - 1) / 2 steps make of it on the way to the surface u of least sum |grad u| +
///              (u - z)^2 / (2 R) (Rudin, Osher, Fatemi 1992; the steps, and grad, in total_variation.cpp):
///              n is how far it works, R = range_sigma how strongly. Steps keep their place, a flat of side w
///              is drawn to its surroundings by some 4 R / w. No sample moves by more than 3.42 R.
///   kGeneralisedVariation  what 220 steps make of it on the way to the surface u with slopes v of least sum
///              2.2 |grad u - v| / R + 4.4 |E v| / R + ((u - z) / R)^2 / 2, the weights of jumps and creases
///              lowered four times where the surface has them (references and steps in tgv.cpp). R =
///              range_sigma is the standard deviation of the noise. Keeps flats, slopes and curved forms,
///              steps and creases; samples that belong to no surface next to them (lone_samples.h) are moved
///              to one. The lines of steps among the field's edge lines cut what holds heights together
///              (line_sides.h); the other filters do not know lines. Worked out in squares of 256 samples
///              from the field's first one, each with 48 samples around it: the squares are part of the
///              definition.
///   kPlanes    the mean of the planes, each weighted with its number of samples, that are fitted by least squares to all
///              windows of 3, 5, 7 and 11 samples on a side that cover the sample, have no hole or border in them,
///              reach over no edge line of a step, and leave no more than noise: sum of squares over R^2 <= m + 2.5
///              sqrt(2 m), m the samples less 3. R = range_sigma is the standard deviation of the noise. Keeps
///              flats, slopes, steps and creases; a sample that no such window covers stays.
///   kArealGaussian  the mean of all samples with weights exp(-pi (x^2 + y^2) / (alpha L)^2), alpha = sqrt(ln 2 / pi),
///              renormalised to the samples there are; x and y in millimetres, L = nesting_mm: the linear areal Gaussian
///              of ISO 16610-61:2015, of which a wave of length L keeps half in any direction. Ends and holes: a
///              moment criterion of order 0 (ISO 16610-28), so that a tilted surface is bent within half of L of them.
///   kRobustGaussian  the Gaussian regression filter of second order, ISO 16610-71:2014: at each sample the height of the polynomial
///              of second degree that fits the samples best, their squared distances weighted with exp(-pi (x^2 + y^2) / (alpha L)^2),
///              alpha = 0.7309, times Tukey's biweight (1 - (r / c)^2)^2 of the distance r from the surface of the round
///              before, 0 from c = 4.4478 medians of |r| on; until c changes by less than 1e-4 of itself, 50 rounds at
///              most. A wave of length L keeps half; polynomials of second degree come back, ends and holes or not. Of r is
///              taken twice what the filter without biweights takes from that surface itself at the place, where both have one sign:
///              ends and crests are no outliers (robust_weights.h). Grooves and peaks of less than half of the samples do not draw
///              it to them. The median is that of the whole field, of all |r|.
///   kOpening   how high a body rises that is rolled along the surface from below, Element: the erosion, the least height of
///              the surface over the body's around each sample, and then the dilation of that. Its peaks and ridges
///              that are narrower than the body are gone, and no sample rises. Radius R = nesting_mm, in millimetres along both
///              axes. The middle of the body lies on a sample, not beyond a border nor in a hole, so that a surface tilted by
///              an angle a sinks by up to R (1 - cos a) within R sin a of them (of a disk by the rise over R within R).
///   kClosing   the same from above: pits and grooves that are narrower than the body are filled, and no sample sinks.
///   kSpline    of all surfaces s the one of least sum of (z - s)^2 over the samples and s (Ay x Ax - 1) s, A = 1 + a^4 Q of each
///              axis, Q the square of second differences, a = 1 / (2 sin(pi spacing / L)), L = nesting_mm: the linear spline
///              filter of ISO 16610-22 along rows and then along columns. A wave of length l along an axis keeps 1 / (1 +
///              (sin(pi spacing / l) / sin(pi spacing / L))^4) of its amplitude, half at L; one askew the product
///              of those of both axes, 0.64 at L and 45 degrees. No end effects: planes come back.
///   kRobustSpline  the same with weights on the squares: those that kRobustGaussian of the same cut-off has in its last round.
///   kOutliers  itself, unless it stands apart: all but at most (n - 1) / 2 of the window's samples, itself among these, lie more
///              than R = range_sigma below it, or all but so many above it; those are more than half of the window's samples,
///              two of them lie opposite each other across it, and the nearest is farther by R than the nearest n differ
///              among each other. Where holes or the border leave no two samples opposite each other it stands apart, by R more
///              than any of them does, from the least-squares plane through those, at least three that are not on one line. Then their median; of an even number the mean of the middle two. Spikes and pits of up to
///              (n - 1) / 2 samples go; a rib or groove of one sample's width keeps all of its samples, its ends too, since
///              the window around any of them holds (n + 1) / 2 of it at least.
/// Heights are taken with the version's sign, so filtering commutes with inverting; kOpening and kClosing take those of the scan, so that
/// peaks are the same whichever way up it is.
///
/// Accuracy, against the same formula without rounding:
///   kBox       the sum is exact, whatever the heights; then two roundings in double and one to float. Error
///              <= 0.5 ulp of the result + 2^-52 of it: a constant and a plane come back bit-identical.
///   kGaussian  double throughout, one rounding to float at the end. Error <= 0.5 ulp of the result
///              + (n + 4) * 2^-51 of the largest magnitude in the window.
///   kMedian    exact, for an even count rounded once.
///   kBilateral differences and weights in float. Error <= 0.5 ulp of the result + (n + 64) * 2^-22 R,
///              wherever the heights lie; a constant and a plane of exact heights come back bit-identical.
///   kTotalVariation  slopes in float, in units of R. Error <= 0.5 ulp of the result + n * 2^-19 R (bounded
///              by the tests; in the mean over the field by the steps, none of which magnifies an error); a
///              constant comes back bit-identical.
///   kGeneralisedVariation  in float, in units of R. Error <= 0.5 ulp of the result + 0.002 R + 2^-22 of the
///              largest height of the square less its median, where noise breaks ties (a field of whole
///              numbers may fall the other way at one: 4 R). From the surface that its steps go to: 0.06 R
///              rms, 1 R at most; from the whole field worked out in one: 0.002 R. A constant comes back
///              bit-identical, a plane within 0.02 R rms, a paraboloid within 0.1 R rms.
///   kPlanes    in double, from the median of squares of 256 samples: error <= 0.5 ulp of the result + 1e-6 R where
///              heights are within 1e6 R of it and no window is within rounding of its limit. A constant and a plane
///              come back within that.
///   kArealGaussian  in double, each weight within 4e-7 of itself: error <= 0.5 ulp of the result + 1e-6 of the mean
///              distance of the window's samples from it + 4e-8 of the largest height beyond 1.1 L, where weights end. A constant
///              comes back bit-identical.
///   kRobustGaussian  rounds that begin from 1e-6 of those distances and one rounding to float elsewhere: the tests hold
///              it to 1e-5 of the limit c, where no round's end is within rounding of its limit.
///   kOpening, kClosing  a disk or square: exact. A ball: in double; error <= 0.5 ulp of the result + 2^-50 of the largest
///              height and of the ball's depth at its rim; a sample that it touches comes back bit-identical.
///   kSpline    in double: error <= 0.5 ulp of the result + 2^-49 max(L / spacing, 8) of the largest distance from the plane of the
///              heights, 1e-9 at most, and with holes 1e-7 of their standard deviation about that plane. Memory: 12 bytes per sample, 44 with
///              holes.
///   kOutliers  exact, for an even number rounded once; differences are compared with R in float.
///   kRobustSpline  within 1e-5 of the limit c, as kRobustGaussian. 48 bytes per sample.
/// Every result of kBox, kMedian and kOutliers lies between the smallest and the largest sample of its window, every one
/// of kGaussian and kBilateral does but for that error; those of the two variations
/// need not. A result equal to the sample keeps its very bits (-0 stays -0).
enum class FilterKind {
  kBox,
  kGaussian,
  kMedian,
  kBilateral,
  kTotalVariation,
  kGeneralisedVariation,
  kPlanes,
  kArealGaussian,
  kRobustGaussian,
  kOpening,
  kClosing,
  kSpline,
  kRobustSpline,
  kOutliers
};

/// The bodies of kOpening and kClosing, called structuring elements.
enum class Element {
  kBall,    ///< of radius R, in millimetres of height as well
  kDisk,    ///< horizontal, of radius R: of all samples within R
  kSquare,  ///< horizontal, of side 2 R along the axes: a segment of that length in a field of one row
};

/// What the marks mean to a filter.
enum class FilterScope {
  kKeepMarks,  ///< marked samples keep their exact bits, but count as neighbours of the others
  kOnlyMarks,  ///< only marked samples are filtered, the others keep their exact bits
};

struct FilterSpec {
  static constexpr int kMaxWindow = 1001;
  static constexpr int kMaxPasses = 1000;
  static constexpr int kMaxThreads = 1024;
  static constexpr double kLeastRange = 1e-30, kMostRange = 1e30;
  static constexpr double kLeastNesting =
      2.0;  ///< [spacings]: a wave of two samples is the shortest that there is
  static constexpr double kLeastRadius = 1.0;  ///< [spacings]: a smaller body reaches no other sample

  FilterKind kind = FilterKind::kBox;
  int window = 3;  ///< side of the window [samples], odd, 1 .. kMaxWindow; with 1 only max_change acts
  /// [samples], for the filters that have one (Filter::sigma), 0 for the others. kGaussian: 0 = binomial
  /// weights, > 0 = true Gaussian; kBilateral: 0 = window / 4.
  double sigma = 0.0;
  /// How large a difference is noise [height_unit], kLeastRange .. kMostRange for the filters that have one
  /// (Filter::range_sigma), 0 for the others. More smooths more and rounds lower steps. What a scan's own noise
  /// asks for: withMeasuredRange (noise_range.h).
  double range_sigma = 0.0;
  /// Nesting index [mm] of the filters that separate scales (Filter::nesting), the cut-off of a Gaussian, the radius of a
  /// body; 0 for the others. At least Filter::least_nesting of the field's larger spacing.
  double nesting_mm = 0.0;
  Element element = Element::kBall;  ///< of the filters that have one (Filter::has_element), else kBall
  int passes = 1;                    ///< times the filter is applied to its own result, 1 .. kMaxPasses
  FilterScope scope = FilterScope::kKeepMarks;
  /// After every pass each filtered sample is clamped to within this distance of the original sample
  /// [height_unit, finite, >= 0]; never exceeded, not even by a rounding. Nothing is clamped where the original
  /// has a hole.
  std::optional<double> max_change;
  int threads = 0;  ///< 0 = all cores; bit-identical results for any number
};

/// What a filter did, against its input, over the samples that are not holes [height_unit].
struct FilterReport {
  std::int64_t changed = 0;  ///< samples whose value differs
  double max_change = 0.0;   ///< largest |after - before|
  double rms_change = 0.0;   ///< root mean square of after - before; 0 for a field of holes
  std::int64_t samples = 0;  ///< that are not holes
  /// Of kRobustGaussian and kRobustSpline: samples that had no weight in the last round of the last pass.
  std::int64_t weightless = 0;
};

/// A robust filter whose samples without weight are more than this share of all may not follow the surface.
inline constexpr double kManyWeightless = 0.2;
/// What to say of it and to do, without a full stop; empty where they are fewer.
[[nodiscard]] std::string warningOf(const FilterReport& report);

/// The same of a cut-off that is longer than the field, where no place has all samples of its window.
[[nodiscard]] std::string warningOf(const FilterSpec& spec, const Grid& grid);

struct Filtered {
  Version field;  ///< sign, grid and memory of the input; shares each tile with it in which no bit changed
  FilterReport report;
};

/// Whether a spec can be carried out; the error names the value and its range (ErrorKind::kInput).
[[nodiscard]] Status validate(const FilterSpec& spec);
/// The same for a field of this grid: of a nesting index.
[[nodiscard]] Status validate(const FilterSpec& spec, const Grid& grid);

/// Applies a filter to a whole field. `input` and `original` are untouched and may be in use elsewhere;
/// `original` has the same width and height (asserted), and only serves spec.max_change: its sign is taken
/// into account, so it may be inverted or not. `input` itself is a fine original.
///
/// Progress counts samples times passes, as stage "filtering". A cancel is seen within about 50 ms a thread.
/// Errors: an invalid spec (kInput); memory exhausted (kFailed); cancelled (kCancelled): no result then.
/// Memory: the tiles that change, twice over when several passes run, and a scratch for each thread that
/// follows the window, never the field.
/// Threading: any thread; uses spec.threads workers of its own arena. Bit-identical from run to run.
[[nodiscard]] Result<Filtered> applyFilter(const Version& input, const Version& original,
                                           const FilterSpec& spec, JobControl& job);

}  // namespace fettle::engine
