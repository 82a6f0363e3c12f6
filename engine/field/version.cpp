#include "engine/field/version.h"

#include "engine/field/content_hash.h"
#include "engine/field/line_cuts.h"
#include "engine/field/nominal_form.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace fettle::engine {

Version::Version(const Version& other) noexcept
    : description_(other.description_), memory_(other.memory_), root_(other.root_), sign_(other.sign_) {
  if (root_ != nullptr) InnerPool::retain(root_);
}

Version& Version::operator=(Version other) noexcept {
  std::swap(root_, other.root_);
  std::swap(sign_, other.sign_);
  description_.swap(other.description_);
  memory_.swap(other.memory_);
  return *this;
}

Version Version::inverted() const noexcept {
  Version copy = *this;
  copy.sign_ = -copy.sign_;
  return copy;
}

Version Version::withGrid(Grid grid) const {
  assert(grid.width == this->grid().width && grid.height == this->grid().height);
  FieldDescription description = *description_;
  description.grid = std::move(grid);
  return withDescription(std::move(description));
}

Version Version::withLines(EdgeLines lines) const {
  FieldDescription description = *description_;
  description.lines = std::move(lines);
  description.cuts = description.lines == nullptr
                         ? nullptr
                         : std::make_shared<const LineCuts>(*description.lines, grid().width, grid().height);
  return withDescription(std::move(description));
}

Version Version::withForm(FieldForm form) const {
  assert(form == nullptr || (form->width() == grid().width && form->height() == grid().height));
  FieldDescription description = *description_;
  description.form = std::move(form);
  return withDescription(std::move(description));
}

Version Version::withSeenOf(std::shared_ptr<const SeenPair> pair) const {
  assert(pair == nullptr ||
         (pair->restored.grid().width == grid().width && pair->restored.grid().height == grid().height));
  FieldDescription description = *description_;
  description.seen_of = std::move(pair);
  return withDescription(std::move(description));
}

Version Version::withDescription(FieldDescription description) const {
  Version copy = *this;
  copy.description_ = std::make_shared<const FieldDescription>(std::move(description));
  return copy;
}

HeightBounds FieldReader::bounds(int level, std::int32_t x, std::int32_t y) const noexcept {
  constexpr float kInf = std::numeric_limits<float>::infinity();
  const int shift_to_samples = 3 * (level + 1);
  if (x < 0 || y < 0 || (std::int64_t{x} << shift_to_samples) >= width() ||
      (std::int64_t{y} << shift_to_samples) >= height())
    return {kInf, -kInf};
  if (level == 0) {
    const Tile& t = tile(x >> 3, y >> 3);
    const auto k = static_cast<std::size_t>((y & 7) * 8 + (x & 7));
    return signedBounds(t.block_min[k], t.block_max[k]);
  }
  if (level == root_->level) return bounds();
  assert(level < root_->level);
  const Node* node = root_;
  // A node of level n holds squares of level n - 1.
  for (int up = root_->level - 1 - level; up > 0; --up)
    node = static_cast<const Node*>(node->children[childIndex(x, y, 3 * up)]);
  const std::size_t k = childIndex(x, y, 0);
  return signedBounds(node->child_min[k], node->child_max[k]);
}

HeightBounds FieldReader::bounds() const noexcept {
  float lo = std::numeric_limits<float>::infinity();
  float hi = -lo;
  for (int k = 0; k < kFanOut; ++k) {
    lo = std::min(lo, root_->child_min[k]);
    hi = std::max(hi, root_->child_max[k]);
  }
  return signedBounds(lo, hi);
}

namespace {

// Calls f(tile, column and row within the tile, columns, rows, offset of the first sample in the rectangle)
// for every tile that the rectangle's part inside the field touches.
void forEachPiece(const FieldReader& reader, std::int32_t column, std::int32_t row, std::int32_t columns,
                  std::int32_t rows, auto&& f) noexcept {
  const std::int32_t c0 = std::max(column, 0);
  const std::int32_t r0 = std::max(row, 0);
  const auto c1 =
      static_cast<std::int32_t>(std::min<std::int64_t>(std::int64_t{column} + columns, reader.width()));
  const auto r1 =
      static_cast<std::int32_t>(std::min<std::int64_t>(std::int64_t{row} + rows, reader.height()));
  for (std::int32_t r = r0; r < r1;) {
    const std::int32_t row_end = std::min(r1, (r | (kTileSide - 1)) + 1);
    for (std::int32_t c = c0; c < c1;) {
      const std::int32_t column_end = std::min(c1, (c | (kTileSide - 1)) + 1);
      f(reader.tile(c >> kTileShift, r >> kTileShift), c & (kTileSide - 1), r & (kTileSide - 1),
        column_end - c, row_end - r, c - column, r - row);
      c = column_end;
    }
    r = row_end;
  }
}

bool coversOutside(const FieldReader& reader, std::int32_t column, std::int32_t row, std::int32_t columns,
                   std::int32_t rows) noexcept {
  return column < 0 || row < 0 || std::int64_t{column} + columns > reader.width() ||
         std::int64_t{row} + rows > reader.height();
}

}  // namespace

void FieldReader::readHeights(std::int32_t column, std::int32_t row, std::int32_t columns, std::int32_t rows,
                              float* out, std::ptrdiff_t stride) const noexcept {
  if (coversOutside(*this, column, row, columns, rows))
    for (std::int32_t r = 0; r < rows; ++r)
      std::fill_n(out + r * stride, columns, std::numeric_limits<float>::quiet_NaN());
  forEachPiece(*this, column, row, columns, rows,
               [&](const Tile& t, int tc, int tr, int n, int m, int at_column, int at_row) {
                 for (int r = 0; r < m; ++r) {
                   const float* from = t.samples.data() + (tr + r) * kTileSide + tc;
                   float* to = out + (at_row + r) * stride + at_column;
                   if (sign_ > 0)
                     std::copy_n(from, n, to);
                   else
                     std::transform(from, from + n, to, [](float v) { return -v; });
                 }
               });
}

void FieldReader::readMarks(std::int32_t column, std::int32_t row, std::int32_t columns, std::int32_t rows,
                            std::uint8_t* out, std::ptrdiff_t stride) const noexcept {
  if (coversOutside(*this, column, row, columns, rows))
    for (std::int32_t r = 0; r < rows; ++r) std::fill_n(out + r * stride, columns, std::uint8_t{0});
  forEachPiece(*this, column, row, columns, rows,
               [&](const Tile& t, int tc, int tr, int n, int m, int at_column, int at_row) {
                 for (int r = 0; r < m; ++r) {
                   const std::uint64_t bits = t.marks[static_cast<std::size_t>(tr + r)] >> tc;
                   std::uint8_t* to = out + (at_row + r) * stride + at_column;
                   for (int c = 0; c < n; ++c) to[c] = static_cast<std::uint8_t>((bits >> c) & 1U);
                 }
               });
}

FieldSummary summarize(const Version& version) {
  const FieldReader reader = version.reader();
  FieldSummary summary;
  double sum = 0.0;
  for (std::int32_t tr = 0; tr < reader.tileRows(); ++tr)
    for (std::int32_t tc = 0; tc < reader.tileColumns(); ++tc) {
      const Tile& t = reader.tile(tc, tr);
      const int columns = std::min(kTileSide, reader.width() - tc * kTileSide);
      const int rows = std::min(kTileSide, reader.height() - tr * kTileSide);
      summary.marked += t.marked_samples;
      summary.no_data += std::int64_t{t.nan_samples} - (kTileSamples - columns * rows);
      double tile_sum = 0.0;
      for (const float v : t.samples)
        if (!std::isnan(v)) tile_sum += static_cast<double>(v);
      sum += tile_sum;
    }
  const std::int64_t valid = reader.grid().samples() - summary.no_data;
  if (valid == 0) {
    summary.min = summary.max = summary.mean = std::numeric_limits<double>::quiet_NaN();
    return summary;
  }
  const HeightBounds b = reader.bounds();
  summary.min = static_cast<double>(b.min);
  summary.max = static_cast<double>(b.max);
  summary.mean = static_cast<double>(reader.sign()) * sum / static_cast<double>(valid);
  return summary;
}

std::uint64_t contentHash(const Version& version) {
  const FieldReader reader = version.reader();
  ContentHash hash(reader.width(), reader.height());
  std::vector<float> heights(static_cast<std::size_t>(reader.width()));
  std::vector<std::uint8_t> marks(static_cast<std::size_t>(reader.width()));
  for (std::int32_t row = 0; row < reader.height(); ++row) {
    reader.readHeights(0, row, reader.width(), 1, heights.data(), reader.width());
    reader.readMarks(0, row, reader.width(), 1, marks.data(), reader.width());
    hash.addRow(heights.data(), marks.data());
  }
  return hash.value();
}

}  // namespace fettle::engine
