#pragma once

#include <cstdint>

namespace fettle::tests {

/// While one lives, the allocator fails on this thread: malloc and its family (operator new stands on it)
/// return null, and every such call, free included, is counted. Not under sanitizers, which bring an
/// allocator of their own: allocationGuardWorks() says so.
class AllocationGuard {
 public:
  AllocationGuard() noexcept;
  ~AllocationGuard();
  AllocationGuard(const AllocationGuard&) = delete;
  AllocationGuard& operator=(const AllocationGuard&) = delete;

  /// Calls of the allocator under a guard, by any thread so far.
  [[nodiscard]] static std::uint64_t calls() noexcept;
};

[[nodiscard]] bool allocationGuardWorks() noexcept;

}  // namespace fettle::tests
