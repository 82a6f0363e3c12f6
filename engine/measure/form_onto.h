#pragma once

#include <optional>

#include "engine/field/grid.h"
#include "engine/field/nominal_form.h"
#include "engine/measure/rigid_motion.h"

namespace fettle::engine {

/// A form that was moved in space, over the samples of another field.
struct FormOnto {
  NominalForm form;
  /// How far it is from the moved form at most, where the field that it was of lies, by 25 x 25 places [mm]: of a polynomial of
  /// degree 2 and more that was tilted, which is none of its degree any more; else 0.
  double off_mm = 0.0;
};

/// The form over a field with the grid `own`, moved as the heights of that field are (movedOnto()), over the samples of `onto` and
/// in its height unit; both upright. A plane stays one, a sphere, cylinder or cone stays one, and a polynomial as long as it is not tilted:
/// shifted and rotated about z it is the same polynomial at other places. A tilted one is interpolated by one of its degree at 12 x 12 Chebyshev places
/// where the field lies (J. Mason and D. Handscomb, Chebyshev Polynomials, 2002, section 6.3), off by about what the tilt times the form's height times its
/// slope has of degrees beyond. Beyond its outline a shape is continued as always, which is then seen from another side.
///
/// None: a surface that overhangs after the tilt, a shape that is nearly upright there, one whose field has another
/// spacing than it was found with, a motion that leaves nothing of it over `onto`. Throws std::bad_alloc. Thread: any.
[[nodiscard]] std::optional<FormOnto> formOnto(const NominalForm& form, const Grid& own,
                                               const RigidMotion& motion, const Grid& onto);

}  // namespace fettle::engine
