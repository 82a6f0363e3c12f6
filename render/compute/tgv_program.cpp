#include "render/compute/tgv_program.h"

#include <algorithm>
#include <bit>
#include <cstdint>
#include <span>

#include "engine/filter/tgv_schedule.h"
#include "render/vulkan/context.h"
#include "tgv_steps.comp.h"
#include "tgv_weights.comp.h"

namespace fettle::render {

namespace {

using Stage2 = vk::PipelineStageFlagBits2;
using Access2 = vk::AccessFlagBits2;

void order(const vk::raii::CommandBuffer& commands, const vk::MemoryBarrier2& barrier) {
  vk::DependencyInfo dependency;
  dependency.setMemoryBarriers(barrier);
  commands.pipelineBarrier2(dependency);
}

// Throws vk::SystemError. `words`: SPIR-V of a compute shader.
vk::raii::Pipeline makeComputePipeline(const Context& context, std::span<const std::uint32_t> words,
                                       vk::PipelineLayout layout) {
  vk::ShaderModuleCreateInfo code;
  const vk::raii::ShaderModule module(context.device(),
                                      code.setCodeSize(words.size_bytes()).setPCode(words.data()));
  vk::ComputePipelineCreateInfo info;
  info.setStage({{}, vk::ShaderStageFlagBits::eCompute, *module, "main"}).setLayout(layout);
  return {context.device(), nullptr, info};
}

// What copies and compute shaders wrote before is seen by those after.
void orderCompute(const vk::raii::CommandBuffer& commands) {
  const vk::PipelineStageFlags2 stages = Stage2::eComputeShader | Stage2::eTransfer;
  order(commands,
        {stages, Access2::eShaderWrite | Access2::eTransferWrite, stages,
         Access2::eShaderRead | Access2::eShaderWrite | Access2::eTransferRead | Access2::eTransferWrite});
}

// What copies wrote before is seen by the host when the commands are completed.
void orderForHost(const vk::raii::CommandBuffer& commands) {
  order(commands, {Stage2::eTransfer, Access2::eTransferWrite, Stage2::eHost, Access2::eHostRead});
}

namespace tgv = engine::tgv;
using StorageUsage = vk::BufferUsageFlagBits;

static_assert(gpu::kTgvSlot == tgv::kSide + 2 * tgv::kHalo);
static_assert(tgv::kFirstSteps % gpu::kTgvTogether == 0 && tgv::kRoundSteps % gpu::kTgvTogether == 0);

constexpr int kFirstDispatches = tgv::kFirstSteps / gpu::kTgvTogether;
constexpr int kRoundDispatches = tgv::kRoundSteps / gpu::kTgvTogether;
constexpr int kRoundCommands = 1 + kRoundDispatches;
constexpr int kAllDispatches = kFirstDispatches + tgv::kRounds * kRoundDispatches;
// Before and after them: the copies.
constexpr int kCommands = 1 + kFirstDispatches + tgv::kRounds * kRoundCommands + 1;

constexpr vk::DeviceSize kSquareBytes = TgvProgram::kArrayBytes / gpu::kTgvSquares;

vk::BufferCopy copyOf(int from, int to, int squares) {
  return {static_cast<vk::DeviceSize>(from) * TgvProgram::kArrayBytes,
          static_cast<vk::DeviceSize>(to) * TgvProgram::kArrayBytes,
          static_cast<vk::DeviceSize>(squares) * kSquareBytes};
}

}  // namespace

TgvProgram::TgvProgram(const Context& context) {
  const vk::BufferUsageFlags usage =
      StorageUsage::eStorageBuffer | StorageUsage::eTransferDst | StorageUsage::eTransferSrc;
  kept_ = DeviceBuffer(context, gpu::kTgvKept * kArrayBytes, usage);
  for (DeviceBuffer& each : changed_) each = DeviceBuffer(context, gpu::kTgvChanged * kArrayBytes, usage);

  std::array<vk::DescriptorSetLayoutBinding, 3> bindings;
  for (std::uint32_t i = 0; i < bindings.size(); ++i)
    bindings[i] = vk::DescriptorSetLayoutBinding(i, vk::DescriptorType::eStorageBuffer, 1,
                                                 vk::ShaderStageFlagBits::eCompute);
  vk::DescriptorSetLayoutCreateInfo set;
  set_layout_ = vk::raii::DescriptorSetLayout(context.device(), set.setBindings(bindings));
  const vk::PushConstantRange push{vk::ShaderStageFlagBits::eCompute, 0, sizeof(gpu::TgvPush)};
  vk::PipelineLayoutCreateInfo layout;
  layout_ = vk::raii::PipelineLayout(context.device(),
                                     layout.setSetLayouts(*set_layout_).setPushConstantRanges(push));
  const vk::DescriptorPoolSize descriptors(vk::DescriptorType::eStorageBuffer, 2 * 3);
  vk::DescriptorPoolCreateInfo pool{vk::DescriptorPoolCreateFlagBits::eFreeDescriptorSet, 2};
  pool_ = vk::raii::DescriptorPool(context.device(), pool.setPoolSizes(descriptors));
  for (std::size_t i = 0; i < sets_.size(); ++i) {
    vk::DescriptorSetAllocateInfo allocation{*pool_};
    sets_[i] =
        std::move(vk::raii::DescriptorSets(context.device(), allocation.setSetLayouts(*set_layout_)).front());
    const std::array buffers{vk::DescriptorBufferInfo(kept_.handle(), 0, VK_WHOLE_SIZE),
                             vk::DescriptorBufferInfo(changed_[i].handle(), 0, VK_WHOLE_SIZE),
                             vk::DescriptorBufferInfo(changed_[1 - i].handle(), 0, VK_WHOLE_SIZE)};
    vk::WriteDescriptorSet write;
    write.setDstSet(*sets_[i])
        .setDstBinding(gpu::kTgvBindKept)
        .setDescriptorType(vk::DescriptorType::eStorageBuffer)
        .setBufferInfo(buffers);
    context.device().updateDescriptorSets(write, {});
  }
  steps_ = makeComputePipeline(context, tgv_steps_comp_spirv, *layout_);
  weights_ = makeComputePipeline(context, tgv_weights_comp_spirv, *layout_);
}

int TgvProgram::commands() noexcept {
  return kCommands;
}

gpu::TgvPush TgvProgram::schedule() noexcept {
  gpu::TgvPush push{};
  const tgv::Weights& w = tgv::kWeights;
  push.lengths = {tgv::kStep.primal, tgv::kStep.dual, tgv::kStep.primal / (1.0F + tgv::kStep.primal), 0.0F};
  push.weights = {w.jump * w.half_jump, w.half_jump, w.crease * w.half_crease, w.half_crease};
  push.cut.x = tgv::kCut;
  return push;
}

void TgvProgram::record(const vk::raii::CommandBuffer& commands, int number, int squares,
                        const gpu::TgvPush& push, vk::Buffer up, vk::Buffer down) const {
  orderCompute(commands);
  if (number == 0) return upload(commands, squares, up);
  if (number == kCommands - 1) return download(commands, squares, down);
  const int step = number - 1;
  const int in_rounds = step - kFirstDispatches;
  const bool lowers = in_rounds >= 0 && in_rounds % kRoundCommands == 0;
  // Dispatches of steps before this command: each swaps the buffers.
  const int before = in_rounds < 0 ? step : step - (in_rounds + kRoundCommands - 1) / kRoundCommands;
  if (lowers)
    dispatch(commands, *weights_, before % 2, gpu::kTgvWeightsGroup, squares, push);
  else
    dispatch(commands, *steps_, before % 2, gpu::kTgvInner, squares, push);
}

void TgvProgram::upload(const vk::raii::CommandBuffer& commands, int squares, vk::Buffer up) const {
  const std::array kept{copyOf(0, gpu::kTgvF, squares), copyOf(1, gpu::kTgvWp, squares),
                        copyOf(2, gpu::kTgvWq, squares)};
  commands.copyBuffer(up, kept_.handle(), kept);
  const std::array changed{copyOf(3, gpu::kTgvU, squares),  copyOf(4, gpu::kTgvX, squares),
                           copyOf(5, gpu::kTgvY, squares),  copyOf(3, gpu::kTgvU2, squares),
                           copyOf(4, gpu::kTgvX2, squares), copyOf(5, gpu::kTgvY2, squares)};
  commands.copyBuffer(up, changed_[0].handle(), changed);
  const vk::DeviceSize bytes = static_cast<vk::DeviceSize>(squares) * kSquareBytes;
  commands.fillBuffer(kept_.handle(), gpu::kTgvWv * kArrayBytes, bytes,
                      std::bit_cast<std::uint32_t>(tgv::kWeights.crease));
  for (int dual = gpu::kTgvP; dual < gpu::kTgvChanged; ++dual)
    commands.fillBuffer(changed_[0].handle(), static_cast<vk::DeviceSize>(dual) * kArrayBytes, bytes, 0);
}

void TgvProgram::download(const vk::raii::CommandBuffer& commands, int squares, vk::Buffer down) const {
  commands.copyBuffer(changed_[kAllDispatches % 2].handle(), down, copyOf(gpu::kTgvU, 0, squares));
  orderForHost(commands);
}

void TgvProgram::dispatch(const vk::raii::CommandBuffer& commands, vk::Pipeline pipeline, int parity,
                          int side, int squares, const gpu::TgvPush& push) const {
  int columns = 0, rows = 0;
  for (int i = 0; i < squares; ++i) {
    const gpu::ivec4& two = push.sizes[i / 2];
    columns = std::max(columns, i % 2 == 0 ? two.x : two.z);
    rows = std::max(rows, i % 2 == 0 ? two.y : two.w);
  }
  const auto groups = [side](int samples) { return static_cast<std::uint32_t>((samples + side - 1) / side); };
  commands.bindPipeline(vk::PipelineBindPoint::eCompute, pipeline);
  commands.bindDescriptorSets(vk::PipelineBindPoint::eCompute, *layout_, 0,
                              *sets_[static_cast<std::size_t>(parity)], {});
  commands.pushConstants<gpu::TgvPush>(*layout_, vk::ShaderStageFlagBits::eCompute, 0, push);
  commands.dispatch(groups(columns), groups(rows), static_cast<std::uint32_t>(squares));
}

}  // namespace fettle::render
