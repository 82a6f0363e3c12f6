#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "engine/base/error.h"
#include "engine/base/job.h"
#include "engine/field/sample_rect.h"
#include "engine/field/version.h"
#include "engine/inspect/noise_model.h"
#include "engine/measure/areal.h"
#include "engine/uncertainty/noise_trial.h"

namespace fettle::engine {

// What noise does to the parameters of a field that is too large to be measured several times: by trials on a part of it, whose
// time is the same for any size. A part alone need not be like the whole: a level one between steps has another core roughness. So
// the part is a stratified one, a square from each of 16 equal parts of the field, at a random place in it (W. Cochran, Sampling
// techniques, 1977, chapter 5), measured together about the form and filters of the whole; by how much its figures
// differ from those of the whole says how far it stands for it, and goes into the errors (partEffectOf).

struct PartOptions {
  std::int32_t side = 180;  ///< of a square, or as many samples where the field is narrower [samples]
  int squares = 4;          ///< along each side; as many in all where the field is narrower
  int pairs = 2;            ///< as NoiseTrialOptions
  std::uint64_t seed = 1;
};

/// The squares of a field: one from each of its equal parts; not more than it has samples for.
[[nodiscard]] std::vector<SampleRect> standingSquares(const Grid& grid, const PartOptions& options);

/// Squares of a field beside each other, in rows of as many as there are along it, with holes between them that are half as wide as they: so
/// no lag up to that joins two of them.
[[nodiscard]] Version besideEachOther(const std::vector<Version>& squares, int across);

struct PartEffects {
  std::vector<NoiseEffect> effects;  ///< as of arealEffects()
  std::int64_t samples = 0;          ///< of the part, with a height
};

/// noiseEffectOf() of trials on a part of the surface that stands for all of it: `of_part` is the part's figure, `share` of all samples are
/// in it. Noise raises the whole by as much as the part, and scatters it by the root of the share of that. The error counts besides that
/// the raise is known from a few trials on the part alone, and by as much of it as the part's figure differs from the
/// whole's.
[[nodiscard]] NoiseEffect partEffectOf(double found, double of_part, std::span<const TrialPair> pairs,
                                       NoiseGrowth growth, double share, const TrialKnowledge& known = {});

/// `field`: the scan; `noise`: its noise; `surface`: its surface about form and filters, with holes where no sample counts; `measured`: what
/// measureAreal() of that, with `options`, gave. `surface_of`: makes the surface of a piece of the field as that of the whole was made; the
/// difference that noise makes in it counts, so that ends of filters and another form do not. Greatest and least heights are not of the part: of the whole surface
/// those within ten standard deviations of the noise are counted, and noise is drawn for these. Spatial parameters of longer reach
/// than half a square have no effect (NaN), nor has what the part does not determine.
///
/// Time: that of measuring some 1.2 million samples 2 pairs + 1 times, whatever the size of the field, and one look at all its samples.
/// Bit-identical for any number of threads. Errors: kFailed without memory; kCancelled. Thread: any; a long job.
[[nodiscard]] Result<PartEffects> arealEffectsOfPart(
    const Version& field, const NoiseModel& noise, const Version& surface, const ArealParameters& measured,
    const ArealOptions& options, const std::function<Result<Version>(const Version& piece)>& surface_of,
    const PartOptions& how, JobControl& job);

}  // namespace fettle::engine
