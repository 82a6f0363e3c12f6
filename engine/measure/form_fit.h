#pragma once

#include <cstdint>
#include <optional>

#include "engine/base/error.h"
#include "engine/base/job.h"
#include "engine/field/nominal_form.h"
#include "engine/field/version.h"
#include "engine/measure/fit.h"
#include "engine/measure/form_figures.h"
#include "engine/measure/form_kind.h"
#include "engine/measure/region.h"
#include "engine/measure/three_points.h"

namespace fettle::engine {

/// Which form, and the samples that count.
struct FormChoice {
  FormKind kind = FormKind::kPlane;
  Region region = Region::kAll;
  bool robust = false;  ///< steps, spikes and other samples far from the form do not count
  /// A plane through three means of heights, those of the region; not with `robust`.
  std::optional<ThreePoints> through = {};

  friend bool operator==(const FormChoice&, const FormChoice&) = default;
};

/// A form of a field, fitted to the samples of a region.
struct FittedForm {
  NominalForm form;
  std::int64_t samples = 0;  ///< of the region
  double rms = 0.0;  ///< of the region's samples about the form, each with the same weight [height_unit]
  /// Of a robust polynomial of the samples that count alone, of a shape of their distances as they were fitted [height_unit]; without `robust` of all.
  double rms_counted = 0.0;
  int rounds = 1;   ///< of weights, of a polynomial
  int numbers = 0;  ///< of the form that the region's samples decide; 0 of a plane through three points
  /// Of a plane whose samples lie on one line, which they leave open, as a sentence: "3 samples decide 2 of the 3 terms of a plane
  /// and leave y open"; else empty. It is the flattest of those that come nearest to them then, as fitForm().
  std::string open = {};
  /// Of a polynomial of a region beyond which it leaves the heights of the field by more than their range, as a sentence: "poly4
  /// reaches from -302 to 312 mm over the field, whose heights are from 0 to 18 mm"; else empty. Found on 33 x 33 places.
  std::string leaves = {};
  std::optional<ShapeFit> fit;  ///< of a shape
  std::int64_t beyond = 0;      ///< samples of the region beyond the outline of the shape (shape_form.h)
  /// Of a plane through three points: `samples` and `rms` are those of the samples around these.
  std::optional<ThreePointPlane> through = {};
};

/// A polynomial by fitForm() (form.h), of heights; a shape by fitShape() (fit.h), of orthogonal distances, as `fettle fit` has
/// it and ISO 25178-3 for the F-operation: a steep flank then counts no more than a flat one; a plane through three points by
/// planeThrough() (three_points.h), which names "through" where it refuses. Signs applied.
///
/// A shape is fitted to at most some four million samples, evenly spread over larger regions: its figures then have the standard
/// errors of as many. Refused (kInput): a region without samples; a polynomial of degree 2 and more, some terms of which the samples
/// leave open, by the names of these (a field of one row has none across it); what the samples do not determine, as fitShape; a shape
/// that is steeper than 87 degrees where its samples lie, as an upright cylinder, since it has no height above a place.
/// Errors else, accuracy, threads and cost as of those two; one more pass.
[[nodiscard]] Result<FittedForm> fitNominalForm(const Version& field, const FormChoice& choice,
                                                JobControl& job);

/// How a fitted form is tilted, with errors of a plane through three points; none of a shape, and of a mean height.
[[nodiscard]] std::optional<Tilt> tiltOf(const FittedForm& fit, const Grid& grid);

/// The form that a fitted sphere, cylinder or cone is over a field of this grid. Errors: one that is too steep (kInput).
[[nodiscard]] Result<ShapeForm> formOfShape(const ShapeFit& fit, const Grid& grid);

}  // namespace fettle::engine
