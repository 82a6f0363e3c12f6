#pragma once

#include <span>
#include <vector>

#include "engine/field/version.h"
#include "render/residency/page_pool.h"
#include "render/vulkan/submissions.h"

namespace fettle::render {

/// The pages of one texture in a pool, and their uploads.
///
/// Threading: as Context. Throws vk::SystemError.
class PageSet {
 public:
  /// Levels from `fixed_from` up (0 .. kDataLevels) and the rim stay on the device permanently.
  PageSet(PagePool& pool, std::int32_t width, std::int32_t height, int fixed_from);
  ~PageSet();
  PageSet& operator=(PageSet&&) = delete;

  /// Permanent pages of a grid.
  [[nodiscard]] static int fixedPages(const PageGrid& grid, int fixed_from) noexcept {
    return grid.entries() - grid.first(fixed_from);
  }

  /// Reserves slots for the permanent pages. False when the pool has too few.
  [[nodiscard]] bool reserve() noexcept;

  [[nodiscard]] const PageGrid& grid() const noexcept { return grid_; }
  [[nodiscard]] int fixedFrom() const noexcept { return fixed_from_; }
  [[nodiscard]] PagePool& pool() const noexcept { return pool_; }
  [[nodiscard]] std::span<const std::uint32_t> slots() const noexcept { return slots_; }
  [[nodiscard]] bool resident(int entry) const noexcept { return at(entry) != PageSlots::kNone; }
  /// Whether all pages of a span are on the device.
  [[nodiscard]] bool resident(const LevelSpan& span) const noexcept;

  /// Bytes that load() uploads.
  [[nodiscard]] std::int64_t bytes(int entry) const noexcept {
    return static_cast<std::int64_t>(bytesOfPage(entry));
  }

  /// Marks that this version lacks are suggested ones; empty: none is. Pages loaded while there are suggested
  /// marks cannot be identified by their content, and are not shared.
  void setAccepted(const engine::Version& accepted) { accepted_ = accepted; }

  /// Points an entry at the slot of an equal page of another set. False when there is none.
  [[nodiscard]] bool share(int entry, const engine::FieldReader& reader, std::uint64_t frame);
  enum class Load { kDone, kNoSlot, kNoStaging };
  /// Uploads a page that is not on the device. `frame`: the submission that is being recorded.
  [[nodiscard]] Load load(int entry, const engine::FieldReader& reader, StagingRing& ring,
                          std::uint64_t frame, std::int64_t& bytes);
  /// Uploads the spans of a changed tile to those of its pages that are on the device. A page shared with
  /// others is first replaced by a page of its own. False: nothing was done, the staging ring is full.
  [[nodiscard]] bool write(glm::ivec2 tile, const TileSpan (&spans)[2], const engine::FieldReader& reader,
                           StagingRing& ring, std::uint64_t frame, std::int64_t& bytes);
  /// The next version has another tile here: its pages can no longer be identified by their content.
  void invalidate(glm::ivec2 tile);
  /// The device holds what `reader` reads: pages can be identified again.
  void name(const engine::FieldReader& reader);

  /// Marks an entry as requested in this frame; false when it was already.
  [[nodiscard]] bool markRequested(int entry, std::uint64_t frame) noexcept;

 private:
  [[nodiscard]] std::uint32_t at(int entry) const noexcept { return slots_[static_cast<std::size_t>(entry)]; }
  [[nodiscard]] PageSlots::Hold holdOf(int entry) const noexcept {
    return entry >= grid_.first(fixed_from_) ? PageSlots::Hold::kFixed : PageSlots::Hold::kEvictable;
  }
  void fill(int entry, const engine::FieldReader& reader, vk::DeviceSize at, std::byte* staging);
  [[nodiscard]] vk::DeviceSize bytesOfPage(int entry) const noexcept;
  [[nodiscard]] glm::ivec2 sizeOfPage(int entry) const noexcept;
  [[nodiscard]] const engine::Tile* acceptedTile(glm::ivec2 tile) const {
    return accepted_.empty() ? nullptr : &accepted_.reader().tile(tile.x, tile.y);
  }
  // The pages that contain a tile: of each level, and of the rim where it is at the field's end.
  template <class Visit>
  void over(glm::ivec2 tile, const Visit& visit) const;

  PagePool& pool_;
  PageGrid grid_;
  glm::ivec2 size_;
  int fixed_from_;
  std::vector<std::uint32_t> slots_;            // of each entry
  std::vector<std::uint64_t> requested_frame_;  // frame in which an entry was last requested
  std::vector<std::uint64_t> loaded_;           // submission that uploads or uploaded the whole page
  std::vector<int> nameless_;
  engine::Version accepted_;
  std::uint32_t reserved_ = 0;
};

}  // namespace fettle::render
