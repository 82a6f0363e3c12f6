#pragma once

#include <array>
#include <functional>
#include <memory>
#include <optional>
#include <unordered_map>
#include <vector>

#include <glm/vec2.hpp>

#include "engine/base/error.h"
#include "engine/field/version.h"
#include "render/plan/picture.h"
#include "render/residency/page_set.h"
#include "render/residency/paging.h"
#include "render/residency/tile_copy.h"
#include "render/residency/upload_budget.h"
#include "render/residency/upload_statistics.h"
#include "render/vulkan/submissions.h"

namespace fettle::render {

/// A field on the device that follows a version: all samples, and copies with every 4th, 16th and 64th of
/// them, in images of their own (marks likewise; a coarse mark is set when any sample of its square is
/// marked). Or on demand: in pages of a shared pool, of which the coarse ones stay permanently and the others
/// are uploaded when a frame requests them (render/residency/page_demand.h).
///
/// Threading: as Context. Throws vk::SystemError.
class LiveTexture {
 public:
  static constexpr int kLevels = kDataLevels;
  /// log2 of the step between the samples of a level.
  [[nodiscard]] static constexpr int shift(int level) noexcept { return dataShift(level); }

  LiveTexture() = default;
  LiveTexture(LiveTexture&&) noexcept = default;
  LiveTexture& operator=(LiveTexture&&) noexcept = default;

  /// Device memory that all of a field takes [bytes], before alignment; 0 when the device supports no image
  /// of its size.
  [[nodiscard]] static std::uint64_t bytesOfWhole(const Context& context, const engine::Grid& grid,
                                                  MarksOverlay marks, std::uint32_t max_side);

  enum class Freshness {
    kRelated,  ///< what differs is pending
    kFresh,    ///< new images, everything is pending
  };
  /// Sets the version to show. Marks that `accepted` lacks, a version of the same field, are suggested ones;
  /// empty: none is. Errors: a field larger than the device holds (kFailed); the texture is empty then.
  /// Images are released immediately: no work that reads them may be in progress when the field is not
  /// related to the one before; `idle` is called before that.
  [[nodiscard]] engine::Result<Freshness> setVersion(Context& context, const engine::Version& version,
                                                     MarksOverlay marks, std::uint32_t max_side,
                                                     const std::function<void()>& idle,
                                                     const engine::Version& accepted = {});
  /// The same on demand, in a pool that outlives the texture; marks are uploaded when the pool has them.
  /// Pages of levels from `fixed_from` up are pending like everything else. Errors (kFailed): the pool holds
  /// fewer.
  [[nodiscard]] engine::Result<Freshness> setVersion(PagePool& pool, int fixed_from,
                                                     const engine::Version& version,
                                                     const std::function<void()>& idle,
                                                     const engine::Version& accepted = {});

  /// Records copies of pending tiles, within `budget` or one of them, until the ring is full; returns whether there
  /// were any. Permanent pages come first, without regard to it. `moved` gets the tiles whose heights are being uploaded.
  bool uploadPending(StagingRing& ring, std::uint64_t submission, const vk::raii::CommandBuffer& commands,
                     const UploadBudget& budget, UploadStatistics& count, std::vector<glm::ivec2>& moved);

  /// Tiles and permanent pages that are not uploaded yet.
  [[nodiscard]] std::size_t pending() const noexcept { return pending_.size() + fixed_left_; }
  /// Permanent pages alone, without which nothing can be drawn.
  [[nodiscard]] std::size_t fixedLeft() const noexcept { return fixed_left_; }
  /// Tiles that differ from what is on the device, in no order.
  [[nodiscard]] std::vector<glm::ivec2> pendingTiles() const;
  /// Whether some tile of those from `first` to `last` (column, row; both included) differs from what is on
  /// the device.
  [[nodiscard]] bool anyPending(glm::ivec2 first, glm::ivec2 last) const;
  /// Whether no tile of a page is pending. Pending ones get priority.
  [[nodiscard]] bool upToDate(int entry);
  /// Null unless on demand.
  [[nodiscard]] PageSet* pages() const noexcept { return pages_.get(); }
  [[nodiscard]] const engine::Version& version() const noexcept { return version_; }
  [[nodiscard]] const Paging& paging() const noexcept { return paging_; }
  /// On demand: the pool, of all levels.
  [[nodiscard]] vk::ImageView heights(int level) const {
    if (pages_) return pages_->pool().view(TileKind::kHeights);
    return images_[0][static_cast<std::size_t>(level)].view();
  }
  [[nodiscard]] bool hasMarks() const noexcept { return has_marks_; }
  [[nodiscard]] vk::ImageView marks(int level) const {
    if (pages_) return pages_->pool().view(TileKind::kMarks);
    return has_marks_ ? images_[1][static_cast<std::size_t>(level)].view() : heights(level);
  }
  /// Increases whenever the views change.
  [[nodiscard]] std::uint64_t generation() const noexcept { return generation_; }
  void clear() noexcept;

 private:
  struct Pending {
    TileSpan spans[2];  // heights, marks
    bool has_priority = false;
  };
  void add(std::int32_t column, std::int32_t row, TileKind kind, const TileSpan& span);
  void addChanges(const engine::Version& next, const engine::Version& accepted);
  [[nodiscard]] const engine::Tile* acceptedTile(glm::ivec2 tile) const {
    return accepted_ == version_ ? nullptr : &accepted_.reader().tile(tile.x, tile.y);
  }
  [[nodiscard]] bool copy(StagingRing& ring, std::uint64_t submission, glm::ivec2 tile, TileKind kind,
                          const TileSpan& span, std::vector<vk::BufferImageCopy> (&copies)[2][kLevels],
                          UploadStatistics& count) const;
  [[nodiscard]] std::optional<std::uint64_t> nextPending();
  [[nodiscard]] bool pumpPages(StagingRing& ring, std::uint64_t submission,
                               const vk::raii::CommandBuffer& commands, const UploadBudget& budget,
                               UploadStatistics& count, std::vector<glm::ivec2>& moved);

  engine::Version version_;   // the version to show
  engine::Version accepted_;  // marks that this one lacks are suggested; equal to version_ when none is
  Paging paging_;
  std::array<GpuImage, kLevels> images_[2];  // heights, marks
  bool has_marks_ = false;
  std::unordered_map<std::uint64_t, Pending> pending_;
  std::vector<std::uint64_t>
      order_;  // keys of pending_, taken from the front; some may have been removed from pending_
  std::size_t front_ = 0;
  std::vector<std::uint64_t> priority_;  // keys to be taken first, from the back
  bool unprepared_[2] = {false, false};  // images whose layout is still undefined
  std::uint64_t generation_ = 0;
  std::unique_ptr<PageSet> pages_;
  std::size_t fixed_left_ = 0;  // permanent pages, the last of the table, that are not uploaded yet
};

}  // namespace fettle::render
