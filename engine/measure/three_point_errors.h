#pragma once

#include "engine/field/version.h"
#include "engine/measure/region.h"
#include "engine/measure/section_noise.h"
#include "engine/measure/three_points.h"

namespace fettle::engine {

/// The errors of the slopes of planeThrough(field, points, region), with what rows and columns that are off do to the three means: a
/// mean has the same offset in all of its samples of a row, and means beside each other share rows. Of what the samples scatter
/// about the plane the part that such lines have is taken off, down to the samples' own noise where that is known, so that it does not count twice.
/// No noise of lines: the errors stay. Thread: any; time as the samples around the points.
void addLineErrors(ThreePointPlane& plane, const Version& field, const ThreePoints& points, Region region,
                   const SectionNoise& noise);

}  // namespace fettle::engine
