#pragma once

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "render/detail/patches.h"
#include "render/residency/live_texture.h"
#include "render/residency/upload_budget.h"

namespace fettle::render {

/// The pages that one frame requests, of all textures of a pool.
///
/// They are uploaded in order of need: coarse levels first, since they soon show something everywhere, then
/// in the order of the requests (near patches first), a page of each texture in turn: where not all of them
/// fit, every panel gets a share. Requested pages stay; of the others, the least recently requested one is
/// evicted. Where not all requested pages fit, the first ones do and the last ones never replace them, so
/// that the picture of a camera at rest stops changing.
///
/// Threading: as Context. Throws vk::SystemError.
class PageDemand {
 public:
  /// Requests what a panel needs: heights for the vertices of its patches, and for the colours of their
  /// visible parts data level `shade_level` of both textures, with differences over `step` samples.
  /// `original` may be null.
  void request(const PatchTree& patches, LiveTexture& field, LiveTexture* original, int shade_level, int step,
               std::uint64_t frame);

  struct Outcome {
    std::int64_t requested = 0;
    std::int64_t loaded = 0;
    std::int64_t waiting = 0;      ///< uploaded with the next frames
    std::int64_t over_budget = 0;  ///< do not fit with all the others within the budget
  };
  /// Uploads missing pages, within `budget` or one page.
  [[nodiscard]] Outcome upload(PagePool& pool, StagingRing& ring, std::uint64_t frame,
                               const vk::raii::CommandBuffer& commands, const UploadBudget& budget,
                               UploadStatistics& count);

  /// Whether the vertices of a patch are on the device.
  [[nodiscard]] static bool drawable(const PatchLeaf& leaf, const PageSet& pages) noexcept;

 private:
  struct Request {
    LiveTexture* texture;
    int entry, level;
    std::size_t number;  // of the texture's requests
  };
  void requestSpan(LiveTexture& texture, const LevelSpan& span, std::uint64_t frame);
  std::vector<Request> requests_;
  std::vector<std::pair<const LiveTexture*, std::size_t>> request_counts_;  // requests of each
};

/// The page table of a panel as shaders read it (shaders/layout.h). `original` may be null. An entry of the
/// field also states whether the original's page is missing.
[[nodiscard]] gpu::PageHead pageHead(const PageGrid& grid);
[[nodiscard]] std::vector<std::uint32_t> pageTable(const PageSet& field, const PageSet* original);

}  // namespace fettle::render
