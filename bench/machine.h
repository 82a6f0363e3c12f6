#pragma once

#include <string>

namespace fettle::bench {

/// Processor, cores and compiler, for the head of every report: "Intel(R) ... x 2, GCC 12.2.0, release".
[[nodiscard]] std::string machine();

/// Bytes per second that one thread copies (read + write counted once, 64 MB at a time, best of five): the
/// memory's rate, for comparison with other rates.
[[nodiscard]] double copyBytesPerSecond();

}  // namespace fettle::bench
