#pragma once

#include <string>
#include <string_view>

#include "engine/base/error.h"
#include "engine/field/version.h"

namespace fettle::haptic {

/// What a change of edge lines makes of a version: the marks that differ (packMarkChanges, with its length in front,
/// 64 bits little-endian) and all lines afterwards (engine::packLines).
[[nodiscard]] std::string packLineChange(const engine::Version& before, const engine::Version& after);

/// `before` with these marks and lines. Errors: kInput for bytes that do not fit its grid or hold no lines, kFailed
/// when memory runs out.
[[nodiscard]] engine::Result<engine::Version> applyLineChange(const engine::Version& before,
                                                              std::string_view change);

}  // namespace fettle::haptic
