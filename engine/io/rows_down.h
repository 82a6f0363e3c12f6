#pragma once

#include <cstdint>
#include <vector>

#include "engine/base/job.h"
#include "engine/field/builder.h"
#include "engine/io/height_rule.h"

namespace fettle::engine {

/// Fills a field from a file whose rows follow each other from the top down, of numbers of type T. `read(T*)` reads the
/// next row. Counts rows in `job`. Errors: those of `read`, cancelled.
template <class T, class Read>
[[nodiscard]] Status readRowsDown(Read&& read, const HeightRule& rule, FieldBuilder& builder,
                                  HeightTally& tally, JobControl& job) {
  const std::int32_t width = builder.grid().width;
  std::vector<T> numbers(static_cast<std::size_t>(width));
  std::vector<float> heights(static_cast<std::size_t>(width));
  for (std::int32_t row = builder.grid().height - 1; row >= 0; --row) {
    if (Status status = read(numbers.data()); !status) return status;
    if (job.cancelled()) return cancelled();
    rule.convert(numbers.data(), heights.data(), numbers.size(), tally);
    builder.writeHeights(0, row, width, 1, heights.data(), width);
    job.advance();
  }
  return {};
}

}  // namespace fettle::engine
