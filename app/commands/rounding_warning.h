#pragma once

#include <initializer_list>
#include <string>
#include <string_view>

#include "engine/field/version.h"

namespace fettle::app {

/// Warns of what the rounding of heights to float does to figures: a sentence of engine::roundingDoubt(); nothing where it is empty.
void warnOfRounding(const std::string& doubt, const std::string& scan);
/// The same of an rms [height_unit of the first field].
void warnOfRounding(std::initializer_list<const engine::Version*> fields, double rms, std::string_view of,
                    const std::string& scan);

}  // namespace fettle::app
