#include "engine/filter/box_strip.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "engine/simd/kernel.h"
#include "engine/simd/prefetch.h"

namespace fettle::engine {

#ifdef FETTLE_CPU_LEVELS

namespace {

constexpr int kFloats = 16;  // of a register
constexpr int kLongs = 8;

struct Slide {
  const std::int64_t* sums;          // of the column that leaves at the first output
  const std::int32_t* counts;        // likewise, with holes
  const std::int32_t* column_count;  // columns of each output's window, without holes
  int window;
  int rows;        // of the window that lie in the field
  int full_count;  // of columns x rows: what most windows have
  int exponent;
};

#define FETTLE_KERNEL "engine/filter/box_strip-inl.h"
#include "engine/simd/each_cpu-inl.h"

constexpr std::int32_t floorTo(std::int32_t value, std::int32_t step) noexcept {
  return (value >= 0 ? value : value - step + 1) / step * step;
}

}  // namespace

std::unique_ptr<BoxStrip> BoxStrip::make(int radius, CpuLevel level) {
  if (level != CpuLevel::kAvx512) return nullptr;
  return std::unique_ptr<BoxStrip>(new BoxStrip(radius));
}

void BoxStrip::lookUp(Row& row, std::int32_t y) const {
  const std::int32_t tile_row = y < 0 || y >= reader_.height() ? -1 : y >> kTileShift;
  if (tile_row == row.tile_row) return;
  row.tile_row = tile_row;
  if (row.none()) return;
  row.tiles.resize(pieces_.size());
  for (std::size_t i = 0; i < pieces_.size(); ++i)
    row.tiles[i] = reader_.tile(pieces_[i].tile_column, tile_row).samples.data() + pieces_[i].offset;
}

bool BoxStrip::move(std::int32_t enter, std::int32_t leave) {
  lookUp(enter_, enter);
  lookUp(leave_, leave);
  const float power = std::ldexp(1.0F, exponent_);
  const std::ptrdiff_t enter_at = std::ptrdiff_t{enter & (kTileSide - 1)} * kTileSide;
  const std::ptrdiff_t leave_at = std::ptrdiff_t{leave & (kTileSide - 1)} * kTileSide;
  // Rows ahead that memory is asked for: two cache lines a column of the register, and tiles lie anywhere.
  constexpr std::int32_t kAhead = 16;
  lookUp(ahead_, enter + kAhead);
  const std::ptrdiff_t ahead_at = std::ptrdiff_t{(enter + kAhead) & (kTileSide - 1)} * kTileSide;
  bool fit = true;
  for (std::size_t i = 0; i < pieces_.size(); ++i) {
    const Piece& piece = pieces_[i];
    const float* in = enter_.none() ? nullptr : enter_.tiles[i] + enter_at;
    const float* out = leave_.none() ? nullptr : leave_.tiles[i] + leave_at;
    if (!ahead_.none())
      for (std::int32_t c = 0; c < piece.columns; c += kFloats) fetchAhead(ahead_.tiles[i] + ahead_at + c);
    fit &= holes_ ? avx512::moveColumnsOf<true>(in, out, piece.columns, power, sums_.data() + piece.at,
                                                counts_.data() + piece.at)
                  : avx512::moveColumnsOf<false>(in, out, piece.columns, power, sums_.data() + piece.at,
                                                 nullptr);
  }
  return fit;
}

// Whether there are holes among the samples that windows can reach, and the finest power of two that fits.
void BoxStrip::survey(std::int32_t row, std::int32_t rows) {
  float magnitude = 0.0F;
  holes_ = false;
  const std::int32_t tr0 = std::max(row - radius_, 0) >> kTileShift;
  const std::int32_t tr1 = std::min(row + rows - 1 + radius_, reader_.height() - 1) >> kTileShift;
  for (std::int32_t tr = tr0; tr <= tr1; ++tr)
    for (const Piece& piece : pieces_) {
      const Tile& tile = reader_.tile(piece.tile_column, tr);
      const std::int32_t in_field = std::min(kTileSide, reader_.width() - piece.tile_column * kTileSide) *
                                    std::min(kTileSide, reader_.height() - tr * kTileSide);
      holes_ |= tile.nan_samples > static_cast<std::uint32_t>(kTileSamples - in_field);
      if (!tile.bounds.empty())
        magnitude = std::max({magnitude, std::fabs(tile.bounds.min), std::fabs(tile.bounds.max)});
    }
  // All magnitudes are below 2^top, all sums below 2^(top + bits).
  int top = 0;
  (void)std::frexp(magnitude, &top);
  const auto window = static_cast<std::uint64_t>(2 * radius_ + 1);
  const auto bits = static_cast<int>(std::bit_width(window * window));
  exponent_ = std::min(63 - top - bits, 126);
}

void BoxStrip::begin(const FieldReader& reader, std::int32_t column0, std::int32_t column1, std::int32_t row,
                     std::int32_t rows) {
  reader_ = reader;
  column0_ = column0;
  column1_ = column1;
  next_ = row;
  first_ = floorTo(column0 - radius_ - 1, kFloats);
  const std::int32_t outputs = floorTo(column1 - column0 + kTileSide - 1, kTileSide);
  const std::int32_t beyond = column0 + outputs + radius_ + kFloats;
  sums_.assign(static_cast<std::size_t>(floorTo(beyond - first_, kTileSide) + kTileSide), 0);
  pieces_.clear();
  const std::int32_t end = std::min(column1 + radius_, reader.width());
  for (std::int32_t c = std::max(first_, 0); c < end;) {
    const std::int32_t offset = c & (kTileSide - 1);
    const std::int32_t in_tile = std::min(kTileSide - offset, end - c);
    const std::int32_t columns = floorTo(in_tile + kFloats - 1, kFloats);
    pieces_.push_back({c >> kTileShift, offset, columns, c - first_});
    c += columns;
  }
  survey(row, rows);
  if (holes_) counts_.assign(sums_.size(), 0);
  plain_count_.resize(static_cast<std::size_t>(outputs));
  for (std::int32_t c = 0; c < outputs; ++c)
    plain_count_[static_cast<std::size_t>(c)] =
        std::min(column0 + c + radius_ + 1, reader.width()) - std::max(column0 + c - radius_, 0);
  enter_ = leave_ = ahead_ = {};
  started_ = false;
  bool fit = exponent_ >= 0;
  if (fit)
    for (std::int32_t y = row - radius_; y < row + radius_; ++y) fit &= move(y, -1);
  if (!fit) exponent_ = -1;
}

bool BoxStrip::rows(std::int32_t rows, float* out, std::ptrdiff_t stride) {
  if (exponent_ < 0) return false;
  for (std::int32_t r = 0; r < rows; ++r, ++next_, out += stride) {
    // The first row of a strip has no row that leaves: begin() has not let it in.
    const bool first = !started_;
    if (!move(next_ + radius_, first ? -1 : next_ - radius_ - 1)) return false;
    started_ = true;
    Slide s;
    s.window = 2 * radius_ + 1;
    s.rows = std::min(next_ + radius_ + 1, reader_.height()) - std::max(next_ - radius_, 0);
    s.full_count = s.rows * std::min(s.window, reader_.width());
    const std::ptrdiff_t at = column0_ - radius_ - 1 - first_;
    s.sums = sums_.data() + at;
    s.counts = holes_ ? counts_.data() + at : nullptr;
    s.column_count = plain_count_.data();
    s.exponent = exponent_;
    const std::int32_t n = column1_ - column0_;
    const std::int32_t full_begin =
        std::min(floorTo(std::max(radius_ - column0_, 0) + kFloats - 1, kFloats), n);
    const std::int32_t full_end =
        std::max(floorTo(std::clamp(reader_.width() - radius_ - column0_, 0, n), kFloats), full_begin);
    if (holes_)
      avx512::slide<true>(s, out, n, full_begin, full_end);
    else
      avx512::slide<false>(s, out, n, full_begin, full_end);
  }
  return true;
}

#else

std::unique_ptr<BoxStrip> BoxStrip::make(int, CpuLevel) {
  return nullptr;
}
void BoxStrip::begin(const FieldReader&, std::int32_t, std::int32_t, std::int32_t, std::int32_t) {}
bool BoxStrip::rows(std::int32_t, float*, std::ptrdiff_t) {
  return false;
}

#endif

}  // namespace fettle::engine
