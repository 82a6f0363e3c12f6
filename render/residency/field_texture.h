#pragma once

#include <optional>

#include "engine/base/job.h"
#include "engine/field/version.h"
#include "render/vulkan/memory.h"

namespace fettle::render {

/// How a field is cut into the layers of an image array. Pages are multiples of a tile on both sides, so that
/// no tile lies on two of them.
struct Paging {
  std::uint32_t columns = 64, rows = 64;  ///< of one page [samples]
  std::uint32_t across = 1, up = 1;       ///< pages
  int log2_columns = 0, log2_rows = 0;    ///< when there is more than one page: sides are powers of two then
  [[nodiscard]] std::uint32_t layers() const noexcept { return across * up; }
  [[nodiscard]] bool paged() const noexcept { return layers() > 1; }
};

/// One page when the field fits the image limit `max_side`. Else the largest powers of two that leave at most
/// an eighth of the last page empty, per direction. Both > 0, max_side >= 64.
[[nodiscard]] Paging choosePaging(std::int32_t width, std::int32_t height, std::uint32_t max_side);

struct UploadCount {
  std::int64_t tiles = 0;
  std::int64_t bytes = 0;
};

/// A field on the device: heights as bits (R32_UINT, holes keep their NaN), marks as bytes once asked for.
/// Holds the version it shows, and goes on to another by uploading only the tiles in which the two differ.
/// The sign is not stored: inverting uploads nothing.
///
/// Threading: one thread at a time, and no frame that reads it under way. Functions throw vk::SystemError.
class FieldTexture {
 public:
  /// What besides heights has to be there.
  enum class Marks { kLeave, kBring };

  /// Brings the texture to `version`. Empties itself when it fails or is cancelled halfway. Errors: a field
  /// larger than the device holds (kFailed), kCancelled. `job` advances by tiles.
  [[nodiscard]] engine::Result<UploadCount> update(Context& context, const engine::Version& version,
                                                   Marks marks, std::uint32_t max_side,
                                                   engine::JobControl& job);

  /// The version held; empty before the first update.
  [[nodiscard]] const engine::Version& version() const noexcept { return version_; }
  [[nodiscard]] const Paging& paging() const noexcept { return paging_; }
  [[nodiscard]] vk::ImageView heights() const noexcept { return heights_->view(); }
  [[nodiscard]] bool hasMarks() const noexcept { return marks_.has_value(); }
  /// Marks, or some other unsigned image array to bind where the shader does not look.
  [[nodiscard]] vk::ImageView marks() const noexcept { return marks_ ? marks_->view() : heights_->view(); }

  void clear() noexcept;

 private:
  struct Piece;
  [[nodiscard]] engine::Status upload(Context& context, const std::vector<Piece>& pieces, UploadCount& count,
                                      engine::JobControl& job);

  engine::Version version_;
  Paging paging_;
  std::optional<GpuImage> heights_;
  std::optional<GpuImage> marks_;
  std::optional<engine::Version> marks_version_;  ///< the state the marks image shows
};

}  // namespace fettle::render
