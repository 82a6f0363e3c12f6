#pragma once

#include <cstdint>
#include <string>

#include "app/commands/shards/shard_folder.h"
#include "app/commands/shards/shard_plan.h"
#include "engine/base/error.h"
#include "engine/field/grid.h"
#include "engine/field/row_span.h"
#include "engine/io/tiff/plain_tiff.h"

namespace fettle::app {

/// Writes the rows of one shard to their place in the file of all, or to a file of its own that appears whole. Without commit() such a
/// file is removed. Errors as of writing a file.
class BandOutput {
 public:
  [[nodiscard]] static engine::Result<BandOutput> open(const ShardFolder& folder, const ShardPlan& plan,
                                                       int number, engine::Grid grid,
                                                       const engine::RowSpan& own);
  BandOutput(BandOutput&& other) noexcept;
  BandOutput& operator=(BandOutput&&) = delete;
  ~BandOutput();

  /// Rows row, row + 1 .. of the field, whole ones.
  [[nodiscard]] engine::Status write(std::int32_t row, std::int32_t rows, const float* heights);
  /// All of it is on the disk then.
  [[nodiscard]] engine::Status commit();

 private:
  BandOutput(engine::PlainRows rows, std::int32_t first, std::string part, std::string final_path);

  engine::PlainRows rows_;
  std::int32_t first_;
  std::string part_, final_;  // empty: rows of the file of all
};

}  // namespace fettle::app
