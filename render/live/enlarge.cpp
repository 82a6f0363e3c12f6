#include "render/live/enlarge.h"

#include "enlarge.frag.h"
#include "enlarge.vert.h"
#include "render/vulkan/picture_pipeline.h"

namespace fettle::render {

Enlarge::Enlarge(const Context& context, vk::Format codes) : context_(context), codes_(codes) {
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
  const vk::DescriptorPoolSize size{vk::DescriptorType::eCombinedImageSampler, 2};
  vk::DescriptorPoolCreateInfo pool{vk::DescriptorPoolCreateFlagBits::eFreeDescriptorSet, 2};
  pool_ = vk::raii::DescriptorPool(context.device(), pool.setPoolSizes(size));
  for (Layer& layer : layers_) {
    vk::DescriptorSetAllocateInfo wanted{*pool_};
    layer.set =
        std::move(vk::raii::DescriptorSets(context.device(), wanted.setSetLayouts(*set_layout_)).front());
  }
  pipeline_ = makePipeline(context, {.vertex = enlarge_vert_spirv,
                                     .fragment = enlarge_frag_spirv,
                                     .topology = vk::PrimitiveTopology::eTriangleStrip,
                                     .colour = codes,
                                     .layout = *layout_});
}

void Enlarge::set(const GpuImage& small, const GpuImage& large, std::uint32_t layers) {
  count_ = layers;
  extent_ = large.extent();
  for (std::uint32_t i = 0; i < count_; ++i) {
    const auto viewOf = [&](const GpuImage& image) {
      vk::ImageViewCreateInfo info;
      info.setImage(image.image())
          .setViewType(vk::ImageViewType::e2D)
          .setFormat(codes_)
          .setSubresourceRange({vk::ImageAspectFlagBits::eColor, 0, 1, i, 1});
      return vk::raii::ImageView(context_.device(), info);
    };
    layers_[i].from = viewOf(small);
    layers_[i].to = viewOf(large);
    const vk::DescriptorImageInfo image{nullptr, *layers_[i].from, vk::ImageLayout::eShaderReadOnlyOptimal};
    const vk::WriteDescriptorSet write{*layers_[i].set, 0, 0, 1, vk::DescriptorType::eCombinedImageSampler,
                                       &image};
    context_.device().updateDescriptorSets(write, {});
  }
}

void Enlarge::record(const vk::raii::CommandBuffer& commands) const {
  for (std::uint32_t i = 0; i < count_; ++i) {
    vk::RenderingAttachmentInfo colour;
    colour.setImageView(*layers_[i].to)
        .setImageLayout(vk::ImageLayout::eColorAttachmentOptimal)
        .setLoadOp(vk::AttachmentLoadOp::eDontCare)
        .setStoreOp(vk::AttachmentStoreOp::eStore);
    vk::RenderingInfo rendering;
    commands.beginRendering(
        rendering.setRenderArea({{0, 0}, extent_}).setLayerCount(1).setColorAttachments(colour));
    coverAll(commands, extent_);
    commands.bindPipeline(vk::PipelineBindPoint::eGraphics, *pipeline_);
    commands.bindDescriptorSets(vk::PipelineBindPoint::eGraphics, *layout_, 0, *layers_[i].set, {});
    commands.draw(4, 1, 0, 0);
    commands.endRendering();
  }
}

}  // namespace fettle::render
