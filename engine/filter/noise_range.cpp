#include "engine/filter/noise_range.h"

#include <algorithm>

#include "engine/filter/catalogue.h"

namespace fettle::engine {

Result<FilterSpec> withMeasuredRange(const FilterSpec& spec, const Version& field, JobControl& job) {
  if (!hasRange(spec.kind) || spec.range_sigma != 0.0) return spec;
  const auto noise = estimateNoise(field, job);
  if (!noise) return tl::unexpected(noise.error());
  return withRangeOf(spec, *noise);
}

Result<FilterSpec> withRangeOf(const FilterSpec& spec, const NoiseEstimate& noise) {
  if (!(noise.sigma > 0.0))
    return inputError("no noise can be seen in the scan that a range sigma could follow", "range-sigma",
                      "give one, in the scan's height unit");
  const Filter& filter = filterOf(spec.kind);
  FilterSpec ready = spec;
  ready.range_sigma =
      std::clamp(noise.sigma * filter.noises, filter.range_sigma.least, filter.range_sigma.most);
  return ready;
}

}  // namespace fettle::engine
