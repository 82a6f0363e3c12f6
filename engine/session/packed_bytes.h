#pragma once

#include <string>
#include <string_view>

namespace fettle::engine {

/// A zstd frame of any bytes; empty for none.
[[nodiscard]] std::string packBytes(std::string_view bytes);
/// False for anything packBytes does not make, and for more than 1 GiB.
[[nodiscard]] bool unpackBytes(std::string_view packed, std::string& bytes);

}  // namespace fettle::engine
