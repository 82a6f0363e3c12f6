#pragma once

#include <cstring>
#include <deque>
#include <span>
#include <utility>
#include <vector>

#include "render/vulkan/memory.h"

namespace fettle::render {

/// Content of one frame's buffer, before its addresses are known: lists are added, the buffer is made as
/// large as they need, then all of them are written at once. Added data must not move until then.
class Packing {
 public:
  /// Offset and size [bytes] for a descriptor of the list. An empty list takes the room of one item: a buffer
  /// of zero bytes cannot be bound.
  using Block = std::pair<vk::DeviceSize, vk::DeviceSize>;
  template <class T>
  Block add(std::span<const T> items) {
    return reserve(items, std::max<vk::DeviceSize>(items.size_bytes(), sizeof(T)));
  }
  /// The same of a list that is read as texels; what follows it has no meaning. lavapipe (Mesa 22.3) takes the second byte of the size
  /// for a number of levels, and compiles every shader that reads them once more for zero: it is never zero.
  Block addTexels(std::span<const std::uint32_t> items) {
    return reserve(items, items.size_bytes() | 0x100U);
  }
  [[nodiscard]] vk::DeviceSize bytes() const noexcept { return bytes_; }
  void write(std::byte* out) const {
    for (const Part& p : parts_)
      if (p.bytes > 0) std::memcpy(out + p.at, p.data, p.bytes);
  }

  /// The largest alignment of buffer offsets that a device may require (Vulkan 1.3, limits).
  static constexpr vk::DeviceSize kAlign = 256;

 private:
  struct Part {
    vk::DeviceSize at;
    const void* data;
    std::size_t bytes;
  };
  template <class T>
  Block reserve(std::span<const T> items, vk::DeviceSize size) {
    const vk::DeviceSize at = bytes_;
    parts_.push_back({at, items.data(), items.size_bytes()});
    bytes_ = (bytes_ + size + kAlign - 1) / kAlign * kAlign;
    return {at, size};
  }

  std::vector<Part> parts_;
  vk::DeviceSize bytes_ = 0;
};

/// Descriptors to be written together. The writes point at infos that must not move until they are applied,
/// hence the deques.
class DescriptorWrites {
 public:
  void image(vk::DescriptorSet set, int binding, vk::ImageView view,
             vk::ImageLayout layout = vk::ImageLayout::eShaderReadOnlyOptimal) {
    images_.push_back({nullptr, view, layout});
    add(set, binding, vk::DescriptorType::eSampledImage, &images_.back(), nullptr);
  }
  void buffer(vk::DescriptorSet set, int binding, vk::DescriptorType type, const Buffer& buffer,
              const Packing::Block& block) {
    buffers_.push_back({*buffer.handle(), block.first, block.second});
    add(set, binding, type, nullptr, &buffers_.back());
  }
  void texels(vk::DescriptorSet set, int binding, vk::BufferView view) {
    views_.push_back(view);
    add(set, binding, vk::DescriptorType::eUniformTexelBuffer, nullptr, nullptr, &views_.back());
  }
  void apply(const vk::raii::Device& device) const { device.updateDescriptorSets(writes_, {}); }

 private:
  void add(vk::DescriptorSet set, int binding, vk::DescriptorType type, const vk::DescriptorImageInfo* image,
           const vk::DescriptorBufferInfo* buffer, const vk::BufferView* view = nullptr) {
    writes_.push_back({set, static_cast<std::uint32_t>(binding), 0, 1, type, image, buffer, view});
  }
  std::deque<vk::DescriptorImageInfo> images_;
  std::deque<vk::DescriptorBufferInfo> buffers_;
  std::deque<vk::BufferView> views_;
  std::vector<vk::WriteDescriptorSet> writes_;
};

}  // namespace fettle::render
