#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

namespace fettle::tests {

/// Imports bytes as a file of that extension (with the dot). Whatever they are, an importer answers with a
/// field or with an Error of one line; anything else ends the process. Threading: one thread at a time.
void importBytes(const std::string& extension, const std::uint8_t* bytes, std::size_t count);

}  // namespace fettle::tests
