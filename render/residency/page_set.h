#pragma once

#include <span>
#include <vector>

#include "engine/field/version.h"
#include "render/residency/page_pool.h"
#include "render/vulkan/submissions.h"

namespace fettle::render {

/// The pages of one texture that lie in a pool, and how they get there.
///
/// Threading: as Context. Throws vk::SystemError.
class PageSet {
 public:
  /// Levels from `fixed_from` up (0 .. kDataLevels) and the rim stay on the device for good.
  PageSet(PagePool& pool, std::int32_t width, std::int32_t height, int fixed_from);
  ~PageSet();
  PageSet(const PageSet&) = delete;
  PageSet& operator=(const PageSet&) = delete;

  /// Pages of a grid that stay for good.
  [[nodiscard]] static int fixedPages(const PageGrid& grid, int fixed_from) noexcept {
    return grid.entries() - grid.first(fixed_from);
  }

  /// Makes sure of room for the pages that stay for good. False when the pool has none.
  [[nodiscard]] bool reserve() noexcept;

  [[nodiscard]] const PageGrid& grid() const noexcept { return grid_; }
  [[nodiscard]] int fixedFrom() const noexcept { return fixed_from_; }
  [[nodiscard]] PagePool& pool() const noexcept { return pool_; }
  [[nodiscard]] std::span<const std::uint32_t> slots() const noexcept { return slots_; }
  [[nodiscard]] bool resident(int entry) const noexcept { return at(entry) != PageSlots::kNone; }
  /// Whether all pages of a span are on the device.
  [[nodiscard]] bool resident(const LevelSpan& span) const noexcept;

  /// Bytes that load() moves.
  [[nodiscard]] std::int64_t bytes(int entry) const noexcept {
    return static_cast<std::int64_t>(bytesOfPage(entry));
  }

  /// From now on marks that this version lacks are suggested ones; empty: none is. Pages that come while some
  /// are cannot be told by what they hold, and are shared with nobody.
  void setAccepted(const engine::Version& accepted) { accepted_ = accepted; }

  /// Points an entry at the slot of an equal page of somebody's. False when there is none.
  [[nodiscard]] bool share(int entry, const engine::FieldReader& reader, std::uint64_t frame);
  enum class Load { kDone, kNoSlot, kNoStaging };
  /// Brings a page over that is not on the device. `frame`: the submission that is being recorded.
  [[nodiscard]] Load load(int entry, const engine::FieldReader& reader, StagingRing& ring,
                          std::uint64_t frame, std::int64_t& bytes);
  /// Brings the spans of a changed tile over, to those of its pages that are on the device. A page shared
  /// with others is first replaced by one of its own. False: nothing was done, for want of staging.
  [[nodiscard]] bool write(glm::ivec2 tile, const TileSpan (&spans)[2], const engine::FieldReader& reader,
                           StagingRing& ring, std::uint64_t frame, std::int64_t& bytes);
  /// The version goes on to one in which this tile is another one: pages can no longer be told by what they
  /// held.
  void forget(glm::ivec2 tile);
  /// What is on the device is what `reader` reads: pages can be told again.
  void name(const engine::FieldReader& reader);

  /// Marks an entry as asked for in this frame; false when it was already.
  [[nodiscard]] bool ask(int entry, std::uint64_t frame) noexcept;

 private:
  [[nodiscard]] std::uint32_t at(int entry) const noexcept { return slots_[static_cast<std::size_t>(entry)]; }
  [[nodiscard]] PageSlots::Hold holdOf(int entry) const noexcept {
    return entry >= grid_.first(fixed_from_) ? PageSlots::Hold::kFixed : PageSlots::Hold::kWhile;
  }
  void fill(int entry, const engine::FieldReader& reader, vk::DeviceSize at, std::byte* staging);
  [[nodiscard]] vk::DeviceSize bytesOfPage(int entry) const noexcept;
  [[nodiscard]] glm::ivec2 sizeOfPage(int entry) const noexcept;
  [[nodiscard]] const engine::Tile* acceptedTile(glm::ivec2 tile) const {
    return accepted_.empty() ? nullptr : &accepted_.reader().tile(tile.x, tile.y);
  }
  // The pages that a tile lies on: of each level, and of the rim where it is at the field's end.
  template <class Visit>
  void over(glm::ivec2 tile, const Visit& visit) const;

  PagePool& pool_;
  PageGrid grid_;
  glm::ivec2 size_;
  int fixed_from_;
  std::vector<std::uint32_t> slots_;   // of each entry
  std::vector<std::uint64_t> asked_;   // frame in which an entry was last asked for
  std::vector<std::uint64_t> loaded_;  // submission that brings or brought the whole page
  std::vector<int> nameless_;
  engine::Version accepted_;
  std::uint32_t reserved_ = 0;
};

}  // namespace fettle::render
