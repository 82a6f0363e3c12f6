#pragma once

namespace fettle::engine {

/// Asks for the cache line at `at`, which need not be readable; waits for nothing. Not __builtin_prefetch alone: a function that does
/// nothing else GCC 12 takes for one without effects, and drops its calls.
inline void fetchAhead(const void* at) noexcept {
#if defined(__GNUC__) && defined(__x86_64__)
  asm volatile("prefetcht0 %0" : : "m"(*static_cast<const char*>(at)));
#else
  __builtin_prefetch(at);
#endif
}

}  // namespace fettle::engine
