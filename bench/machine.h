#pragma once

#include <string>

namespace fettle::bench {

/// Processor, cores and compiler, for the head of every report: "Intel(R) ... x 2, GCC 12.2.0, release".
[[nodiscard]] std::string machine();

/// Bytes a second that one thread copies (read + write counted once, 64 MB at a time, best of five): what the
/// memory of this machine allows, for putting other rates beside.
[[nodiscard]] double copyBytesPerSecond();

}  // namespace fettle::bench
