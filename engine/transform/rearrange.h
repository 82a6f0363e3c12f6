#pragma once

#include "engine/base/error.h"
#include "engine/base/job.h"
#include "engine/field/sample_rect.h"
#include "engine/field/version.h"

namespace fettle::engine {

// Fields whose samples are those of another one, at other places: no height is changed by a bit. Signs are applied, marks
// and edge lines go with the samples. Of what is seen under a form the samples are moved, and the result is what is seen of them
// under the form at its new place (moved_form.h): a form that has none there is left out, and Version::seenOf() of the result is
// null. Errors of all: kCancelled, kFailed without memory. Thread: any; long jobs on all
// workers of the arena; the same for any number of threads.

/// The samples of a rectangle, which lies in the field, where they are in the world: the origin is that of the first one.
/// Of edge lines what is in the rectangle and near it; of a line that it cuts into several the first keeps the number.
[[nodiscard]] Result<Version> cropped(const Version& field, const SampleRect& rect, JobControl& job);

/// First mirrored, then turned.
struct Turning {
  bool mirror_x = false;  ///< left and right change places
  bool mirror_y = false;  ///< top and bottom change places
  int quarters = 0;       ///< counter-clockwise, seen from above; 0 .. 3

  [[nodiscard]] bool none() const noexcept { return !mirror_x && !mirror_y && quarters == 0; }
};

/// The field turned about its middle, which stays where it is in the world. By an odd number of quarters width and height,
/// and the spacings, change places. Its samples are then no longer at the places of the ground that a coordinate system
/// would name: the field has none.
[[nodiscard]] Result<Version> turned(const Version& field, const Turning& turning, JobControl& job);

}  // namespace fettle::engine
