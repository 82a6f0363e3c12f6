#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <glm/vec3.hpp>

namespace fettle::haptic {

/// One Inverse3 in a message of Haply's service.
struct Inverse3State {
  std::string device_id;
  std::optional<glm::dvec3> position_m;  ///< finite; nothing when the message carries none
  std::optional<bool> calibrated;        ///< stated in the first message of a connection
};

/// A message of the service.
struct Inverse3Message {
  std::vector<Inverse3State> devices;
  std::uint32_t buttons = 0;  ///< of the first grip that states some: bit 0 = a, bit 1 = b, bit 2 = c
};

/// Nothing when it is not one: no JSON object, or entries of another form. Allocates; throws std::bad_alloc only.
[[nodiscard]] std::optional<Inverse3Message> decodeInverse3(std::string_view text);

/// The message that sets the force [N] and asks for the next state.
[[nodiscard]] std::string encodeInverse3(std::string_view device_id, const glm::dvec3& force_n);

}  // namespace fettle::haptic
