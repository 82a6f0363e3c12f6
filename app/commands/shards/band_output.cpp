#include "app/commands/shards/band_output.h"

#include <filesystem>
#include <system_error>
#include <utility>

#include <fmt/format.h>
#include <unistd.h>

#include "app/commands/shards/shard_note.h"
#include "engine/io/files/atomic_file.h"

namespace fettle::app {

engine::Result<BandOutput> BandOutput::open(const ShardFolder& folder, const ShardPlan& plan, int number,
                                            engine::Grid grid, const engine::RowSpan& own) {
  if (plan.one_file) {
    auto rows = engine::PlainRows::open(folder.whole(), *plan.one_file);
    if (!rows) return tl::unexpected(rows.error());
    return BandOutput(*std::move(rows), 0, {}, {});
  }
  grid.origin_y += own.first * grid.spacing_y;
  grid.height = own.count;
  // A name of this process: one that was killed leaves another.
  const std::string part = fmt::format("{}/part-{}-{}-{}.tif", folder.path(), number, hostName(), ::getpid());
  const auto layout = engine::createPlainTiff(grid, part);
  if (!layout) return tl::unexpected(layout.error());
  auto rows = engine::PlainRows::open(part, *layout);
  if (!rows) return tl::unexpected(rows.error());
  return BandOutput(*std::move(rows), own.first, part, folder.rows(number));
}

BandOutput::BandOutput(engine::PlainRows rows, std::int32_t first, std::string part, std::string final_path)
    : rows_(std::move(rows)), first_(first), part_(std::move(part)), final_(std::move(final_path)) {}

BandOutput::BandOutput(BandOutput&& other) noexcept
    : rows_(std::move(other.rows_)),
      first_(other.first_),
      part_(std::exchange(other.part_, {})),
      final_(std::move(other.final_)) {}

BandOutput::~BandOutput() {
  std::error_code ignored;
  if (!part_.empty()) std::filesystem::remove(part_, ignored);
}

engine::Status BandOutput::write(std::int32_t row, std::int32_t rows, const float* heights) {
  return rows_.write(row - first_, rows, heights);
}

engine::Status BandOutput::commit() {
  if (auto status = rows_.flush(); !status) return status;
  if (part_.empty()) return {};
  std::error_code error;
  std::filesystem::rename(part_, final_, error);
  if (error) return engine::writeError(final_, error.value());
  part_.clear();
  return {};
}

}  // namespace fettle::app
