#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include "engine/filter/erosion.h"

namespace fettle::engine {

/// f(begin, end) for parts of [0, count), on all workers or on this thread alone.
inline void inParts(std::int32_t count, std::int32_t part, bool parallel, const auto& f) {
  if (!parallel) return f(0, count);
  tbb::parallel_for(tbb::blocked_range<std::int32_t>(0, (count + part - 1) / part, 1),
                    [&](const tbb::blocked_range<std::int32_t>& range) {
                      for (std::int32_t i = range.begin(); i != range.end(); ++i)
                        f(i * part, std::min((i + 1) * part, count));
                    });
}

/// The samples of a row that elements around columns [c0, c0 + n) reach, in `line` from c0 - reach on.
inline void takeRow(const Patch<float>& from, std::int32_t row, std::int32_t c0, std::int32_t n,
                    std::int32_t reach, float* line) {
  constexpr float none = std::numeric_limits<float>::infinity();
  const std::int32_t begin = std::max(c0 - reach, from.rect.column);
  const std::int32_t end = std::min(c0 + n + reach, from.rect.column + from.rect.columns);
  std::fill_n(line, begin - (c0 - reach), none);
  std::copy_n(from.row(row) + (begin - from.rect.column), end - begin, line + (begin - (c0 - reach)));
  std::fill_n(line + (end - (c0 - reach)), c0 + n + reach - end + 64, none);
}

}  // namespace fettle::engine
