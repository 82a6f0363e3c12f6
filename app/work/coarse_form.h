#pragma once

#include <cstdint>
#include <string>

#include "engine/base/error.h"
#include "engine/base/job.h"
#include "engine/field/version.h"
#include "engine/measure/form_fit.h"

namespace fettle::app {

/// A form of a field so large that fitting it and working out its surface keep people waiting, from means of its samples.
struct CoarseForm {
  engine::Version means;    ///< of the field, in its place in a picture (engine::meansOf)
  engine::Version surface;  ///< the form over these
  std::int32_t step = 1;    ///< samples on a side of a mean
  /// How far the surface is from one that is fitted to a quarter of the means, rms [height_unit].
  double off_rms = 0.0;
};

/// "approximate, off by about 3.2 um rms".
[[nodiscard]] std::string coarseFormState(const CoarseForm& form);

/// Whether previews of a field begin so.
[[nodiscard]] bool formTakesLong(const engine::Grid& grid) noexcept;

/// `field` has no form over it. Errors as engine::fitNominalForm. A long job of some tenths of a second.
[[nodiscard]] engine::Result<CoarseForm> coarseForm(const engine::Version& field,
                                                    const engine::FormChoice& choice,
                                                    engine::JobControl& job);

}  // namespace fettle::app
