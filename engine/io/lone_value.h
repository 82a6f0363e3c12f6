#pragma once

#include <string>
#include <vector>

#include "engine/field/version.h"
#include "engine/io/height_rule.h"

namespace fettle::engine {

/// Appends a warning that names --no-data for a value that looks like a hole of which the file says nothing:
/// one height, exactly the same over more than 1 % of all that are no holes, that lies farther from every
/// other height than a tenth of the range of the others. At most two such values; where there are more, the
/// field is one of few levels, and nothing is said; nor where another height is as exactly that of more than
/// 4 % of the samples and of a quarter as many, as the flats of a part without noise are. Fewer than 16
/// samples with the value, or than 16 other heights, prove nothing.
///
/// `rule` is the one by which the file's numbers became heights: the warning names the number as --no-data
/// takes it. Cost: a lattice of at most 256 x 256 samples, and one pass over the field when that finds
/// something. The same for the same field. Thread: any.
void doubtLoneValues(const Version& field, const HeightRule& rule, std::vector<std::string>& warnings);

}  // namespace fettle::engine
