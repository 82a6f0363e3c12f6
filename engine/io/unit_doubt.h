#pragma once

#include <string>

#include "engine/field/version.h"
#include "engine/io/import.h"

namespace fettle::engine {

/// Appends a warning for each way in which the stated units of a field are implausible, by what is physically
/// possible, not by what is usual. Samples with one of Imported::lone_values are left out: they are holes
/// more likely than heights.
///
///   heights far too steep    half of all neighbours rise by more than 10 to 1 (84 degrees); fewer than 16
///                            pairs of neighbours are no evidence. Coordinates in degrees, stated or likely,
///                            or possibly in degrees where no unit is certain: the warning states what was
///                            found and proposes no scale. Whole numbers: counts or brightness. Otherwise
///                            heights in a smaller unit, which it proposes
///   heights below atoms      they span more than nothing and less than 0.01 nm
///   heights beyond planets   they span more than 100 km
///   columns beyond planets   the field is longer than the circumference of the Earth: 40,000 km, or 360 x 180
///                            degrees
///   columns below atoms      columns or rows lie less than 0.001 nm apart
///
/// Samples that are not lengths (isNoLength) are not checked for their heights. The first criterion is
/// omitted where the user gave z_scale or spacing. Cost: a lattice of at most 256 x 256 pairs of neighbours
/// for any size, and with lone values a pass over the field. Deterministic. Thread: any.
void doubtUnits(Imported& imported, const ImportOptions& options);

/// For formats whose standard is about surface texture: a surface of metres, or over more than 100 m, is
/// implausible; such values are micrometres or millimetres written without conversion. `standard` is the unit
/// that the standard requires.
void doubtTexture(Imported& imported, const std::string& standard);

}  // namespace fettle::engine
