#include "engine/field/builder.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <utility>

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include "engine/field/tile_fill.h"
#include "engine/field/tile_store.h"

namespace fettle::engine {

namespace {

constexpr float kInf = std::numeric_limits<float>::infinity();
constexpr float kHole = std::numeric_limits<float>::quiet_NaN();

// f(0) to f(n - 1): on all cores where the tiles take longer than starting a worker, 17 MB and more.
void forEachIndex(std::size_t n, const auto& f) {
  constexpr std::size_t kParallelFrom = 1024;
  if (n >= kParallelFrom)
    tbb::parallel_for(std::size_t{0}, n, f);
  else
    for (std::size_t i = 0; i < n; ++i) f(i);
}

// Level of the smallest root that covers the field: a node of level n spans 8 * 8^n samples.
int rootLevel(const Grid& grid) noexcept {
  int level = 2;
  while ((std::int64_t{kBlockSide} << (3 * level)) < std::max(grid.width, grid.height)) ++level;
  return level;
}

Status sidesAndSpacing(const Grid& grid, const std::string& what) {
  if (grid.width < 1 || grid.height < 1 || grid.width > Grid::kMaxSide || grid.height > Grid::kMaxSide)
    return inputError(fmt::format("a field of {} x {} samples cannot be held", grid.width, grid.height), what,
                      fmt::format("a side must be 1 to {} samples", Grid::kMaxSide));
  for (const double spacing : {grid.spacingXMm(), grid.spacingYMm(), grid.height_unit.mm})
    if (!std::isfinite(spacing) || spacing <= 0.0)
      return inputError(fmt::format("the spacing {} mm is not a positive length", spacing), what,
                        "give it with --spacing");
  return {};
}

}  // namespace

FieldBuilder::FieldBuilder(Grid grid, std::shared_ptr<FieldMemory> memory)
    : description_(std::make_shared<const FieldDescription>(
          FieldDescription{std::move(grid), nullptr, nullptr, nullptr, nullptr})),
      memory_(std::move(memory)),
      tile_columns_((description_->grid.width + kTileSide - 1) / kTileSide),
      tile_rows_((description_->grid.height + kTileSide - 1) / kTileSide),
      infinities_(std::make_unique<std::atomic<std::int64_t>>(0)) {}

Result<FieldBuilder> FieldBuilder::create(Grid grid, const std::string& what, Start start) {
  if (Status fit = sidesAndSpacing(grid, what); !fit) return tl::unexpected(fit.error());
  auto memory =
      memoryFor(static_cast<std::uint64_t>(grid.width), static_cast<std::uint64_t>(grid.height), what);
  if (!memory) return tl::unexpected(memory.error());
  return create(std::move(grid), *std::move(memory), what, start);
}

Result<FieldBuilder> FieldBuilder::create(Grid grid, std::shared_ptr<FieldMemory> memory,
                                          const std::string& what, Start start) {
  if (Status fit = sidesAndSpacing(grid, what); !fit) return tl::unexpected(fit.error());
  FieldBuilder builder(std::move(grid), std::move(memory));
  const auto tiles = static_cast<std::size_t>(builder.tile_columns_) * builder.tile_rows_;
  builder.tiles_.reserve(tiles);
  builder.memory_->bulk().reserve(tiles);  // a failure is detected below
  for (std::size_t i = 0; i < tiles; ++i) {
    TileRef tile = TileRef::adopt(builder.memory_->bulk().acquire());
    if (!tile)
      return failure(
          fmt::format("memory for {} samples could not be allocated", builder.description_->grid.samples()),
          what);
    builder.tiles_.push_back(std::move(tile));
  }
  forEachIndex(tiles, [&builder, start](std::size_t i) {
    const auto columns = static_cast<std::size_t>(builder.tile_columns_);
    const bool at_border = (i + 1) % columns == 0 || i + columns >= builder.tiles_.size();
    Tile& tile = *builder.tiles_[i];
    // Samples past the field's end are holes in any case.
    if (start == Start::kHoles || at_border) tile.samples.fill(kHole);
    tile.marks.fill(0);
  });
  builder.summaries_.resize(tiles);
  if (start == Start::kUnwritten) {
    builder.missing_ = std::make_unique<std::atomic<std::int32_t>[]>(tiles);
    for (std::size_t i = 0; i < tiles; ++i)
      builder.missing_[i].store(builder.samplesOf(i), std::memory_order_relaxed);
  }
  return builder;
}

void FieldBuilder::writeHeights(std::int32_t column, std::int32_t row, std::int32_t columns,
                                std::int32_t rows, const float* heights, std::ptrdiff_t stride) noexcept {
  assert(column >= 0 && row >= 0 && column + columns <= description_->grid.width &&
         row + rows <= description_->grid.height);
  std::int64_t infinite = 0;
  for (std::int32_t r = row; r < row + rows;) {
    const std::int32_t row_end = std::min(row + rows, (r | (kTileSide - 1)) + 1);
    for (std::int32_t c = column; c < column + columns;) {
      const std::int32_t end = std::min(column + columns, (c | (kTileSide - 1)) + 1);
      Tile& tile = *tiles_[static_cast<std::size_t>(r >> kTileShift) * tile_columns_ + (c >> kTileShift)];
      float* to = tile.samples.data() + (r & (kTileSide - 1)) * kTileSide + (c & (kTileSide - 1));
      infinite += copyHeights(heights + (r - row) * stride + (c - column), stride, to, end - c, row_end - r);
      c = end;
    }
    r = row_end;
  }
  if (infinite != 0) infinities_->fetch_add(infinite, std::memory_order_relaxed);
}

void FieldBuilder::writeMarks(std::int32_t column, std::int32_t row, std::int32_t columns, std::int32_t rows,
                              const std::uint8_t* marks, std::ptrdiff_t stride) noexcept {
  assert(column >= 0 && row >= 0 && column + columns <= description_->grid.width &&
         row + rows <= description_->grid.height);
  for (std::int32_t r = row; r < row + rows; ++r)
    for (std::int32_t c = column; c < column + columns; ++c) {
      Tile& tile = *tiles_[static_cast<std::size_t>(r >> kTileShift) * tile_columns_ + (c >> kTileShift)];
      std::uint64_t& bits = tile.marks[static_cast<std::size_t>(r & (kTileSide - 1))];
      const std::uint64_t bit = std::uint64_t{1} << (c & (kTileSide - 1));
      bits = marks[(r - row) * stride + (c - column)] != 0 ? bits | bit : bits & ~bit;
    }
}

Node* FieldBuilder::buildNode(int level, std::int32_t column, std::int32_t row, bool& marked, bool& holed,
                              HeightBounds& bounds) {
  Node* node = memory_->nodes.acquire();
  // A node is 1/16 of a tile's size for 64 tiles: if the tiles fitted and this fails, the process cannot
  // continue.
  if (node == nullptr) std::abort();
  node->level = level;
  node->marked_children = 0;
  node->holed_children = 0;
  bounds = {kInf, -kInf};
  const std::int32_t tiles_a_child = 1 << (3 * (level - 2));
  for (int k = 0; k < kFanOut; ++k) {
    const std::int32_t tc = column + (k % 8) * tiles_a_child;
    const std::int32_t tr = row + (k / 8) * tiles_a_child;
    node->children[k] = nullptr;
    HeightBounds child{kInf, -kInf};
    bool child_marked = false;
    bool child_holed = false;
    if (tc < tile_columns_ && tr < tile_rows_) {
      if (level == 2) {
        const std::size_t place = static_cast<std::size_t>(tr) * tile_columns_ + tc;
        const Summary& summary = summaries_[place];
        child = summary.bounds;
        child_marked = summary.marked;
        child_holed = summary.holed;
        node->children[k] = tiles_[place].detach();
      } else {
        node->children[k] = buildNode(level - 1, tc, tr, child_marked, child_holed, child);
      }
    }
    node->child_min[k] = child.min;
    node->child_max[k] = child.max;
    node->marked_children |= std::uint64_t{child_marked} << k;
    node->holed_children |= std::uint64_t{child_holed} << k;
    bounds = {std::min(bounds.min, child.min), std::max(bounds.max, child.max)};
  }
  marked = node->marked_children != 0;
  holed = node->holed_children != 0;
  return node;
}

std::int32_t FieldBuilder::samplesOf(std::size_t place) const noexcept {
  const auto tc = static_cast<std::int32_t>(place % static_cast<std::size_t>(tile_columns_));
  const auto tr = static_cast<std::int32_t>(place / static_cast<std::size_t>(tile_columns_));
  return std::min(kTileSide, description_->grid.width - tc * kTileSide) *
         std::min(kTileSide, description_->grid.height - tr * kTileSide);
}

void FieldBuilder::summarise(std::size_t place) noexcept {
  Tile& tile = *tiles_[place];
  summariseTile(tile);
  summaries_[place] = {tile.bounds, tile.marked_samples != 0,
                       tile.nan_samples > static_cast<std::uint32_t>(kTileSamples - samplesOf(place))};
}

void FieldBuilder::wrote(std::int32_t tc, std::int32_t tr, std::int32_t samples) noexcept {
  assert(missing_ != nullptr);
  const std::size_t place = static_cast<std::size_t>(tr) * tile_columns_ + tc;
  // Release: this thread's writes are visible to the last one. Acquire: the last one sees all writes.
  const std::int32_t before = missing_[place].fetch_sub(samples, std::memory_order_acq_rel);
  assert(before >= samples);
  if (before == samples) summarise(place);
}

Version FieldBuilder::build() && {
  bool marked = false;
  bool holed = false;
  HeightBounds bounds;
  forEachIndex(tiles_.size(), [this](std::size_t i) {
    if (missing_ == nullptr || missing_[i].load(std::memory_order_relaxed) != 0) summarise(i);
  });
  Node* root = buildNode(rootLevel(description_->grid), 0, 0, marked, holed, bounds);
  tiles_.clear();
  summaries_.clear();
  return {std::move(description_), std::move(memory_), root, 1.0F};
}

Version makeField(const Grid& grid, const std::vector<float>& heights,
                  const std::vector<std::uint8_t>& marks) {
  assert(heights.size() == static_cast<std::size_t>(grid.samples()));
  assert(marks.empty() || marks.size() == heights.size());
  Result<FieldBuilder> builder = FieldBuilder::create(grid, "field");
  if (!builder) std::abort();  // a caller's bug: it chooses the sizes
  builder->writeHeights(0, 0, grid.width, grid.height, heights.data(), grid.width);
  if (!marks.empty()) builder->writeMarks(0, 0, grid.width, grid.height, marks.data(), grid.width);
  return std::move(*builder).build();
}

}  // namespace fettle::engine
