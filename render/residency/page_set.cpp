#include "render/residency/page_set.h"

namespace fettle::render {
namespace {

constexpr TileKind kKinds[2] = {TileKind::kHeights, TileKind::kMarks};

vk::DeviceSize aligned(std::size_t bytes) {
  return (bytes + 15) / 16 * 16;
}

}  // namespace

PageSet::PageSet(PagePool& pool, std::int32_t width, std::int32_t height, int fixed_from)
    : pool_(pool), grid_(width, height, pool.log2Side()), size_(width, height), fixed_from_(fixed_from) {
  const auto entries = static_cast<std::size_t>(grid_.entries());
  slots_.assign(entries, PageSlots::kNone);
  requested_frame_.assign(entries, 0);
  loaded_.assign(entries, 0);
}

PageSet::~PageSet() {
  for (std::uint32_t& slot : slots_) pool_.slots().release(&slot);
  pool_.slots().unreserve(reserved_);
}

bool PageSet::reserve() noexcept {
  const auto pages = static_cast<std::uint32_t>(fixedPages(grid_, fixed_from_));
  if (!pool_.slots().reserve(pages)) return false;
  reserved_ = pages;
  return true;
}

bool PageSet::resident(const LevelSpan& span) const noexcept {
  bool all = true;
  grid_.over(span, [&](int entry) { all = all && resident(entry); });
  return all;
}

bool PageSet::markRequested(int entry, std::uint64_t frame) noexcept {
  std::uint64_t& last = requested_frame_[static_cast<std::size_t>(entry)];
  if (last == frame) return false;
  last = frame;
  return true;
}

template <class Visit>
void PageSet::over(glm::ivec2 tile, const Visit& visit) const {
  for (int level = 0; level < kDataLevels; ++level)
    visit(grid_.entry(level, (tile * (engine::kTileSide >> dataShift(level))) >> grid_.log2Side()));
  const int rim = grid_.first(kDataLevels), shift = 2 * grid_.log2Side();
  const glm::ivec2 last = (size_ - 1) / engine::kTileSide;
  if (tile.x == last.x) visit(rim + (tile.y * engine::kTileSide >> shift));
  if (tile.y == last.y) visit(rim + ((grid_.rimRow() + tile.x * engine::kTileSide) >> shift));
}

void PageSet::invalidate(glm::ivec2 tile) {
  over(tile, [&](int entry) {
    if (!resident(entry) || !pool_.slots().named(at(entry))) return;
    pool_.slots().clearName(at(entry));
    nameless_.push_back(entry);
  });
}

void PageSet::name(const engine::FieldReader& reader) {
  if (!accepted_.empty()) return;
  for (const int entry : nameless_)
    if (resident(entry)) pool_.slots().name(at(entry), entry, grid_.key(entry, reader));
  nameless_.clear();
}

bool PageSet::share(int entry, const engine::FieldReader& reader, std::uint64_t frame) {
  if (!accepted_.empty()) return false;
  return pool_.slots().share(&slots_[static_cast<std::size_t>(entry)], holdOf(entry), entry,
                             grid_.key(entry, reader), frame);
}

// Samples of a page that lie in the field, up to whole tiles: [columns, rows].
glm::ivec2 PageSet::sizeOfPage(int entry) const noexcept {
  const PageGrid::Place place = grid_.place(entry);
  const int side = 1 << grid_.log2Side();
  if (place.level == kDataLevels) return glm::ivec2(side);
  const glm::ivec2 tiles = (size_ - 1) / engine::kTileSide + 1;
  return glm::min(tiles * (engine::kTileSide >> dataShift(place.level)) - place.page * side,
                  glm::ivec2(side));
}

vk::DeviceSize PageSet::bytesOfPage(int entry) const noexcept {
  const glm::ivec2 size = sizeOfPage(entry);
  const auto samples = static_cast<std::size_t>(size.x) * static_cast<std::size_t>(size.y);
  const bool marks = pool_.hasMarks() && entry < grid_.first(kDataLevels);
  return aligned(samples * sizeof(float)) + (marks ? aligned(samples) : 0);
}

PageSet::Load PageSet::load(int entry, const engine::FieldReader& reader, StagingRing& ring,
                            std::uint64_t frame, std::int64_t& bytes) {
  std::uint32_t* slot = &slots_[static_cast<std::size_t>(entry)];
  const vk::DeviceSize size = bytesOfPage(entry);
  const std::optional<vk::DeviceSize> at = ring.take(size, frame);
  if (!at) return Load::kNoStaging;
  if (!pool_.slots().take(slot, holdOf(entry), frame)) return Load::kNoSlot;
  fill(entry, reader, *at, ring.buffer().data());
  loaded_[static_cast<std::size_t>(entry)] = frame;
  if (accepted_.empty())
    pool_.slots().name(*slot, entry, grid_.key(entry, reader));
  else
    nameless_.push_back(entry);
  bytes += static_cast<std::int64_t>(size);
  return Load::kDone;
}

void PageSet::fill(int entry, const engine::FieldReader& reader, vk::DeviceSize offset, std::byte* staging) {
  const PageGrid::Place place = grid_.place(entry);
  const glm::ivec2 size = sizeOfPage(entry);
  const int side = 1 << grid_.log2Side();
  const auto columns = static_cast<std::size_t>(size.x);
  if (place.level == kDataLevels) {
    auto* out = reinterpret_cast<float*>(staging + offset);
    const int first = place.page.x * side * side;
    for (int i = 0; i < side * side; ++i) {
      const int number = first + i, x = number - grid_.rimRow();
      const glm::ivec2 s = x < 0 ? glm::ivec2(size_.x - 1, number) : glm::ivec2(x, size_.y - 1);
      const bool inside = s.x < size_.x && s.y < size_.y;
      out[i] = inside ? reader.tile(s.x / engine::kTileSide, s.y / engine::kTileSide)
                            .samples[static_cast<std::size_t>(s.y % engine::kTileSide * engine::kTileSide +
                                                              s.x % engine::kTileSide)]
                      : 0.0F;
    }
    pool_.add(TileKind::kHeights, at(entry), {0, 0}, size, offset);
    return;
  }
  const int shift = dataShift(place.level), within = engine::kTileSide >> shift;
  const glm::ivec2 first = place.page * side / within, tiles = size / within;
  for (const TileKind kind : kKinds) {
    if (kind == TileKind::kMarks && !pool_.hasMarks()) break;
    const TilePart part = partOf(TileSpan::whole(), kind, shift);
    const std::size_t item = bytesOf(kind);
    for (int y = 0; y < tiles.y; ++y)
      for (int x = 0; x < tiles.x; ++x)
        copyPart(reader.tile(first.x + x, first.y + y), acceptedTile(first + glm::ivec2(x, y)), kind, shift,
                 part,
                 staging + offset +
                     (static_cast<std::size_t>(y * within) * columns + static_cast<std::size_t>(x * within)) *
                         item,
                 columns * item);
    pool_.add(kind, at(entry), {0, 0}, size, offset);
    offset += aligned(columns * static_cast<std::size_t>(size.y) * item);
  }
}

bool PageSet::write(glm::ivec2 tile, const TileSpan (&spans)[2], const engine::FieldReader& reader,
                    StagingRing& ring, std::uint64_t frame, std::int64_t& bytes) {
  // The uploads: whole pages in place of shared ones, and rectangles.
  struct Upload {
    TileKind kind;
    int entry, shift;
    TilePart part;
    glm::ivec2 place;
    vk::DeviceSize offset;
  };
  std::vector<Upload> rectangles;
  std::vector<int> apart;
  vk::DeviceSize total = 0, whole = 0;
  const auto affected = [&](int entry) {
    if (!resident(entry) || loaded_[static_cast<std::size_t>(entry)] == frame) return false;
    if (pool_.slots().holders(at(entry)) == 1) return true;
    if (std::find(apart.begin(), apart.end(), entry) == apart.end()) {
      apart.push_back(entry);
      whole += bytesOfPage(entry);
    }
    return false;
  };
  const int log2_side = grid_.log2Side(), side = 1 << log2_side;
  const auto add = [&](TileKind kind, int entry, int shift, const TilePart& part, glm::ivec2 place) {
    rectangles.push_back({kind, entry, shift, part, place, total});
    total += aligned(part.items() * bytesOf(kind));
  };
  for (const TileKind kind : kKinds) {
    const TileSpan& span = spans[static_cast<std::size_t>(kind)];
    if (span.empty() || (kind == TileKind::kMarks && !pool_.hasMarks())) continue;
    for (int level = 0; level < kDataLevels; ++level) {
      const int shift = dataShift(level);
      const TilePart part = partOf(span, kind, shift);
      if (part.empty()) continue;
      const glm::ivec2 from = tile * (engine::kTileSide >> shift) + glm::ivec2(part.column, part.row);
      const int entry = grid_.entry(level, from >> log2_side);
      if (affected(entry)) add(kind, entry, shift, part, from & (side - 1));
    }
    if (kind == TileKind::kMarks) continue;
    const glm::ivec2 last = size_ - 1, end = last / engine::kTileSide, in = last % engine::kTileSide;
    const auto rim = [&](int number, const TilePart& part) {
      const int entry = grid_.first(kDataLevels) + (number >> 2 * log2_side);
      if (affected(entry)) add(kind, entry, 0, part, {number & (side - 1), number >> log2_side & (side - 1)});
    };
    if (tile.x == end.x && span.last_column >= in.x)
      rim(tile.y * engine::kTileSide + span.first_row,
          {in.x, span.first_row, 1, span.last_row - span.first_row + 1});
    if (tile.y == end.y && span.last_row >= in.y)
      rim(grid_.rimRow() + tile.x * engine::kTileSide + span.first_column,
          {span.first_column, in.y, span.last_column - span.first_column + 1, 1});
  }
  const vk::DeviceSize needed = total + whole + 16 * apart.size();
  if (needed == 0) return true;
  const std::optional<vk::DeviceSize> at_ring = ring.take(needed, frame);
  if (!at_ring) return false;
  const engine::Tile& data = reader.tile(tile.x, tile.y);
  for (const Upload& r : rectangles) {
    const vk::DeviceSize offset = *at_ring + r.offset;
    const bool column = r.entry >= grid_.first(kDataLevels) && r.part.columns == 1;
    const auto columns = static_cast<std::size_t>(r.part.columns);
    copyPart(data, acceptedTile(tile), r.kind, r.shift, r.part, ring.buffer().data() + offset,
             columns * bytesOf(r.kind));
    // The rim's column lies along a row of its page.
    pool_.add(r.kind, at(r.entry), r.place,
              column ? glm::ivec2(r.part.rows, 1) : glm::ivec2(r.part.columns, r.part.rows), offset);
    bytes += static_cast<std::int64_t>(r.part.items() * bytesOf(r.kind));
  }
  vk::DeviceSize offset = *at_ring + total;
  for (const int entry : apart) {
    std::uint32_t* slot = &slots_[static_cast<std::size_t>(entry)];
    pool_.slots().release(slot);
    // No room for a page of its own: the page leaves the device.
    if (!pool_.slots().take(slot, holdOf(entry), frame)) continue;
    fill(entry, reader, offset, ring.buffer().data());
    loaded_[static_cast<std::size_t>(entry)] = frame;
    nameless_.push_back(entry);
    offset += bytesOfPage(entry);
    bytes += static_cast<std::int64_t>(bytesOfPage(entry));
  }
  return true;
}

}  // namespace fettle::render
