#pragma once

#include <cstdint>
#include <span>

#include "engine/base/error.h"
#include "engine/field/version.h"

namespace fettle::bench {

/// A number that looks random, of a place.
[[nodiscard]] std::uint32_t randomBits(std::int32_t c, std::int32_t r) noexcept;

struct HoleKind {
  const char* name;
  bool (*isHole)(std::int32_t c, std::int32_t r, std::int32_t side);
};

/// Single samples at random (one in twenty), discs of 2 to 6 samples' radius, scratches of 3 samples' width along the field,
/// one disc of 60,000 samples.
[[nodiscard]] std::span<const HoleKind> holeKinds() noexcept;

/// A waved field with such holes, `side` samples square. Errors: kFailed without memory.
[[nodiscard]] engine::Result<engine::Version> holedField(std::int32_t side, const HoleKind& kind);

}  // namespace fettle::bench
