#pragma once

#include <array>
#include <memory>
#include <vector>

#include "render/memory.h"
#include "render/residency.h"
#include "render/tile_copy.h"

namespace fettle::render {

/// A fixed amount of device memory cut into pages that all textures of a picture share.
///
/// Threading: as Context. Throws vk::SystemError.
class PagePool {
 public:
  enum class Marks { kNone, kBeside };
  /// As many pages as fit `budget` bytes, alignment and all. May hold none: see slots().count().
  PagePool(const Context& context, std::uint64_t budget, Marks marks, std::uint32_t max_side);

  [[nodiscard]] int log2Side() const noexcept { return shape_.log2_side; }
  [[nodiscard]] bool hasMarks() const noexcept { return marks_ == Marks::kBeside; }
  [[nodiscard]] PageSlots& slots() noexcept { return slots_; }
  [[nodiscard]] const PageSlots& slots() const noexcept { return slots_; }
  [[nodiscard]] vk::ImageView view(TileKind kind) const {
    return images_[hasMarks() ? static_cast<std::size_t>(kind) : 0].view();
  }
  /// Device memory held, whatever is in it.
  [[nodiscard]] std::uint64_t bytes() const noexcept { return bytes_; }

  /// A slot in an entry of the table that shaders read (shaders/layout.h).
  [[nodiscard]] std::uint32_t word(std::uint32_t slot) const noexcept;
  /// Copies `columns` x `rows` samples, tightly packed at `offset` of the staging buffer, to the place
  /// `column`, `row` of a slot. Recorded by flush().
  void add(TileKind kind, std::uint32_t slot, glm::ivec2 place, glm::ivec2 size, vk::DeviceSize offset);
  void flush(const vk::raii::CommandBuffer& commands, const Buffer& staging);

 private:
  PoolShape shape_;
  Marks marks_;
  std::uint64_t bytes_ = 0;
  std::array<GpuImage, 2> images_;
  std::array<std::vector<vk::BufferImageCopy>, 2> copies_;
  bool prepared_ = false;  // images have their layout
  PageSlots slots_{0};
};

}  // namespace fettle::render
