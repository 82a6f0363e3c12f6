#include "render/live/resize.h"

#include "enlarge.frag.h"
#include "reduce.frag.h"
#include "render/vulkan/picture_pipeline.h"
#include "resize.vert.h"

namespace fettle::render {
namespace {

vk::Extent2D resultOf(ResizeProgram::Kind kind, Resize::Times times, vk::Extent2D from) {
  if (kind == ResizeProgram::Kind::kReduce) return {from.width / 2, from.height / 2};
  const std::uint32_t factor = times == Resize::Times::kFour ? 4 : 2;
  return {factor * from.width, factor * from.height};
}

}  // namespace

ResizeProgram::ResizeProgram(const Context& context, Kind kind, vk::Format format)
    : kind_(kind), format_(format) {
  constexpr auto kClamp = vk::SamplerAddressMode::eClampToEdge;
  sampler_ = vk::raii::Sampler(context.device(), vk::SamplerCreateInfo{}
                                                     .setMagFilter(vk::Filter::eLinear)
                                                     .setMinFilter(vk::Filter::eLinear)
                                                     .setAddressModeU(kClamp)
                                                     .setAddressModeV(kClamp)
                                                     .setAddressModeW(kClamp));
  vk::DescriptorSetLayoutBinding image{0, vk::DescriptorType::eCombinedImageSampler, 1,
                                       vk::ShaderStageFlagBits::eFragment};
  image.setImmutableSamplers(*sampler_);
  vk::DescriptorSetLayoutCreateInfo set;
  set_layout_ = vk::raii::DescriptorSetLayout(context.device(), set.setBindings(image));
  vk::PipelineLayoutCreateInfo layout;
  layout_ = vk::raii::PipelineLayout(context.device(), layout.setSetLayouts(*set_layout_));
  pipeline_ = makePipeline(
      context, {.vertex = resize_vert_spirv,
                .fragment = kind == Kind::kReduce ? std::span<const std::uint32_t>(reduce_frag_spirv)
                                                  : std::span<const std::uint32_t>(enlarge_frag_spirv),
                .topology = vk::PrimitiveTopology::eTriangleStrip,
                .colour = format,
                .layout = *layout_});
}

Resize::Resize(const Context& context, const ResizeProgram& program, Times times)
    : context_(context), program_(program), times_(times) {
  const vk::DescriptorPoolSize size{vk::DescriptorType::eCombinedImageSampler, 2};
  vk::DescriptorPoolCreateInfo pool{vk::DescriptorPoolCreateFlagBits::eFreeDescriptorSet, 2};
  pool_ = vk::raii::DescriptorPool(context.device(), pool.setPoolSizes(size));
  const vk::DescriptorSetLayout layout = program_.setLayout();
  for (Layer& layer : layers_) {
    vk::DescriptorSetAllocateInfo allocate{*pool_};
    layer.set = std::move(vk::raii::DescriptorSets(context.device(), allocate.setSetLayouts(layout)).front());
  }
}

void Resize::set(const GpuImage& from, const GpuImage& to, std::uint32_t layers) {
  count_ = layers;
  extent_ = resultOf(program_.kind(), times_, from.extent());
  for (std::uint32_t i = 0; i < count_; ++i) {
    const auto viewOf = [&](const GpuImage& image) {
      vk::ImageViewCreateInfo info;
      info.setImage(image.image())
          .setViewType(vk::ImageViewType::e2D)
          .setFormat(program_.format())
          .setSubresourceRange({vk::ImageAspectFlagBits::eColor, 0, 1, i, 1});
      return vk::raii::ImageView(context_.device(), info);
    };
    layers_[i].from = viewOf(from);
    layers_[i].to = viewOf(to);
    const vk::DescriptorImageInfo image{nullptr, *layers_[i].from, vk::ImageLayout::eShaderReadOnlyOptimal};
    const vk::WriteDescriptorSet write{*layers_[i].set, 0, 0, 1, vk::DescriptorType::eCombinedImageSampler,
                                       &image};
    context_.device().updateDescriptorSets(write, {});
  }
}

void Resize::record(const vk::raii::CommandBuffer& commands) const {
  record(commands, std::array{vk::Rect2D{{0, 0}, extent_}}, vk::AttachmentLoadOp::eDontCare, {});
}

void Resize::record(const vk::raii::CommandBuffer& commands, std::span<const vk::Rect2D> parts,
                    const vk::ClearColorValue& outside) const {
  record(commands, parts, vk::AttachmentLoadOp::eClear, outside);
}

void Resize::record(const vk::raii::CommandBuffer& commands, std::span<const vk::Rect2D> parts,
                    vk::AttachmentLoadOp load, const vk::ClearColorValue& outside) const {
  for (std::uint32_t i = 0; i < count_; ++i) {
    vk::RenderingAttachmentInfo colour;
    colour.setImageView(*layers_[i].to)
        .setImageLayout(vk::ImageLayout::eColorAttachmentOptimal)
        .setLoadOp(load)
        .setClearValue(outside)
        .setStoreOp(vk::AttachmentStoreOp::eStore);
    vk::RenderingInfo rendering;
    commands.beginRendering(
        rendering.setRenderArea({{0, 0}, extent_}).setLayerCount(1).setColorAttachments(colour));
    coverAll(commands, extent_);
    commands.bindPipeline(vk::PipelineBindPoint::eGraphics, program_.pipeline());
    commands.bindDescriptorSets(vk::PipelineBindPoint::eGraphics, program_.layout(), 0, *layers_[i].set, {});
    for (const vk::Rect2D& part : parts) {
      commands.setScissor(0, part);
      commands.draw(4, 1, 0, 0);
    }
    commands.endRendering();
  }
}

}  // namespace fettle::render
