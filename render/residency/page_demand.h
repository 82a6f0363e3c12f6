#pragma once

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "render/detail/patches.h"
#include "render/residency/live_texture.h"

namespace fettle::render {

/// The pages that one frame asks for, of all textures of a pool.
///
/// They are brought in order of need: coarse levels first, since they soon show something everywhere, then in
/// the order asked (near patches first), a page of each texture in turn: where not all of them fit, no panel
/// is left out for another. What is asked for stays; of the rest, what was asked for longest ago
/// goes. Where all that is asked for does not fit, the first pages do and the last ones never push them out,
/// so a camera at rest comes to rest.
///
/// Threading: as Context. Throws vk::SystemError.
class PageDemand {
 public:
  /// Asks for what a panel needs: heights for the vertices of its patches, and for the colours of what can be
  /// seen of them data level `shade_level` of both textures, with differences over `step` samples. `original`
  /// may be null.
  void want(const PatchTree& patches, LiveTexture& field, LiveTexture* original, int shade_level, int step,
            std::uint64_t frame);

  struct Outcome {
    std::int64_t asked = 0;
    std::int64_t loaded = 0;
    std::int64_t waiting = 0;  ///< come with the next frames
    std::int64_t beyond = 0;   ///< never come while all the others are asked for: the budget holds no more
  };
  /// Brings what is missing, `byte_budget` bytes of it or one page.
  [[nodiscard]] Outcome settle(PagePool& pool, StagingRing& ring, std::uint64_t frame,
                               const vk::raii::CommandBuffer& commands, std::int64_t byte_budget,
                               UploadStatistics& count);

  /// Whether the vertices of a patch can be had now.
  [[nodiscard]] static bool drawable(const PatchLeaf& leaf, const PageSet& pages) noexcept;

 private:
  struct Wish {
    LiveTexture* texture;
    int entry, level;
    std::size_t number;  // of the texture's wishes
  };
  void ask(LiveTexture& texture, const LevelSpan& span, std::uint64_t frame);
  std::vector<Wish> wishes_;
  std::vector<std::pair<const LiveTexture*, std::size_t>> asked_;  // wishes of each
};

/// The page table of a panel as shaders read it (shaders/layout.h). `original` may be null. An entry of the
/// field says as well whether the original's page is away.
[[nodiscard]] gpu::PageHead pageHead(const PageGrid& grid);
[[nodiscard]] std::vector<std::uint32_t> pageTable(const PageSet& field, const PageSet* original);

}  // namespace fettle::render
