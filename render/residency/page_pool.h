#pragma once

#include <array>
#include <optional>
#include <vector>

#include <glm/vec3.hpp>

#include "render/residency/residency.h"
#include "render/residency/tile_copy.h"
#include "render/vulkan/memory.h"
#include "render/vulkan/submissions.h"

namespace fettle::render {

/// A fixed amount of device memory cut into pages that all textures of a picture share.
///
/// Threading: as Context. Throws vk::SystemError.
class PagePool {
 public:
  enum class Marks { kNone, kInclude };
  /// As many pages as fit `budget` bytes, alignment included. May hold none: see slots().count().
  PagePool(const Context& context, std::uint64_t budget, Marks marks, std::uint32_t max_side);
  /// Grows to as many pages as fit `budget` bytes, if those are more than before; pages stay in their slots
  /// with their content. Waits for all work in progress. Needs memory for both sizes while it copies: where
  /// the device has none, everything stays as it is. Not between add() and flush().
  void grow(const Context& context, std::uint64_t budget, std::uint32_t max_side, Submissions& submissions);

  [[nodiscard]] int log2Side() const noexcept { return store_.shape.log2_side; }
  [[nodiscard]] bool hasMarks() const noexcept { return marks_ == Marks::kInclude; }
  [[nodiscard]] PageSlots& slots() noexcept { return slots_; }
  [[nodiscard]] const PageSlots& slots() const noexcept { return slots_; }
  [[nodiscard]] vk::ImageView view(TileKind kind) const {
    return store_.images[hasMarks() ? static_cast<std::size_t>(kind) : 0].view();
  }
  /// Device memory held, whether used or not.
  [[nodiscard]] std::uint64_t bytes() const noexcept { return store_.bytes; }

  /// A slot as an entry of the table that shaders read (shaders/layout.h).
  [[nodiscard]] std::uint32_t word(std::uint32_t slot) const noexcept;
  /// Copies `columns` x `rows` samples, tightly packed at `offset` of the staging buffer, to the place
  /// `column`, `row` of a slot. Recorded by flush().
  void add(TileKind kind, std::uint32_t slot, glm::ivec2 place, glm::ivec2 size, vk::DeviceSize offset);
  void flush(const vk::raii::CommandBuffer& commands, const Buffer& staging);

 private:
  // The images that hold all pages.
  struct Store {
    PoolShape shape;
    std::array<GpuImage, 2> images;  // heights, marks
    std::uint64_t bytes = 0;
  };
  [[nodiscard]] static Store make(const Context& context, std::uint64_t budget, Marks marks,
                                  std::uint32_t max_side, std::optional<int> log2_side);
  // Where a slot's page begins: column, row, layer.
  [[nodiscard]] static glm::ivec3 placeOf(const PoolShape& shape, std::uint32_t slot) noexcept;

  Marks marks_;
  Store store_;
  std::array<std::vector<vk::BufferImageCopy>, 2> copies_;
  bool prepared_ = false;  // images have their layout
  PageSlots slots_{0};
};

}  // namespace fettle::render
