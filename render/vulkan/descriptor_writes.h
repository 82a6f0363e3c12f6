#pragma once

#include <deque>
#include <vector>

#include "render/vulkan/packing.h"

namespace fettle::render {

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
