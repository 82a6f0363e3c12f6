#pragma once

#include <string>
#include <string_view>

namespace fettle::app {

/// How the window writes what engine and reports write in ASCII: "12.3 +- 0.2 um" is "12.3 ± 0.2 µm", "40 us" is "40 µs". Units are
/// taken where they stand as words of their own; names of files keep theirs. A text without one comes back as it is. Thread: any.
[[nodiscard]] std::string screenText(std::string_view text);

}  // namespace fettle::app
