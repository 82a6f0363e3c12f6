#pragma once

#include <string>
#include <vector>

#include "engine/field/version.h"
#include "engine/io/height_rule.h"
#include "engine/io/import.h"

namespace fettle::engine {

/// Finds values that look like undeclared holes: each is one height, exactly equal over many samples, far
/// from all but a few others. Appends a warning for each, which names --no-data, and returns the values, so that
/// nothing else is concluded from them. All distances are from the rest: the heights without any of these
/// values. There are three criteria:
///
///   a number that programs write for holes   the lowest or highest of an integer type, 999, 9999, 99999 and
///                                            so on, their negatives, anything from 1e20 on: no nearer than
///                                            the range of the rest, for any kind of surface
///   one height among noise                   over more than 0.1 % of the samples, and farther than a tenth
///                                            of the range of the rest, but for a fiftieth as many samples
///                                            as have it; the rest must be noisy: no height in it
///                                            has more than 4 % of the samples and a quarter as many. Where
///                                            counts are coarse, its frequent heights may scatter over
///                                            neighbouring counts instead; the distance is then the range
///   far beyond the surface                   over more than 1 % of the samples, a hundred ranges of the rest
///                                            away and farther than the field is long
///
/// So the flats of a part without noise, two steps, and a deep bore or a floor below a flat plate are none.
/// Fewer than 16 samples with the value (but one is enough from 1e20 on) are no evidence; nor are, except for
/// the first criterion, fewer than 16 other heights, or more than two such values: the field is one of few
/// levels. Of more than two those over more than 1 % of the samples count.
///
/// `rule` is the one by which the file's numbers became heights: the warning gives the number in the form of
/// --no-data. Where the user gave a number, only the first criterion is checked. Cost: a lattice of at most
/// 256 x 256 samples, and passes over the field when that finds something, mostly one. Deterministic. Thread:
/// any.
std::vector<LoneValue> doubtLoneValues(const Version& field, const HeightRule& rule,
                                       std::vector<std::string>& warnings);

}  // namespace fettle::engine
