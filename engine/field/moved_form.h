#pragma once

#include <cstdint>
#include <optional>

#include "engine/field/nominal_form.h"
#include "engine/field/place_map.h"

namespace fettle::engine {

/// The form of a field over a new one of width x height samples: at each of them the height that it had at the old place.
///
/// Exact but for rounding: a polynomial of a degree is one of the same degree at the new places (its terms are multiplied out in
/// Chebyshev's polynomials, which loses some 1e-15 of the largest coefficient); a shape in space is the same shape, seen from the same
/// side. Its foot stays where it lies over the new field, else another point of the surface over that takes its place: a
/// shape is never farther from its foot than 16 diagonals of its field (shape_form.h).
///
/// None: of a shape where places are stretched or sheared, so that it would be none; where the new field shows so little of
/// it that its height there is out of that bound. Thread: any.
[[nodiscard]] std::optional<NominalForm> movedForm(const NominalForm& form, const PlaceMap& places,
                                                   std::int32_t width, std::int32_t height);

/// The polynomial at new places, and multiplied: what movedForm() has of one.
[[nodiscard]] PolynomialForm movedPolynomial(const PolynomialForm& form, const PlaceMap& places,
                                             std::int32_t width, std::int32_t height);

/// The shape about a foot over its field, where its own lies elsewhere and one can be found; else itself.
[[nodiscard]] ShapeForm withFootInside(const ShapeForm& form);

}  // namespace fettle::engine
