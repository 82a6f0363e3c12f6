#pragma once

#include <cstdint>
#include <string_view>

namespace fettle::engine {

/// Writes all of `bytes` into an open file, from the byte `at` on; the file's own position stays. The system's error number, 0
/// where all is written: some may be written before an error. Thread: any, several on one file as long as what they write
/// does not overlap.
[[nodiscard]] int writeAt(int descriptor, std::string_view bytes, std::uint64_t at) noexcept;

}  // namespace fettle::engine
