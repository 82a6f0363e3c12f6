#pragma once

#include <array>
#include <cstdint>
#include <span>

namespace fettle::haptic {

/// A full deflection of the cap, either way, in the counts of its reports.
inline constexpr int kSpaceMouseFull = 350;

/// State of a SpaceMouse according to its reports: deflections of the cap, not positions.
struct SpaceMouseState {
  /// x right, y towards the user, z down; then turns about them; -kSpaceMouseFull .. kSpaceMouseFull.
  std::array<std::int16_t, 6> axes{};
  std::uint32_t buttons = 0;  ///< bit 0 left, bit 1 right on the two-button ones
};

/// Updates `state` by one report. Both forms, distinguished by length and not by product: 7 bytes (id 1 =
/// translation, id 2 = rotation, three int16 each) and 13 bytes (id 1 = all six). Id 3: button bits. False
/// when it is none of these: `state` is unchanged. Sources: FreeSpacenav/spacenavd src/dev.c, PySpaceMouse
/// devices.toml.
[[nodiscard]] bool takeSpaceMouse(std::span<const std::uint8_t> report, SpaceMouseState& state) noexcept;

}  // namespace fettle::haptic
