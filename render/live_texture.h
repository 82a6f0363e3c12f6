#pragma once

#include <array>
#include <optional>
#include <unordered_map>
#include <vector>

#include <glm/vec2.hpp>

#include "engine/base/error.h"
#include "engine/field/version.h"
#include "render/field_texture.h"
#include "render/live_picture.h"
#include "render/submissions.h"

namespace fettle::render {

/// A field on the device that follows a version: all samples, and copies with every 4th, 16th and 64th of
/// them, in images of their own (marks likewise; a coarse mark is one when any sample of its square is
/// marked).
///
/// Threading: as Context. Throws vk::SystemError.
class LiveTexture {
 public:
  static constexpr int kLevels = 4;
  /// log2 of the step between the samples of a level.
  [[nodiscard]] static constexpr int shift(int level) noexcept { return 2 * level; }

  enum class Freshness {
    kRelated,  ///< what differs is pending
    kFresh,    ///< new images, everything is pending
  };
  /// From now on this version is wanted. Errors: a field larger than the device holds (kFailed); the texture
  /// is empty then. Images are let go at once: nothing that reads them may be under way when a field that is
  /// not related comes in; `idle` is called before that.
  [[nodiscard]] engine::Result<Freshness> want(Context& context, const engine::Version& version,
                                               MarksOverlay marks, std::uint32_t max_side,
                                               const std::function<void()>& idle);

  /// Records copies of pending tiles, until `byte_budget` is spent or the ring has no room; whether any were.
  /// `moved` gets the tiles whose heights are on their way now.
  bool pump(StagingRing& ring, std::uint64_t submission, const vk::raii::CommandBuffer& commands,
            std::int64_t byte_budget, UploadStatistics& count, std::vector<glm::ivec2>& moved);

  [[nodiscard]] std::size_t pending() const noexcept { return pending_.size(); }
  [[nodiscard]] const engine::Version& version() const noexcept { return version_; }
  [[nodiscard]] const Paging& paging() const noexcept { return paging_; }
  [[nodiscard]] vk::ImageView heights(int level) const {
    return images_[0][static_cast<std::size_t>(level)].view();
  }
  [[nodiscard]] bool hasMarks() const noexcept { return has_marks_; }
  [[nodiscard]] vk::ImageView marks(int level) const {
    return has_marks_ ? images_[1][static_cast<std::size_t>(level)].view() : heights(level);
  }
  /// Grows whenever the views change.
  [[nodiscard]] std::uint64_t generation() const noexcept { return generation_; }
  void clear() noexcept;

 private:
  // Samples of a tile, last ones included; empty when last < first.
  struct Span {
    int first_column = engine::kTileSide, first_row = engine::kTileSide, last_column = -1, last_row = -1;
    [[nodiscard]] bool empty() const noexcept { return last_column < first_column; }
    void join(const Span& other) noexcept;
  };
  struct Pending {
    Span spans[2];  // heights, marks
  };
  static Span changedHeights(const engine::Tile& a, const engine::Tile& b) noexcept;
  static Span changedMarks(const engine::Tile& a, const engine::Tile& b) noexcept;
  static constexpr Span whole() noexcept { return {0, 0, engine::kTileSide - 1, engine::kTileSide - 1}; }
  void add(std::int32_t column, std::int32_t row, int kind, const Span& span);
  [[nodiscard]] bool copy(StagingRing& ring, std::uint64_t submission, glm::ivec2 tile, int kind,
                          const Span& span, std::vector<vk::BufferImageCopy> (&copies)[2][kLevels],
                          UploadStatistics& count) const;

  engine::Version version_;  // what is wanted
  Paging paging_;
  std::array<GpuImage, kLevels> images_[2];  // heights, marks
  bool has_marks_ = false;
  std::unordered_map<std::uint64_t, Pending> pending_;
  std::vector<std::uint64_t> order_;  // keys of pending_, to be taken from the front
  std::size_t front_ = 0;
  bool unprepared_[2] = {false, false};  // images whose layout is still undefined
  std::uint64_t generation_ = 0;
};

}  // namespace fettle::render
