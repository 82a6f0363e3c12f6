#pragma once

#include <cstdint>

namespace fettle::engine {

/// Memory that this process may still take [bytes]: what the system calls available, or what is left of the
/// control group's limit, its file cache not counted as taken, if that is less. 0 if neither is known. Reads
/// files; any thread.
[[nodiscard]] std::uint64_t availableMemory();

/// Memory of this process [bytes]; 0 where the system does not say. Any thread.
struct ResidentMemory {
  std::uint64_t now = 0;   ///< all of it
  std::uint64_t peak = 0;  ///< since it began, or since the last forgetPeak()
  std::uint64_t own = 0;   ///< the part that no file could give back: heap, stacks
};
[[nodiscard]] ResidentMemory residentMemory();

/// Lets ResidentMemory::peak begin anew; false where the system cannot.
bool forgetPeak();

}  // namespace fettle::engine
