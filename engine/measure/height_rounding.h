#pragma once

#include <initializer_list>
#include <string>
#include <string_view>

#include "engine/field/version.h"
#include "engine/measure/areal.h"

namespace fettle::engine {

/// What the rounding of heights to float does to derivatives that were measured in them, as a sentence: "heights up to 100 mm are
/// floats 7.6e-06 mm apart, which makes Sdq about 6.9 % too large, Sdr 13 %, and makes the curvature of a peak, of Spc and Svc,
/// uncertain by 60 %"; empty where rounding has less than 2 % of the mean square gradient, and of Spc and Svc.
///
/// Rounding is taken for independent from sample to sample, with a variance v of a twelfth of the square of that distance: it adds
/// 4/3 v (1/dx^2 + 1/dy^2) to the mean square gradient of bilinear cells, and scatters the mean curvature at a sample by half the
/// root of v (6/dx^4 + 6/dy^4 + 8/(dx dy)^2). Heights that floats hold exactly have less. Thread: any.
[[nodiscard]] std::string roundingDoubt(const Version& field, const ArealParameters& measured);

/// The same of an rms of heights [height_unit] that was measured in fields, in units of the first's: "heights up to 5e+06 mm are floats 0.5 mm apart, which
/// has 30 % of the square of the rms of what is left"; empty where it has less than 2 %, and where the rms is 0 or none. Of what is seen
/// under a form the heights with the form count, which were rounded. `of`: "the rms of what is left". The variance of each field's rounding is
/// added, as of independent samples. Thread: any.
[[nodiscard]] std::string roundingDoubt(std::initializer_list<const Version*> fields, double rms,
                                        std::string_view of);

}  // namespace fettle::engine
