#pragma once

#include <string>

#include "engine/io/files/atomic_file.h"

namespace fettle::engine {

/// Collects text for an AtomicFile and writes it in large pieces. The caller appends to text, calls
/// flushIfLarge() regularly (each row), and flush() at the end.
struct TextWriter {
  AtomicFile& file;
  std::string text{};

  [[nodiscard]] Status flushIfLarge() { return text.size() < kPiece ? Status{} : flush(); }
  [[nodiscard]] Status flush() {
    Status status = file.write(text);
    text.clear();
    return status;
  }

  static constexpr std::size_t kPiece = std::size_t{4} << 20;
};

}  // namespace fettle::engine
