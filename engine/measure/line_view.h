#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "engine/base/error.h"
#include "engine/base/job.h"
#include "engine/field/early_picture.h"
#include "engine/field/field_view.h"
#include "engine/field/live_field.h"
#include "engine/field/version.h"
#include "engine/measure/line_offsets.h"

namespace fettle::engine {

/// Levels the lines that are seen, so that there is a picture before all lines are levelled by all of their samples.
///
/// Offsets come from some millions of samples, one at random in each stretch of a line, at the same places in all lines. How far
/// the heights are off is estimated by how far offsets of every other of these are off them: of independent samples the variance
/// of that difference is the one that is asked for, but for the share of samples looked at, which is counted in. Where much of the
/// field is in view, the picture is the field of its means, less the means of what is taken. What was levelled for one view stays for
/// the next.
///
/// Threading: one thread at a time; a job on all workers of the arena, tenths of a second for 105 million samples, hundredths for another view.
class LineView {
 public:
  LineView(Version field, const LineOptions& options);

  /// Calls `show` once; not at all without a view, or where the whole takes no longer. Errors: those of findLineOffsets.
  [[nodiscard]] Status see(const FieldView& view, const ShowEarly& show, JobControl& job);

 private:
  [[nodiscard]] Status findOffsets(std::int32_t stretch, JobControl& job);
  [[nodiscard]] Status levelTiles(const TileRange& tiles, JobControl& job);

  const Version field_;
  const LineOptions options_;
  std::optional<LineOffsets> offsets_;
  EarlyPicture::Off off_;
  LiveField live_;
  std::vector<std::uint8_t> levelled_;  // by tile
  std::optional<EarlyPicture> means_;
};

}  // namespace fettle::engine
