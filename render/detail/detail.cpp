#include "render/detail/detail.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>

#include <oneapi/tbb/parallel_for.h>

#include "render/detail/detail_tile.h"

namespace fettle::render {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();

DetailMeasure::Error larger(DetailMeasure::Error a, DetailMeasure::Error b) {
  return {std::max(a.deviation, b.deviation), std::max(a.excess, b.excess)};
}

// Raw height of a virtual sample; outside the field, clamped as in the shaders.
float rawHeight(const engine::FieldReader& reader, std::int32_t column, std::int32_t row) noexcept {
  return reader.sign() *
         reader.heightAt(std::clamp(column, 0, reader.width() - 1), std::clamp(row, 0, reader.height() - 1));
}

// Patches whose side is at most a tile's.
bool withinTile(int level) {
  return DetailMeasure::side(level) <= engine::kTileSide;
}

// A number that no measure had before. Pictures of several threads share one counter; nothing else depends on
// it.
std::uint64_t newState() {
  static std::atomic<std::uint64_t> last{0};
  return last.fetch_add(1, std::memory_order_relaxed) + 1;
}

constexpr DetailMeasure::Error kUnknown{kInfinity, kInfinity};

void unique(std::vector<glm::ivec2>& list) {
  const auto before = [](const glm::ivec2& a, const glm::ivec2& b) {
    return a.y != b.y ? a.y < b.y : a.x < b.x;
  };
  std::sort(list.begin(), list.end(), before);
  list.erase(std::unique(list.begin(), list.end()), list.end());
}

}  // namespace

float drawnHeight(const engine::FieldReader& reader, glm::ivec2 s, std::int32_t stride) noexcept {
  float h = rawHeight(reader, s.x, s.y);
  if (!std::isnan(h)) return h;
  const std::int32_t step = std::max(stride >> 3, 1), rings = stride / step;
  // On the last column and row as well, only samples of that step are read.
  s -= s & (step - 1);
  for (std::int32_t ring = 1; ring <= rings && std::isnan(h); ++ring)
    for (std::int32_t i = -ring; i < ring && std::isnan(h); ++i) {
      h = rawHeight(reader, s.x + step * i, s.y - step * ring);
      if (std::isnan(h)) h = rawHeight(reader, s.x + step * ring, s.y + step * i);
      if (std::isnan(h)) h = rawHeight(reader, s.x - step * i, s.y + step * ring);
      if (std::isnan(h)) h = rawHeight(reader, s.x - step * ring, s.y - step * i);
    }
  return h;
}

glm::ivec2 DetailMeasure::patches(int level) const noexcept {
  return (size_ - 2) / side(level) + 1;
}

void DetailMeasure::begin(const engine::FieldReader& reader) {
  state_ = invalidated_ = newState();
  size_ = glm::ivec2(std::max(2, reader.width()), std::max(2, reader.height()));
  tiles_ = {reader.tileColumns(), reader.tileRows()};
  int top = 0;
  while (patches(top) != glm::ivec2(1)) ++top;
  levels_.assign(static_cast<std::size_t>(top) + 1, {});
  for (int k = 0; k <= top; ++k) {
    Level& level = levels_[static_cast<std::size_t>(k)];
    level.count = patches(k);
    if (k > 0)
      level.errors.assign(static_cast<std::size_t>(level.count.x) * static_cast<std::size_t>(level.count.y),
                          kUnknown);
  }
  const std::size_t all = static_cast<std::size_t>(tiles_.x) * static_cast<std::size_t>(tiles_.y);
  std::array<Error, kTileLevels + 1> unknown;
  unknown.fill(kUnknown);
  tile_errors_.assign(all, unknown);
  is_waiting_.assign(all, true);
  // Ordered by squares of the largest patches that are measured tile by tile, so that these become known one
  // after the other. Those at the end of the list are measured first.
  waiting_.clear();
  waiting_.reserve(all);
  const int square = side(kTileLevels) / engine::kTileSide;
  for (int y = 0; y < tiles_.y; y += square)
    for (int x = 0; x < tiles_.x; x += square)
      for (int j = y; j < std::min(y + square, tiles_.y); ++j)
        for (int i = x; i < std::min(x + square, tiles_.x); ++i) waiting_.emplace_back(i, j);
  std::reverse(waiting_.begin(), waiting_.end());
}

// Patches of a level above the tile that depend on samples of these tiles.
std::vector<glm::ivec2> DetailMeasure::above(int level, std::span<const glm::ivec2> tiles) const {
  std::vector<glm::ivec2> patches;
  const std::int32_t reach = level <= kTileLevels ? 0 : 1 << level;
  for (const glm::ivec2& t : tiles) {
    const glm::ivec2 low = glm::max(t * engine::kTileSide - reach, glm::ivec2(0)) / side(level);
    const glm::ivec2 high = glm::min((t * engine::kTileSide + engine::kTileSide + reach) / side(level),
                                     levels_[static_cast<std::size_t>(level)].count - 1);
    for (int y = low.y; y <= high.y; ++y)
      for (int x = low.x; x <= high.x; ++x) patches.emplace_back(x, y);
  }
  unique(patches);
  return patches;
}

void DetailMeasure::invalidate(const engine::FieldReader& reader, std::span<const glm::ivec2> tiles) {
  // A filter's result: what is around each of its tiles is all of the field.
  if (2 * tiles.size() >= tile_errors_.size() && !tiles.empty()) return begin(reader);
  if (!tiles.empty()) state_ = invalidated_ = newState();
  // Cells reach into the next tile, and the vertex of a hole takes its height from up to one tile away. The
  // last vertices of a tile are the first samples of the next one: where these are holes, the largest stride
  // reads two tiles far.
  const auto holed = [&](glm::ivec2 tile) {
    for (int y = tile.y; y <= std::min(tile.y + 1, tiles_.y - 1); ++y)
      for (int x = tile.x; x <= std::min(tile.x + 1, tiles_.x - 1); ++x)
        if (reader.tile(x, y).nan_samples != 0) return true;
    return false;
  };
  const int far = topLevel() >= kTileLevels ? -2 : -1;
  std::vector<glm::ivec2> around;
  for (const glm::ivec2& t : tiles)
    for (int dy = far; dy <= 1; ++dy)
      for (int dx = far; dx <= 1; ++dx) {
        const glm::ivec2 n = t + glm::ivec2(dx, dy);
        if (n.x < 0 || n.y < 0 || n.x >= tiles_.x || n.y >= tiles_.y) continue;
        const bool next = std::max(dx, dy) <= 0 && std::min(dx, dy) >= -1;
        if (next || holed(n)) around.push_back(n);
      }
  unique(around);
  for (const glm::ivec2& t : around) {
    if (!is_waiting_[indexOf(t)]) waiting_.push_back(t);
    is_waiting_[indexOf(t)] = true;
    tile_errors_[indexOf(t)].fill(kUnknown);
  }
  for (int k = 1; k <= topLevel(); ++k) {
    Level& level = levels_[static_cast<std::size_t>(k)];
    const auto drop = [&](glm::ivec2 p) {
      if (p.x < level.count.x && p.y < level.count.y)
        level.errors[static_cast<std::size_t>(p.y) * static_cast<std::size_t>(level.count.x) +
                     static_cast<std::size_t>(p.x)] = kUnknown;
    };
    if (withinTile(k)) {
      const int across = engine::kTileSide / side(k);
      for (const glm::ivec2& t : around)
        for (int y = 0; y < across; ++y)
          for (int x = 0; x < across; ++x) drop(t * across + glm::ivec2(x, y));
    } else {
      for (const glm::ivec2& p : above(k, around)) drop(p);
    }
  }
}

std::size_t DetailMeasure::measureSome(const engine::FieldReader& reader, std::size_t most) {
  const std::size_t count = std::min(most, waiting_.size());
  if (count > 0) state_ = newState();
  const std::vector<glm::ivec2> now(waiting_.end() - static_cast<std::ptrdiff_t>(count), waiting_.end());
  waiting_.resize(waiting_.size() - count);
  if (count < 8) {
    for (const glm::ivec2& t : now) measureTile(reader, t);
  } else {
    oneapi::tbb::parallel_for(std::size_t{0}, count, [&](std::size_t i) { measureTile(reader, now[i]); });
  }
  for (const glm::ivec2& t : now) is_waiting_[indexOf(t)] = false;
  for (int k = 1; k <= topLevel() && count > 0; ++k) {
    if (withinTile(k)) continue;
    const std::vector<glm::ivec2> dirty = above(k, now);
    const auto renew = [&](std::size_t i) {
      k <= kTileLevels ? gather(k, dirty[i]) : nest(reader, k, dirty[i]);
    };
    if (dirty.size() < 8) {
      for (std::size_t i = 0; i < dirty.size(); ++i) renew(i);
    } else {
      oneapi::tbb::parallel_for(std::size_t{0}, dirty.size(), renew);
    }
  }
  return count;
}

void DetailMeasure::measure(const engine::FieldReader& reader) {
  begin(reader);
  (void)measureSome(reader, unknown());
}

void DetailMeasure::refresh(const engine::FieldReader& reader, std::span<const glm::ivec2> tiles) {
  if (levels_.empty()) return measure(reader);
  invalidate(reader, tiles);
  (void)measureSome(reader, unknown());
}

void DetailMeasure::measureTile(const engine::FieldReader& reader, glm::ivec2 tile) {
  const glm::ivec2 first = tile * engine::kTileSide;
  const glm::ivec2 cells = glm::min(size_ - 1 - first, glm::ivec2(engine::kTileSide));
  std::array<Error, kTileLevels + 1>& whole = tile_errors_[indexOf(tile)];
  if (cells.x <= 0 || cells.y <= 0) {
    whole.fill({});
    return;
  }
  alignas(64) float heights[kTileRows * kTileStride];
  reader.readHeights(first.x, first.y, kTileStride, kTileRows, heights, kTileStride);
  // A field of one row or column is drawn as two equal ones.
  if (reader.width() == 1)
    for (int r = 0; r < kTileRows; ++r) heights[r * kTileStride + 1] = heights[r * kTileStride];
  if (reader.height() == 1) std::copy_n(heights, kTileStride, heights + kTileStride);
  const float sign = reader.sign();
  for (float& h : heights) h *= sign;

  const int top = std::min(topLevel(), kTileLevels);
  TileExtremes extremes;
  extremes.ofSamples(heights, cells);
  float vertices[(engine::kTileSide / 2 + 1) * (engine::kTileSide / 2 + 1)];
  for (int k = 1; k <= top; ++k) {
    if (k > 1) extremes.coarsen();
    const int stride = 1 << k, vertex_stride = (engine::kTileSide >> k) + 1;
    for (int j = 0; j < vertex_stride; ++j)
      for (int i = 0; i < vertex_stride; ++i) {
        const glm::ivec2 at = glm::min(glm::ivec2(i, j) * stride, cells);
        float h = heights[at.y * kTileStride + at.x];
        if (std::isnan(h)) h = drawnHeight(reader, first + at, stride);
        vertices[j * vertex_stride + i] = std::isnan(h) ? kMissingVertex : h;
      }
    if (!withinTile(k)) {
      whole[static_cast<std::size_t>(k)] = {};
      measureTileLevel(heights, cells, k, vertices, extremes, engine::kTileSide, 1,
                       &whole[static_cast<std::size_t>(k)]);
      continue;
    }
    constexpr int kMost =
        engine::kTileSide / (2 * gpu::kPatchCells) > 0 ? engine::kTileSide / (2 * gpu::kPatchCells) : 1;
    const int across = engine::kTileSide / side(k);
    Error squares[kMost * kMost] = {};
    measureTileLevel(heights, cells, k, vertices, extremes, gpu::kPatchCells, across, squares);
    Level& level = levels_[static_cast<std::size_t>(k)];
    for (int y = 0; y < across; ++y)
      for (int x = 0; x < across; ++x) {
        const glm::ivec2 p = tile * across + glm::ivec2(x, y);
        if (p.x < level.count.x && p.y < level.count.y)
          level.errors[static_cast<std::size_t>(p.y) * static_cast<std::size_t>(level.count.x) +
                       static_cast<std::size_t>(p.x)] = squares[y * across + x];
      }
  }
}

void DetailMeasure::gather(int level, glm::ivec2 patch) {
  Level& l = levels_[static_cast<std::size_t>(level)];
  const int across = side(level) / engine::kTileSide;
  const glm::ivec2 last = glm::min((patch + 1) * across, tiles_);
  Error worst;
  for (int y = patch.y * across; y < last.y; ++y)
    for (int x = patch.x * across; x < last.x; ++x)
      worst = larger(worst, tile_errors_[static_cast<std::size_t>(y) * static_cast<std::size_t>(tiles_.x) +
                                         static_cast<std::size_t>(x)][static_cast<std::size_t>(level)]);
  l.errors[static_cast<std::size_t>(patch.y) * static_cast<std::size_t>(l.count.x) +
           static_cast<std::size_t>(patch.x)] = worst;
}

void DetailMeasure::nest(const engine::FieldReader& reader, int level, glm::ivec2 patch) {
  Level& l = levels_[static_cast<std::size_t>(level)];
  const Level& below = levels_[static_cast<std::size_t>(level) - 1];
  Error worst;
  for (int y = 2 * patch.y; y < std::min(2 * patch.y + 2, below.count.y); ++y)
    for (int x = 2 * patch.x; x < std::min(2 * patch.x + 2, below.count.x); ++x)
      worst =
          larger(worst, below.errors[static_cast<std::size_t>(y) * static_cast<std::size_t>(below.count.x) +
                                     static_cast<std::size_t>(x)]);
  if (worst.deviation == kInfinity) {
    // Not known (yet): then neither is this one, and its samples need not be read.
    l.errors[static_cast<std::size_t>(patch.y) * static_cast<std::size_t>(l.count.x) +
             static_cast<std::size_t>(patch.x)] = kUnknown;
    return;
  }
  const std::int32_t stride = 1 << level, half = stride / 2;
  const glm::ivec2 last = size_ - 1;
  float step = 0.0F, kink = 0.0F, largest = 0.0F;
  const auto at = [&](glm::ivec2 s, std::int32_t of) {
    const float h = drawnHeight(reader, glm::min(s, last), of);
    return std::isnan(h) ? kMissingVertex : h;
  };
  for (int j = 0; j < gpu::kPatchCells; ++j)
    for (int i = 0; i < gpu::kPatchCells; ++i) {
      const glm::ivec2 low = patch * side(level) + glm::ivec2(i, j) * stride;
      if (low.x >= last.x || low.y >= last.y) continue;
      const glm::ivec2 high = glm::min(low + stride, last), extent = high - low;
      const float z00 = at(low, stride), z10 = at({high.x, low.y}, stride), z01 = at({low.x, high.y}, stride),
                  z11 = at(high, stride);
      if (extent != glm::ivec2(stride))
        kink = std::max(kink, 0.25F * std::fabs(z00 - z10 - z01 + z11) *
                                  (static_cast<float>(half) / static_cast<float>(extent.x) +
                                   static_cast<float>(half) / static_cast<float>(extent.y)));
      for (int b = 0; b <= 2; ++b)
        for (int a = 0; a <= 2; ++a) {
          const glm::ivec2 s = glm::min(low + glm::ivec2(a, b) * half, high);
          const float z = at(s, half);
          // No height on the rings around it either: what is drawn there is no surface, or its deviation is
          // already infinite.
          if (z == kMissingVertex) continue;
          const float u = static_cast<float>(s.x - low.x) / static_cast<float>(extent.x);
          const float v = static_cast<float>(s.y - low.y) / static_cast<float>(extent.y);
          const float drawn = u + v <= 1.0F ? z00 + u * (z10 - z00) + v * (z01 - z00)
                                            : z11 + (1.0F - u) * (z01 - z11) + (1.0F - v) * (z10 - z11);
          step = std::max(step, std::fabs(z - drawn));
          largest = std::max(largest, std::fabs(z));
        }
    }
  step += kink + 4.0F * std::numeric_limits<float>::epsilon() * largest;
  if (!(step < 1e28F)) step = kInfinity;
  const float deviation = worst.deviation + step;
  // A sample is at most as far outside its cell's vertices as it is from the surface between them.
  l.errors[static_cast<std::size_t>(patch.y) * static_cast<std::size_t>(l.count.x) +
           static_cast<std::size_t>(patch.x)] = {deviation, std::isinf(worst.excess) ? kInfinity : deviation};
}

}  // namespace fettle::render
