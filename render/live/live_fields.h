#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "engine/base/error.h"
#include "engine/field/version.h"
#include "render/detail/detail.h"
#include "render/live/live_picture.h"
#include "render/residency/live_texture.h"
#include "render/residency/page_demand.h"
#include "render/residency/page_pool.h"
#include "render/vulkan/submissions.h"

namespace fettle::render {

/// Whether two versions are states of one field, so that only their difference needs to be read.
[[nodiscard]] bool related(const engine::Version& a, const engine::Version& b);

/// The versions that are shown, as far as the device holds them, with the measures of their detail
/// (render/detail/detail.h).
///
/// Threading: as Context. Throws vk::SystemError.
class LiveFields {
 public:
  /// The submissions and the ring outlive this.
  LiveFields(Context& context, Submissions& submissions, StagingRing& staging, const LiveOptions& options);

  enum class Change {
    kChanged,   ///< states of the field shown before
    kInverted,  ///< the same, but with every sign inverted: so are the ends of all ranges
    kAnother,  ///< another field; an original was added or removed; or only some signs changed: ranges are recomputed
  };
  /// As LivePicture::update.
  [[nodiscard]] engine::Result<Change> update(const Shown& next);

  /// Uploads the next share of what is pending in the submission that is being recorded, and all that must be on the device before
  /// anything is drawn; measures some tiles. Adds what update() uploaded since the last call.
  void uploadPending(UploadStatistics& count);
  /// As LivePicture::measureFor.
  [[nodiscard]] std::int64_t measureFor(double ms);
  /// Uploads pages that a frame requests, within what uploadPending() left of upload_bytes_per_frame; only on
  /// demand.
  void uploadPages(PageDemand& demand, FrameStatistics& stats);

  /// Whether there is something to draw: update() succeeded.
  [[nodiscard]] bool ready() const noexcept { return !shown_.versions.empty() && !broken_; }
  [[nodiscard]] const Shown& shown() const noexcept { return shown_; }
  [[nodiscard]] bool onDemand() const noexcept { return pool_ != nullptr; }
  /// Of version `i` of shown().
  [[nodiscard]] LiveTexture& texture(std::size_t i) noexcept { return fields_[i].texture; }
  [[nodiscard]] const DetailMeasure& measure(std::size_t i) const noexcept { return fields_[i].measure; }
  [[nodiscard]] std::size_t count() const noexcept { return fields_.size(); }
  /// Of shown().original; its version is empty when there is none.
  [[nodiscard]] LiveTexture& original() noexcept { return original_; }

 private:
  struct Field {
    LiveTexture texture;
    DetailMeasure measure;
    engine::Version measured;  // the version that `measure` describes, when no tile of the texture is pending
  };
  [[nodiscard]] bool needsPool(const Shown& next) const;
  [[nodiscard]] std::uint64_t poolBudget(const Shown& next) const;
  void arrangePool(const Shown& next);
  void uploadAll(LiveTexture& texture);
  void uploadFixed(UploadStatistics& count);
  std::size_t measureInFrame(DetailMeasure& measure, const engine::FieldReader& reader) const;
  enum class Joins { kNo, kYes };  // a picture in which another version is shown
  [[nodiscard]] engine::Result<LiveTexture::Freshness> setVersion(LiveTexture& texture, const Shown& next,
                                                                  const engine::Version& version,
                                                                  MarksOverlay marks, Joins joins,
                                                                  const engine::Version& accepted = {});
  [[nodiscard]] engine::Result<bool> setField(std::size_t i, const Shown& next);

  Context& context_;
  Submissions& submissions_;
  StagingRing& staging_;
  LiveOptions options_;
  std::uint32_t max_side_ = 0;
  std::uint64_t memory_budget_ = 0;
  Shown shown_;
  std::unique_ptr<PagePool> pool_;  // null unless fields are loaded on demand
  std::uint64_t pool_budget_ = 0;   // budget of the pool [bytes]
  std::vector<Field> fields_;
  LiveTexture original_;
  UploadStatistics uploaded_;    // since the last frame
  std::int64_t bytes_left_ = 0;  // of this frame
  bool broken_ = false;          // an upload was not completed
};

}  // namespace fettle::render
