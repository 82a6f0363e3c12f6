#pragma once

#include <string>

#include "engine/base/error.h"
#include "engine/field/version.h"

namespace fettle::bench {

/// Files of the formats that are only read, to measure their import: as large as real ones, containing only
/// the field. Written whole or not at all; in the units of the format. Errors: kInput for paths that cannot
/// be written. Holes are left out (PCD, LAS) or marked (SUR).

/// Binary points, x and y as doubles, z as float [mm]: reads back bit-identical.
[[nodiscard]] engine::Status writePcd(const engine::Version& field, const std::string& path);

/// LAS 1.2, point format 0, coordinates in counts of 1e-5 [mm]; |coordinates| below 21 m.
[[nodiscard]] engine::Status writeLas(const engine::Version& field, const std::string& path);

/// Digital Surf, 32-bit counts of 1e-5 mm, not compressed.
[[nodiscard]] engine::Status writeSur(const engine::Version& field, const std::string& path);

}  // namespace fettle::bench
