#pragma once

#include <string>

#include "engine/base/error.h"

namespace fettle::engine {

/// The system that a person names: WKT of any version, as it stands, or a registered code, "EPSG:28992", as WKT 2.
/// Reads no file and no network. Errors: kInput. Thread: any.
[[nodiscard]] Result<std::string> crsOf(const std::string& text);

}  // namespace fettle::engine
