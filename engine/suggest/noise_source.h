#pragma once

#include <cstdint>
#include <vector>

#include "engine/inspect/noise_parts.h"

namespace fettle::engine {

/// Gaussian noise that consists of given parts: uncorrelated, correlated along rows and columns, offsets of rows and
/// of columns.
class NoiseSource {
 public:
  explicit NoiseSource(const NoiseParts& parts);

  /// `columns` x `rows` samples of it, row-major [unit of the parts' roots]. Other seeds give independent ones, the
  /// same seed the same bits, on any number of threads. Throws std::bad_alloc. Thread: any; on all workers of the arena.
  [[nodiscard]] std::vector<double> make(std::int32_t columns, std::int32_t rows, std::uint64_t seed) const;

 private:
  double own_, row_offset_, column_offset_;  // standard deviations
  std::vector<double> along_row_,
      along_column_;  // weights of neighbours; an odd number, the middle one its own
};

}  // namespace fettle::engine
