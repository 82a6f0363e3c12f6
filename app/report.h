#pragma once

#include <nlohmann/json.hpp>

namespace fettle::app {

/// What a command or a window found out: one object with stable keys, in the order in which people read them.
using Report = nlohmann::ordered_json;

}  // namespace fettle::app
