#pragma once

#include <string>

#include "engine/io/files/atomic_file.h"

namespace fettle::engine {

/// Gathers text for an AtomicFile and hands it over in large pieces. The caller appends to text and calls
/// settle() now and then (each row), finish() at the end.
struct TextWriter {
  AtomicFile& file;
  std::string text{};

  [[nodiscard]] Status settle() { return text.size() < kPiece ? Status{} : finish(); }
  [[nodiscard]] Status finish() {
    Status status = file.write(text);
    text.clear();
    return status;
  }

  static constexpr std::size_t kPiece = std::size_t{4} << 20;
};

}  // namespace fettle::engine
