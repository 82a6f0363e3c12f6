#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "engine/base/error.h"
#include "engine/measure/material_ratio.h"
#include "engine/measure/section.h"
#include "engine/measure/section_figures.h"

namespace fettle::engine {

/// The mean line of a profile by the Gaussian profile filter of ISO 16610-21:2011: weights
/// exp(-pi (x / (a c))^2) / (a c), a = sqrt(ln 2 / pi), for the cut-off length c, at which a sine passes by a half.
/// The weights reach to one cut-off on both sides, where they are 6e-7 of the middle one, and their sum is 1; within
/// one cut-off of an end they are those that are left, divided by their sum. `heights` evenly `step_mm` apart, without
/// NaN; cutoff_mm > 0. Time: heights times places per cut-off.
[[nodiscard]] std::vector<double> gaussianMeanLine(std::span<const double> heights, double step_mm,
                                                   double cutoff_mm);

/// The profiles of ISO 21920-2, whose parameters differ by their first letter alone.
enum class ProfileKind : std::uint8_t { kRoughness, kPrimary, kWaviness };

/// One row per profile.
struct ProfileInfo {
  ProfileKind kind;
  std::string_view word;  ///< "roughness"
  char letter;            ///< of its parameters: 'R', 'P', 'W'
  std::string_view text;  ///< what it is, for the user
  bool by_cutoff;         ///< a cut-off makes it; the primary profile has none
};
[[nodiscard]] std::span<const ProfileInfo> profileInfos() noexcept;
[[nodiscard]] const ProfileInfo& profileInfo(ProfileKind kind) noexcept;

/// The Gaussian filters that make a profile of a section.
struct ProfileFilters {
  double cutoff_mm =
      0.0;  ///< lambda c: longer waves are taken out of a roughness profile, shorter ones of waviness
  double lambda_s_mm = 0.0;  ///< S-filter: shorter waves are taken out first; 0: none
  ProfileKind kind = ProfileKind::kRoughness;
};

/// A profile as far as it is evaluated.
struct RoughnessProfile {
  Stretch
      evaluated;    ///< a whole number of section lengths, each one cut-off; of the others one section length
  int lengths = 0;  ///< of these
  std::vector<double> heights;  ///< about their mean by the trapezoidal rule [mm]
  std::vector<std::size_t>
      lengths_begin;  ///< places at which section lengths begin, and where the last one ends: lengths + 1
};

/// Of a stretch of a section: its least-squares line is taken out, then it is filtered by the S-filter (ISO 16610-21, which leaves the primary
/// profile of ISO 21920-2: that of kPrimary), then its Gaussian mean line is taken out, or is what is left of kWaviness. At both ends, where a filter lacks neighbours (end effects
/// of ISO 16610-21 and -28: weights are those that are left), half a lambda s is cut off before the mean line is found, and
/// half a cut-off is not evaluated, of the primary profile all is. Where the stretch has places without a height, its longest part without one counts.
/// Errors (kInput): a cut-off or a lambda s shorter than 4 places (ISO 21920-3 has 5 and more), a lambda s not below the
/// cut-off, a cut-off longer than half of the part; a primary profile of fewer than 4 places.
[[nodiscard]] Result<RoughnessProfile> roughnessProfile(const Section& section, const Stretch& within,
                                                        const ProfileFilters& filters);

/// Profile parameters of ISO 21920-2:2021, named as those of the roughness profile [mm]. NaN where the profile does not determine a figure. Means along the profile are integrals by
/// the trapezoidal rule: the places at both ends count half.
struct Roughness {
  Stretch evaluated;  ///< as of RoughnessProfile
  int lengths = 0;
  double ra = 0.0, rq = 0.0;
  /// Means of the section lengths' highest (rp), of their lowest below the mean line (rv), and the sum of both (rz).
  double rz = 0.0, rp = 0.0, rv = 0.0;
  double rzx = 0.0;  ///< the greatest height of a section length (Rmax before)
  double rt = 0.0;   ///< from the lowest to the highest of the evaluation length
  double rsk = 0.0, rku = 0.0;
  /// Mean width and height of the profile elements, from one rise (fall) through the mean line to the next, over all of the evaluation
  /// length; peaks and dales lower than a tenth of rz count to their neighbours.
  double rsm = 0.0, rc = 0.0;
  /// Root mean square of the slope, found at each place from three on either side (the formula of ISO 4287:1997, 4.4.1).
  double rdq = 0.0;
  /// Of the material ratio curve (material_ratio.h); ratios 0 .. 1.
  double rk = 0.0, rpk = 0.0, rvk = 0.0, rmrk1 = 0.0, rmrk2 = 0.0;
  // Of the material ratio curve by lengths (profile_ratio.h), as many as were asked for.
  std::vector<double> ratios;       ///< Rmr(c), 0 .. 1
  std::vector<double> differences;  ///< Rdc(p, q) [mm]
};

/// What is asked for of the material ratio curve of a profile.
struct AskedRatios {
  std::vector<double> at_heights_mm = {};  ///< for Rmr(c), about the mean line
  std::vector<RatioPair> between = {};     ///< for Rdc(p, q), the height of p less that of q
};

/// One row per figure of Roughness, in the order in which they are shown. Key and symbol are those of the roughness profile; of another one the first
/// letter is its own.
struct RoughnessInfo {
  enum class Unit : std::uint8_t {
    kHeight,
    kAlong,
    kNone,
    kRatio
  };                        ///< mm in z, mm along the line, a number, 0 .. 1
  std::string_view key;     ///< "ra"
  std::string_view symbol;  ///< "Ra"
  Unit unit;
  double Roughness::*figure;
  std::string_view text;  ///< what it is, for the user
};
[[nodiscard]] std::span<const RoughnessInfo> roughnessInfos() noexcept;

/// Of roughnessProfile(), with its errors.
[[nodiscard]] Result<Roughness> roughnessOf(const Section& section, const Stretch& within,
                                            const ProfileFilters& filters, const AskedRatios& asked = {});

}  // namespace fettle::engine
