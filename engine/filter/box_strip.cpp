#include "engine/filter/box_strip.h"

#include <algorithm>
#include <cmath>

#include "engine/simd/prefetch.h"

namespace fettle::engine {

namespace {

constexpr int kAtOnce = 16;  // columns, of the widest registers

constexpr std::int32_t floorTo(std::int32_t value, std::int32_t step) noexcept {
  return (value >= 0 ? value : value - step + 1) / step * step;
}

}  // namespace

std::unique_ptr<BoxStrip> BoxStrip::make(int radius, CpuLevel level) {
  if (level == CpuLevel::kAvx512) return makeBoxOfIntegers(radius);
  return level == CpuLevel::kAvx2 ? makeBoxOfDoubles(radius) : nullptr;
}

BoxStrip::Samples BoxStrip::lookUp(TileRow& row, std::int32_t y) const {
  if (y < 0 || y >= reader_.height()) return {};
  const std::int32_t number = y >> kTileShift;
  if (number != row.number) {
    row.number = number;
    row.tiles.clear();
    for (const Piece& piece : pieces_)
      row.tiles.push_back(reader_.tile(piece.tile_column, number).samples.data() + piece.offset);
  }
  return {row.tiles.data(), std::ptrdiff_t{y & (kTileSide - 1)} * kTileSide};
}

bool BoxStrip::moveTo(std::int32_t enter, std::int32_t leave) {
  // Rows ahead that memory is asked for: two cache lines a column of the register, and tiles lie anywhere.
  constexpr std::int32_t kAhead = 16;
  if (const Samples ahead = lookUp(ahead_, enter + kAhead); ahead.tiles != nullptr)
    for (std::size_t i = 0; i < pieces_.size(); ++i)
      for (std::int32_t c = 0; c < pieces_[i].columns; c += kAtOnce)
        fetchAhead(ahead.tiles[i] + ahead.at + c);
  return move(lookUp(enter_, enter), lookUp(leave_, leave));
}

BoxStrip::Survey BoxStrip::surveyed(std::int32_t row, std::int32_t rows) const {
  Survey found;
  bool any = false;
  const std::int32_t tr0 = std::max(row - radius_, 0) >> kTileShift;
  const std::int32_t tr1 = std::min(row + rows - 1 + radius_, reader_.height() - 1) >> kTileShift;
  for (std::int32_t tr = tr0; tr <= tr1; ++tr)
    for (const Piece& piece : pieces_) {
      const Tile& tile = reader_.tile(piece.tile_column, tr);
      const std::int32_t in_field = std::min(kTileSide, reader_.width() - piece.tile_column * kTileSide) *
                                    std::min(kTileSide, reader_.height() - tr * kTileSide);
      found.holes |= tile.nan_samples > static_cast<std::uint32_t>(kTileSamples - in_field);
      const auto& [low, high] = tile.bounds;
      if (tile.bounds.empty()) continue;
      found.largest = std::max({found.largest, std::fabs(low), std::fabs(high)});
      const float least = low > 0.0F ? low : high < 0.0F ? -high : 0.0F;
      found.least = any ? std::min(found.least, least) : least;
      any = true;
    }
  return found;
}

void BoxStrip::begin(const FieldReader& reader, std::int32_t column0, std::int32_t column1, std::int32_t row,
                     std::int32_t rows) {
  reader_ = reader;
  column0_ = column0;
  column1_ = column1;
  next_ = row;
  first_ = floorTo(column0 - radius_ - 1, kAtOnce);
  const std::int32_t outputs = floorTo(column1 - column0 + kTileSide - 1, kTileSide);
  const std::int32_t beyond = column0 + outputs + radius_ + kAtOnce;
  pieces_.clear();
  const std::int32_t end = std::min(column1 + radius_, reader.width());
  for (std::int32_t c = std::max(first_, 0); c < end;) {
    const std::int32_t offset = c & (kTileSide - 1);
    const std::int32_t inside = std::min(kTileSide - offset, end - c);
    const std::int32_t columns = floorTo(inside + kAtOnce - 1, kAtOnce);
    pieces_.push_back({c >> kTileShift, offset, columns, std::min(columns, reader.width() - c), c - first_});
    c += columns;
  }
  column_counts_.resize(static_cast<std::size_t>(outputs));
  for (std::int32_t c = 0; c < outputs; ++c)
    column_counts_[static_cast<std::size_t>(c)] =
        std::min(column0 + c + radius_ + 1, reader.width()) - std::max(column0 + c - radius_, 0);
  enter_ = leave_ = ahead_ = {};
  started_ = false;
  fits_ =
      clear(surveyed(row, rows), static_cast<std::size_t>(floorTo(beyond - first_, kTileSide) + kTileSide));
  for (std::int32_t y = row - radius_; y < row + radius_ && fits_; ++y) fits_ = moveTo(y, -1);
}

bool BoxStrip::rows(std::int32_t rows, float* out, std::ptrdiff_t stride) {
  for (std::int32_t r = 0; r < rows && fits_; ++r, ++next_, out += stride) {
    // The first row of a strip has no row that leaves: begin() has not let it in.
    fits_ = moveTo(next_ + radius_, started_ ? next_ - radius_ - 1 : -1);
    if (!fits_) break;
    started_ = true;
    Windows all{};
    all.at = column0_ - radius_ - 1 - first_;
    all.count = column1_ - column0_;
    all.rows = std::min(next_ + radius_ + 1, reader_.height()) - std::max(next_ - radius_, 0);
    all.full = all.rows * std::min(window(), reader_.width());
    all.full_begin = std::min(floorTo(std::max(radius_ - column0_, 0) + kAtOnce - 1, kAtOnce), all.count);
    all.full_end = std::max(floorTo(std::clamp(reader_.width() - radius_ - column0_, 0, all.count), kAtOnce),
                            all.full_begin);
    slide(all, out);
  }
  return fits_;
}

}  // namespace fettle::engine
