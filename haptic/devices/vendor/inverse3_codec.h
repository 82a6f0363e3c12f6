#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <glm/gtc/quaternion.hpp>
#include <glm/vec3.hpp>

namespace fettle::haptic {

/// One Inverse3 in a message of Haply's service.
struct Inverse3State {
  std::string device_id;
  std::optional<glm::dvec3> position_m;  ///< finite; nothing when the message carries none
  std::optional<bool> calibrated;        ///< stated in the first message of a connection; by 3.5 in each
};

/// How a service names the force of a command: 3.1 `values`, 3.5 `vector`. A name that it does not know is left out by it.
enum class Inverse3Form : std::uint8_t { kValues, kVector };

/// A message of the service.
struct Inverse3Message {
  /// By `session_id`, which a service that documents `vector` states in the first message of a connection.
  Inverse3Form form = Inverse3Form::kValues;
  std::vector<Inverse3State> devices;
  // Of the first grip.
  std::uint32_t buttons = 0;              ///< bit 0 = a, bit 1 = b, bit 2 = c
  std::optional<glm::dquat> orientation;  ///< as DeviceInput::orientation
};

/// Nothing when it is not one: no JSON object, or entries of another form. Allocates; throws std::bad_alloc only.
[[nodiscard]] std::optional<Inverse3Message> decodeInverse3(std::string_view text);

/// Whether the answer is to state config and status too, as the first message of a connection does.
enum class Inverse3Asks : std::uint8_t { kState, kFullState };

/// The message that sets the force [N] and asks for the next state.
[[nodiscard]] std::string encodeInverse3(Inverse3Form form, std::string_view device_id,
                                         const glm::dvec3& force_n, Inverse3Asks asks = Inverse3Asks::kState);

}  // namespace fettle::haptic
