#pragma once

#include <cstring>
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
    const vk::DeviceSize at = bytes_;
    parts_.push_back({at, items.data(), items.size_bytes()});
    const vk::DeviceSize size = std::max<vk::DeviceSize>(items.size_bytes(), sizeof(T));
    bytes_ = (bytes_ + size + kAlign - 1) / kAlign * kAlign;
    return {at, size};
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
  std::vector<Part> parts_;
  vk::DeviceSize bytes_ = 0;
};

}  // namespace fettle::render
