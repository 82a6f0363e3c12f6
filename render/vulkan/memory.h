#pragma once

#include <cstddef>
#include <functional>
#include <optional>

#include "render/vulkan/context.h"

namespace fettle::render {

inline constexpr vk::Format kColourFormat = vk::Format::eR8G8B8A8Srgb;  // blends and filters in linear light
inline constexpr vk::Format kDepthFormat = vk::Format::eD32Sfloat;

/// A buffer that the CPU writes or reads directly, mapped during its whole lifetime. Move-only.
class Buffer {
 public:
  /// What the CPU does with it. Reading from memory that is not cached takes a hundred times as long.
  enum class Access { kWrite, kRead };
  Buffer() = default;
  /// Throws vk::SystemError. `bytes` > 0.
  Buffer(const Context& context, vk::DeviceSize bytes, vk::BufferUsageFlags usage,
         Access access = Access::kWrite);
  [[nodiscard]] const vk::raii::Buffer& handle() const noexcept { return buffer_; }
  [[nodiscard]] vk::DeviceSize bytes() const noexcept { return bytes_; }
  [[nodiscard]] std::byte* data() const noexcept { return data_; }

 private:
  vk::raii::DeviceMemory memory_ = nullptr;
  vk::raii::Buffer buffer_ = nullptr;
  vk::DeviceSize bytes_ = 0;
  std::byte* data_ = nullptr;
};

/// A buffer that the device alone reads and writes. Move-only.
class DeviceBuffer {
 public:
  DeviceBuffer() = default;
  /// Throws vk::SystemError. `bytes` > 0.
  DeviceBuffer(const Context& context, vk::DeviceSize bytes, vk::BufferUsageFlags usage);
  [[nodiscard]] vk::Buffer handle() const noexcept { return *buffer_; }

 private:
  vk::raii::DeviceMemory memory_ = nullptr;
  vk::raii::Buffer buffer_ = nullptr;
};

/// An image on the device with a view of all of it. Move-only.
class GpuImage {
 public:
  GpuImage() = default;
  /// One mip level; a 2D image, or an array of `layers` of them for kArray. `viewed_as`: the view's format
  /// when it is another of the same size. Throws.
  enum class Kind { kPlane, kArray };
  GpuImage(const Context& context, vk::Format format, vk::Extent2D extent, std::uint32_t layers, Kind kind,
           vk::ImageUsageFlags usage, vk::ImageAspectFlags aspect, std::optional<vk::Format> viewed_as = {});
  /// A colour image, row after row in memory of the host. `memory` gives so many bytes, aligned as
  /// Context::hostImageAlignment() says (not 0); they outlive the image. Throws.
  GpuImage(const Context& context, vk::Format format, vk::Extent2D extent, vk::ImageUsageFlags usage,
           const std::function<std::byte*(std::size_t bytes)>& memory);
  [[nodiscard]] vk::Image image() const noexcept { return *image_; }
  [[nodiscard]] vk::ImageView view() const noexcept { return *view_; }
  [[nodiscard]] vk::Extent2D extent() const noexcept { return extent_; }
  /// Device memory it takes, alignment included.
  [[nodiscard]] vk::DeviceSize bytes() const noexcept { return bytes_; }
  /// From a row to the next one, of an image in memory of the host.
  [[nodiscard]] std::size_t rowBytes() const noexcept { return row_bytes_; }
  [[nodiscard]] vk::ImageSubresourceRange range() const noexcept { return {aspect_, 0, 1, 0, layers_}; }

 private:
  void makeView(const Context& context, vk::ImageViewType type, vk::Format format);

  vk::raii::DeviceMemory memory_ = nullptr;
  vk::raii::Image image_ = nullptr;
  vk::raii::ImageView view_ = nullptr;
  vk::Extent2D extent_;
  vk::DeviceSize bytes_ = 0;
  std::size_t row_bytes_ = 0;
  std::uint32_t layers_ = 1;
  vk::ImageAspectFlags aspect_;
};

/// An image that a picture is drawn to and copied out of. Throws.
[[nodiscard]] GpuImage pictureImage(const Context& context, vk::Extent2D extent,
                                    vk::Format format = kColourFormat);

/// Records the copy of a finished colour image (in layout eTransferSrcOptimal) to a buffer of 4 bytes per
/// pixel that the host reads once the commands are completed.
void copyToHost(const vk::raii::CommandBuffer& commands, const GpuImage& from, const Buffer& to);

}  // namespace fettle::render
