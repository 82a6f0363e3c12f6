#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "engine/base/error.h"
#include "engine/base/job.h"
#include "engine/field/early_picture.h"
#include "engine/field/field_view.h"
#include "engine/field/version.h"
#include "engine/fill/fill.h"
#include "engine/fill/hole_filler.h"

namespace fettle::engine {

/// Fills holes that are seen, so that there is a picture before fillHoles() has filled all.
///
/// Holes that lie in the view and a margin around it come with the bits of fillHoles(), the nearest to the middle first. Those of so many samples that
/// one keeps the others waiting are approximated before (coarseHole), with the error that this estimates, and come with the whole; those that
/// reach farther than the margin come with it alone, and of a view of most of the field what is not filled within a second, since that is
/// filled once more with the whole. What was filled for one view stays for the next.
///
/// Where much of a large field is in view, the picture is the field of its means, holes of these filled by the same rules: holes
/// within a cell are not seen there, edge lines no wall. How far filled cells are off is measured on the holes nearest to the
/// middle, which are filled for it; where only large ones are there, against the filled means of four cells each.
///
/// Threading: one thread at a time; a job on all workers of the arena, tenths of a second for 105 million samples.
class FillView {
 public:
  FillView(Version field, const FillOptions& options);

  /// Calls `show` with each picture of what is in view. Of the first view not at all without heights, or where nothing in view is filled
  /// before the whole. Errors: kCancelled; kFailed without memory.
  [[nodiscard]] Status see(const FieldView& view, const ShowEarly& show, JobControl& job);

 private:
  struct Approximated {
    HoleRun first;  // of the hole: no other one begins there, in whatever part of the field it was found
    SampleRect box;
    double squares = 0.0;  // as CoarseHole
    std::int64_t compared = 0;
  };
  [[nodiscard]] const Approximated* approximatedAt(const HoleRun& first, bool cut) const noexcept;

  [[nodiscard]] Status seeSamples(const FieldView& view, const ShowEarly& show, JobControl& job);
  [[nodiscard]] Status seeMeans(const FieldView& view, const ShowEarly& show, JobControl& job);

  const Version field_;
  const FillOptions options_;
  HoleFiller filler_;
  std::vector<Approximated> approximated_;
  bool shown_ = false;
  bool has_means_ = false;
  std::optional<EarlyPicture> means_;  // empty: no cell is filled
};

}  // namespace fettle::engine
