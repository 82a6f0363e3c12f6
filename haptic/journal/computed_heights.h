#pragma once

#include <variant>

#include "engine/base/error.h"
#include "engine/base/job.h"
#include "engine/field/version.h"
#include "engine/fill/fill.h"
#include "engine/measure/line_offsets.h"
#include "engine/measure/lines_apart.h"
#include "engine/remove/remove.h"

namespace fettle::haptic {

/// What makes the heights of a step anew from those before it, by its numbers alone: holes filled, lines levelled, samples removed.
using HeightsMaker = std::variant<engine::FillOptions, engine::LineOptions, engine::RemoveOptions>;

/// A field with other heights, and what was found.
struct ComputedHeights {
  engine::Version field;  ///< of the memory of the field before, sharing the tiles that stay
  engine::Filled filled;  ///< of holes; its field is empty
  double rows_rms = 0.0,
         rows_form_rms = 0.0;     ///< of levelled lines, and of the form across them that stays [height_unit]
  engine::LinesApart rows_apart;  ///< of levelled lines
  engine::RemoveCounts removed;
};

/// Makes them, as `fettle fill`, `fettle level --rows` and `fettle remove` do, and as a replay does again: bit-identical for any number of
/// threads. Edge lines, sign and form stay, and marks but those of samples that are removed. Errors: those of engine::fillHoles,
/// engine::findLineOffsets and engine::removeSamples. Thread: any; a long job on all workers.
[[nodiscard]] engine::Result<ComputedHeights> computeHeights(const engine::Version& before,
                                                             const HeightsMaker& maker,
                                                             engine::JobControl& job);

}  // namespace fettle::haptic
