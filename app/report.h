#pragma once

#include <nlohmann/json.hpp>

namespace fettle::app {

/// Results of a command or window: one object with stable keys, in reading order.
using Report = nlohmann::ordered_json;

}  // namespace fettle::app
