#pragma once

#include <string>
#include <string_view>

#include "engine/base/error.h"
#include "engine/field/version.h"

namespace fettle::haptic {

/// The samples whose marks differ between two versions of one grid, and what they are afterwards: for each
/// tile with any, its column and row [32-bit little-endian each] and twice 512 bytes, one bit per sample,
/// row-major: which change, and to what. Size proportional to the number of differences; a session keeps them
/// compressed.
[[nodiscard]] std::string packMarkChanges(const engine::Version& before, const engine::Version& after);

/// `before` with these samples' marks as they were afterwards. Errors: kInput for bytes that do not fit its
/// grid, kFailed when memory runs out.
[[nodiscard]] engine::Result<engine::Version> applyMarkChanges(const engine::Version& before,
                                                               std::string_view changes);

/// What a change of edge lines makes of a version: the marks that differ (packMarkChanges, with its length in front,
/// 64 bits little-endian) and all lines afterwards (engine::packLines).
[[nodiscard]] std::string packLineChange(const engine::Version& before, const engine::Version& after);

/// `before` with these marks and lines. Errors: kInput for bytes that do not fit its grid or hold no lines, kFailed
/// when memory runs out.
[[nodiscard]] engine::Result<engine::Version> applyLineChange(const engine::Version& before,
                                                              std::string_view change);

}  // namespace fettle::haptic
