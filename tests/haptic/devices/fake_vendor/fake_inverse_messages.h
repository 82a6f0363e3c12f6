#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace fettle::fake {

/// The two forms of messages that the maker documents for port 10001. They differ in how a force is named (3.1 `values`, 3.5 `vector`),
/// in `session_id` of the first message, and in `status`, which 3.5 repeats in each answer.
enum class InverseForm { k31, k35 };

/// One Inverse3 and the grip on it, in the service's frame: metres, x to the right, y away from the user, z up.
struct InverseUnit {
  std::string id = "049D";
  std::array<double, 3> position_m{0.0, -0.14, 0.20};
  std::array<double, 3> velocity_m_per_s{0.0, 0.0, 0.0};
  std::array<double, 4> orientation_wxyz{1.0, 0.0, 0.0, 0.0};
  bool calibrated = true;
  bool has_grip = true;
  bool a = false, b = false, c = false;  ///< buttons of a wireless grip
};

/// What the service says on connecting: config, state and status of each device.
[[nodiscard]] std::string inventory(InverseForm form, const std::vector<InverseUnit>& units);
/// What it answers each message with.
[[nodiscard]] std::string stateUpdate(InverseForm form, const std::vector<InverseUnit>& units);

/// A force that a program asked for [N].
struct InverseForce {
  std::string id;
  std::array<double, 3> n{};
};
/// What a message of a program asks for; `against` is the rule that it breaks, empty for none.
struct InverseCommand {
  std::string against;
  bool asks_full_state = false;  ///< session.force_render_full_state: the answer is as the inventory
  std::vector<InverseForce> forces;
};
[[nodiscard]] InverseCommand readCommand(InverseForm form, std::string_view message);

}  // namespace fettle::fake
