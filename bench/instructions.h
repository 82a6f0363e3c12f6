#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string_view>

namespace fettle::bench {

/// How instructions were counted.
enum class CountedBy : std::uint8_t {
  kNothing,  ///< not counted: neither method is permitted here
  kCounter,  ///< the processor's own counter, by perf_event_open
  kSteps,    ///< one by one, a traced copy of the process (ptrace)
};

/// "not available", "processor counter", "single steps".
[[nodiscard]] std::string_view countedByName(CountedBy by) noexcept;

struct InstructionCount {
  std::optional<std::int64_t> instructions;  ///< in user space; none when by is kNothing
  CountedBy by = CountedBy::kNothing;
};

/// Instructions that `work` takes in user space, the call itself included; code of other threads is not.
///
/// By the processor's counter where the system allows it. Else `work` is run in a forked copy of the process
/// that is stepped through one instruction at a time, 50,000 to 200,000 per second: keep it short. Then
/// changes made by `work` are lost with the copy; it must not wait for another thread, since the copy has
/// none. The cost of two markers around an empty call is counted too and subtracted. Thread: any; blocks.
[[nodiscard]] InstructionCount countInstructions(const std::function<void()>& work);

}  // namespace fettle::bench
