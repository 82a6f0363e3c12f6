#pragma once

#include <string>
#include <vector>

#include "engine/field/version.h"
#include "engine/io/import.h"

namespace fettle::engine {

/// Appends a warning for each way in which the units of a field cannot well be what they are said to be, by
/// what surfaces can be, not by what is usual. Samples with one of Imported::lone_values are left out: they
/// are holes more likely than heights.
///
///   heights far too steep    half of all neighbours rise by more than 10 to 1 (84 degrees); fewer than 16
///                            pairs of neighbours prove nothing. Coordinates in degrees, said or likely,
///                            or that can be degrees where no unit is known for certain: it says what was
///                            found and proposes no scale. Whole numbers: counts or
///                            brightness. Else heights in a smaller unit, which it proposes
///   heights below atoms      they span more than nothing and less than 0.01 nm
///   heights beyond planets   they span more than 100 km
///   columns beyond planets   the field is longer than the Earth is round: 40,000 km, or 360 x 180 degrees
///   columns below atoms      columns or rows lie less than 0.001 nm apart
///
/// Samples that are no lengths (isNoLength) are not asked for their heights. The first is left out where the
/// user gave z_scale or spacing. Cost: a lattice of at most 256 x 256 pairs of neighbours, whatever the size,
/// and with lone values a pass over the field.
/// The same for the same field. Thread: any.
void doubtUnits(Imported& imported, const ImportOptions& options);

/// For formats whose standard is about surface texture: a surface of metres, or over more than 100 m, is
/// none; such are heights in micrometres or millimetres written as they were. `standard` is the unit it
/// demands.
void doubtTexture(Imported& imported, const std::string& standard);

}  // namespace fettle::engine
