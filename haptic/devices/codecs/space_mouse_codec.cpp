#include "haptic/devices/codecs/space_mouse_codec.h"

#include <algorithm>

namespace fettle::haptic {

namespace {

void takeAxes(std::span<const std::uint8_t> bytes, std::span<std::int16_t> axes) noexcept {
  for (std::size_t i = 0; i < axes.size(); ++i) {
    const auto raw =
        static_cast<std::int16_t>(static_cast<std::uint16_t>(bytes[1 + 2 * i] | (bytes[2 + 2 * i] << 8U)));
    // Out of range only by transmission errors; clamped to a full deflection.
    axes[i] = static_cast<std::int16_t>(std::clamp<int>(raw, -kSpaceMouseFull, kSpaceMouseFull));
  }
}

}  // namespace

bool takeSpaceMouse(std::span<const std::uint8_t> report, SpaceMouseState& state) noexcept {
  if (report.empty()) return false;
  const std::span axes(state.axes);
  switch (report[0]) {
    case 1:
      if (report.size() == 13)
        takeAxes(report, axes);
      else if (report.size() == 7)
        takeAxes(report, axes.first(3));
      else
        return false;
      return true;
    case 2:
      if (report.size() != 7) return false;
      takeAxes(report, axes.subspan(3));
      return true;
    case 3: {
      if (report.size() < 2 || report.size() > 7) return false;
      std::uint32_t bits = 0;
      for (std::size_t i = 1; i < std::min<std::size_t>(report.size(), 5); ++i)
        bits |= static_cast<std::uint32_t>(report[i]) << static_cast<unsigned>(8 * (i - 1));
      state.buttons = bits;
      return true;
    }
    default:
      return false;  // battery and others
  }
}

}  // namespace fettle::haptic
