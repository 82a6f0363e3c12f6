#pragma once

#include <array>

#include "render/vulkan/memory.h"
#include "shaders/tgv_layout.h"

namespace fettle::render {

/// The commands of one batch of squares on the device: its samples are copied there, the steps taken with the weights
/// lowered between them, and the result is copied out. They are numbered, and recorded in any pieces in that order;
/// what one wrote is seen by the next, also across batches.
///
/// Threading: as Context. Throws vk::SystemError.
class TgvProgram {
 public:
  explicit TgvProgram(const Context& context);

  /// Arrays that a batch uploads, kTgvSquares squares each: f, wp, wq, u, x, y.
  static constexpr int kUploaded = 6;
  /// Of one array [bytes].
  static constexpr vk::DeviceSize kArrayBytes =
      sizeof(float) * gpu::kTgvSquares * gpu::kTgvSlot * gpu::kTgvSlot;

  /// Commands of a batch.
  [[nodiscard]] static int commands() noexcept;
  /// Records command `number` of a batch of `squares`, whose sizes `push` holds. `up` has the uploaded arrays one after
  /// the other; `down` gets u.
  void record(const vk::raii::CommandBuffer& commands, int number, int squares, const gpu::TgvPush& push,
              vk::Buffer up, vk::Buffer down) const;

  /// All but the sizes.
  [[nodiscard]] static gpu::TgvPush schedule() noexcept;

 private:
  void upload(const vk::raii::CommandBuffer& commands, int squares, vk::Buffer up) const;
  void download(const vk::raii::CommandBuffer& commands, int squares, vk::Buffer down) const;
  void dispatch(const vk::raii::CommandBuffer& commands, vk::Pipeline pipeline, int parity, int side,
                int squares, const gpu::TgvPush& push) const;

  DeviceBuffer kept_;
  std::array<DeviceBuffer, 2> changed_;  // read and written in turn
  vk::raii::DescriptorSetLayout set_layout_ = nullptr;
  vk::raii::PipelineLayout layout_ = nullptr;
  vk::raii::DescriptorPool pool_ = nullptr;
  std::array<vk::raii::DescriptorSet, 2> sets_{nullptr, nullptr};  // from the first to the second, and back
  vk::raii::Pipeline steps_ = nullptr, weights_ = nullptr;
};

}  // namespace fettle::render
