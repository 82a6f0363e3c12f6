#pragma once

#include <cstdint>
#include <string>

namespace fettle::engine {

/// Memory that this process may still take [bytes]: the system's figure of available memory, or the rest of
/// the control group's limit (its file cache counts as free) if that is less. 0 if neither is known. Reads
/// files, those of this system or, below `root`, of another; any thread.
[[nodiscard]] std::uint64_t availableMemory(const std::string& root = {});

/// Memory of this process [bytes]; 0 where the system does not report it. Any thread.
struct ResidentMemory {
  std::uint64_t now = 0;   ///< all of it
  std::uint64_t peak = 0;  ///< since the start, or since the last resetPeak()
  std::uint64_t own = 0;   ///< the part that is not backed by a file: heap, stacks
};
[[nodiscard]] ResidentMemory residentMemory();

/// Gives memory that the heap holds for later back to the system, so that ResidentMemory shows what is in use. Any thread.
void releaseFreeMemory();

/// From now on the heap keeps memory that is given back to it, up to 256 MiB, and takes more in steps of 16 MiB: for a program
/// that draws beside others of its threads that fill new pages. Each such page holds up who asks the system for memory, and a frame
/// asks as often as it crosses the heap's end.
void keepFreeMemory() noexcept;

/// Restarts ResidentMemory::peak; false where the system cannot.
bool resetPeak();

}  // namespace fettle::engine
