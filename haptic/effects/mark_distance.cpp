#include "haptic/effects/mark_distance.h"

#include <algorithm>
#include <cmath>

namespace fettle::haptic {

using engine::kTileSamples;
using engine::kTileShift;
using engine::kTileSide;

namespace {

// Rows from a sample to the nearest mark of its column, when there is none within the reach.
constexpr std::uint8_t kNone = 255;

std::uint64_t printOf(const engine::Tile& tile, std::uint64_t of_lines) noexcept {
  if (tile.marked_samples == 0 && of_lines == 0) return 0;
  std::uint64_t print = of_lines ^ 0xcbf29ce484222325ULL;  // FNV-1a, word by word
  for (const std::uint64_t row : tile.marks) {
    print = (print ^ row) * 0x100000001b3ULL;
    print ^= print >> 32U;
  }
  return print | 1U;
}

engine::LineCuts::TileSamples samplesOf(const engine::LineCuts* lines, std::int32_t tile_column,
                                        std::int32_t tile_row) noexcept {
  return lines == nullptr ? engine::LineCuts::TileSamples() : lines->samplesOf(tile_column, tile_row);
}

}  // namespace

double MarkDistance::longestReachMm(const engine::Grid& grid) noexcept {
  return kMostReach * std::min(grid.spacingXMm(), grid.spacingYMm());
}

MarkDistance::MarkDistance(const engine::FieldReader& reader, const engine::LineCuts* lines, double reach_mm)
    : tile_columns_(reader.tileColumns()),
      tile_rows_(reader.tileRows()),
      width_(reader.width()),
      height_(reader.height()),
      sx_(reader.grid().spacingXMm()),
      sy_(reader.grid().spacingYMm()),
      reach_mm_(std::min(reach_mm, longestReachMm(reader.grid()))),
      far_(static_cast<float>(reach_mm_)),
      reach_columns_(std::min(static_cast<int>(reach_mm_ / sx_), kMostReach)),
      reach_rows_(std::min(static_cast<int>(reach_mm_ / sy_), kMostReach)) {
  if (static_cast<double>(far_) < reach_mm_) far_ = std::nextafter(far_, HUGE_VALF);
  const auto count = static_cast<std::size_t>(tiles());
  slots_.assign(count, -1);
  prints_.assign(count, 0);
  requested_.assign(count, 0);
  waiting_.assign(count, 0);
  // All tiles with marks have to be processed; so an upper bound of the memory is known.
  while (next_tile_ < tiles()) scanSlice(reader, lines);
  const std::size_t places = waiting_count_ + kSpareTiles;
  memory_.assign(places * kTileSamples, far_);
  free_slots_.reserve(places);
  for (std::size_t i = places; i > 0; --i) free_slots_.push_back(static_cast<std::int32_t>(i - 1));
  while (!upToDate()) advance(reader, lines);
}

std::size_t MarkDistance::bytesHeld() const noexcept {
  return slots_.capacity() * sizeof(std::int32_t) + prints_.capacity() * sizeof(std::uint64_t) +
         requested_.capacity() + waiting_.capacity() * sizeof(std::int32_t) +
         memory_.capacity() * sizeof(float) + free_slots_.capacity() * sizeof(std::int32_t);
}

std::int32_t MarkDistance::tilesHeld() const noexcept {
  return static_cast<std::int32_t>(
      std::count_if(slots_.begin(), slots_.end(), [](std::int32_t slot) { return slot >= 0; }));
}

void MarkDistance::requestTile(std::int32_t tc, std::int32_t tr) noexcept {
  const auto tile = static_cast<std::size_t>(tr * tile_columns_ + tc);
  if (requested_[tile] != 0) return;
  requested_[tile] = 1;
  waiting_[(waiting_head_ + waiting_count_) % waiting_.size()] = static_cast<std::int32_t>(tile);
  ++waiting_count_;
}

void MarkDistance::markChanged(std::int32_t column, std::int32_t row, std::int32_t columns,
                               std::int32_t rows) noexcept {
  const std::int32_t c0 = std::max(column - reach_columns_, 0) >> kTileShift;
  const std::int32_t r0 = std::max(row - reach_rows_, 0) >> kTileShift;
  const std::int32_t c1 = std::min(column + columns - 1 + reach_columns_, width_ - 1) >> kTileShift;
  const std::int32_t r1 = std::min(row + rows - 1 + reach_rows_, height_ - 1) >> kTileShift;
  for (std::int32_t r = r0; r <= r1; ++r)
    for (std::int32_t c = c0; c <= c1; ++c) requestTile(c, r);
}

void MarkDistance::scanSlice(const engine::FieldReader& reader, const engine::LineCuts* lines) noexcept {
  const std::int32_t end = std::min(next_tile_ + kTilesASlice, tiles());
  for (; next_tile_ < end; ++next_tile_) {
    const std::int32_t tc = next_tile_ % tile_columns_;
    const std::int32_t tr = next_tile_ / tile_columns_;
    const std::uint64_t print = printOf(reader.tile(tc, tr), samplesOf(lines, tc, tr).print);
    std::uint64_t& known = prints_[static_cast<std::size_t>(next_tile_)];
    if (print == known) continue;
    known = print;
    markChanged(tc << kTileShift, tr << kTileShift, kTileSide, kTileSide);
  }
}

void MarkDistance::advance(const engine::FieldReader& reader, const engine::LineCuts* lines) noexcept {
  if (job_tile_ >= 0) {
    if (job_in_rows_)
      rowSlice();
    else
      columnSlice(reader, lines);
  } else if (next_tile_ < tiles()) {
    scanSlice(reader, lines);
  } else if (waiting_count_ > 0) {
    startJob(reader, lines);
  }
}

void MarkDistance::startJob(const engine::FieldReader& reader, const engine::LineCuts* lines) noexcept {
  job_tile_ = waiting_[waiting_head_];
  waiting_head_ = (waiting_head_ + 1) % waiting_.size();
  --waiting_count_;
  // From here on a change of marks requests the tile again.
  requested_[static_cast<std::size_t>(job_tile_)] = 0;
  job_line_ = 0;
  job_within_reach_ = false;
  job_in_rows_ = false;
  const std::int32_t tc = job_tile_ % tile_columns_;
  const std::int32_t tr = job_tile_ / tile_columns_;
  std::size_t marked = 0;
  for (std::int32_t r = std::max(tr - 1, 0); r <= std::min(tr + 1, tile_rows_ - 1); ++r)
    for (std::int32_t c = std::max(tc - 1, 0); c <= std::min(tc + 1, tile_columns_ - 1); ++c)
      marked += reader.tile(c, r).marked_samples + samplesOf(lines, c, r).samples.size();
  if (marked == 0) finishJob();
}

// First pass: for some columns, how many rows each sample of the tile is from a mark in the same column.
void MarkDistance::columnSlice(const engine::FieldReader& reader, const engine::LineCuts* lines) noexcept {
  const int columns = kTileSide + 2 * reach_columns_;
  const int rows = kTileSide + 2 * reach_rows_;
  const int count = std::min(kColumnsASlice, columns - job_line_);
  const std::int32_t c0 = ((job_tile_ % tile_columns_) << kTileShift) - reach_columns_ + job_line_;
  const std::int32_t r0 = ((job_tile_ / tile_columns_) << kTileShift) - reach_rows_;
  reader.readMarks(c0, r0, count, rows, marks_.data(), kColumnsASlice);
  if (lines != nullptr) addLines(*lines, {c0, r0, count, rows});
  for (int c = 0; c < count; ++c) {
    const auto marked = [&](int r) { return marks_[static_cast<std::size_t>(r * kColumnsASlice + c)] != 0; };
    const auto vertical = [&](int r) -> std::uint8_t& {
      return vertical_[static_cast<std::size_t>((r - reach_rows_) * kLongest + job_line_ + c)];
    };
    int since = kNone;
    for (int r = 0; r < rows - reach_rows_; ++r) {
      since = marked(r) ? 0 : std::min<int>(since + 1, kNone);
      if (r >= reach_rows_) vertical(r) = static_cast<std::uint8_t>(since > reach_rows_ ? kNone : since);
    }
    since = kNone;
    for (int r = rows - 1; r >= reach_rows_; --r) {
      since = marked(r) ? 0 : std::min<int>(since + 1, kNone);
      if (r < rows - reach_rows_ && since <= reach_rows_ && since < vertical(r))
        vertical(r) = static_cast<std::uint8_t>(since);
    }
  }
  job_line_ += count;
  if (job_line_ < columns) return;
  job_line_ = 0;
  job_in_rows_ = true;
}

// Adds the samples that lines pass to the marks of a block.
void MarkDistance::addLines(const engine::LineCuts& lines, const engine::SampleRect& block) noexcept {
  const std::int32_t c1 = std::min(block.column + block.columns, width_),
                     r1 = std::min(block.row + block.rows, height_);
  for (std::int32_t tr = std::max(block.row, 0) >> kTileShift; tr << kTileShift < r1; ++tr)
    for (std::int32_t tc = std::max(block.column, 0) >> kTileShift; tc << kTileShift < c1; ++tc)
      for (const engine::LineSample& sample : lines.samplesOf(tc, tr).samples) {
        const std::int32_t c = sample.column - block.column, r = sample.row - block.row;
        if (c >= 0 && c < block.columns && r >= 0 && r < block.rows)
          marks_[static_cast<std::size_t>(r * kColumnsASlice + c)] = 1;
      }
}

// Second pass: for some rows, the lower envelope of one parabola per column.
void MarkDistance::rowSlice() noexcept {
  const int columns = kTileSide + 2 * reach_columns_;
  const double reach2 = reach_mm_ * reach_mm_;
  std::array<int, kLongest> apex;         // column of each parabola of the envelope
  std::array<double, kLongest + 1> from;  // where it begins [columns]
  for (int line = 0; line < kRowsASlice; ++line, ++job_line_) {
    const std::uint8_t* vertical = vertical_.data() + job_line_ * kLongest;
    const auto height2 = [&](int q) {
      const double y = vertical[q] * sy_;
      return y * y;
    };
    int last = -1;
    for (int q = 0; q < columns; ++q) {
      if (vertical[q] == kNone) continue;
      double begin = -HUGE_VAL;
      while (last >= 0) {
        const int p = apex[static_cast<std::size_t>(last)];
        // Where the parabolas of p < q cross: (2012), equation 3, with sx^2 for the unit.
        begin = 0.5 * ((height2(q) - height2(p)) / (sx_ * sx_ * (q - p)) + (q + p));
        if (begin > from[static_cast<std::size_t>(last)]) break;
        --last;
        begin = -HUGE_VAL;
      }
      ++last;
      apex[static_cast<std::size_t>(last)] = q;
      from[static_cast<std::size_t>(last)] = begin;
    }
    float* out = result_.data() + job_line_ * kTileSide;
    if (last < 0) {
      std::fill_n(out, kTileSide, far_);
      continue;
    }
    from[static_cast<std::size_t>(last) + 1] = HUGE_VAL;
    std::size_t k = 0;
    for (int c = 0; c < kTileSide; ++c) {
      const int x = c + reach_columns_;
      while (from[k + 1] < x) ++k;
      const double dx = (x - apex[k]) * sx_;
      const double d2 = dx * dx + height2(apex[k]);
      out[c] = d2 < reach2 ? static_cast<float>(std::sqrt(d2)) : far_;
      job_within_reach_ = job_within_reach_ || d2 < reach2;
    }
  }
  if (job_line_ >= kTileSide) finishJob();
}

void MarkDistance::finishJob() noexcept {
  std::int32_t& slot = slots_[static_cast<std::size_t>(job_tile_)];
  if (!job_within_reach_) {
    if (slot >= 0) free_slots_.push_back(slot);  // within its capacity: it came from there
    slot = -1;
  } else {
    if (slot < 0 && !free_slots_.empty()) {
      slot = free_slots_.back();
      free_slots_.pop_back();
    }
    if (slot >= 0)
      std::copy(result_.begin(), result_.end(),
                memory_.begin() + static_cast<std::ptrdiff_t>(slot) * kTileSamples);
    else
      ++refused_;
  }
  job_tile_ = -1;
}

}  // namespace fettle::haptic
