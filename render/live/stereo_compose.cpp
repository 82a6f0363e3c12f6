#include "render/live/stereo_compose.h"
#include "render/vulkan/barrier.h"
#include "render/vulkan/picture_pipeline.h"

#include <algorithm>

#include "shaders/layout.h"
#include "stereo.frag.h"
#include "stereo.vert.h"

namespace fettle::render {
namespace {

using Usage = vk::ImageUsageFlagBits;

}  // namespace

StereoCompose::StereoCompose(Context& context, vk::Format colour) : context_(context), colour_(colour) {
  const auto binding = [](int number) {
    return vk::DescriptorSetLayoutBinding{static_cast<std::uint32_t>(number),
                                          vk::DescriptorType::eSampledImage, 1,
                                          vk::ShaderStageFlagBits::eFragment};
  };
  const std::array bindings{binding(gpu::kBindLeftEye), binding(gpu::kBindRightEye)};
  vk::DescriptorSetLayoutCreateInfo set;
  set_layout_ = vk::raii::DescriptorSetLayout(context.device(), set.setBindings(bindings));
  vk::PipelineLayoutCreateInfo layout;
  layout_ = vk::raii::PipelineLayout(context.device(), layout.setSetLayouts(*set_layout_));
  const vk::DescriptorPoolSize size{vk::DescriptorType::eSampledImage, 2};
  vk::DescriptorPoolCreateInfo pool{vk::DescriptorPoolCreateFlagBits::eFreeDescriptorSet, 1};
  pool_ = vk::raii::DescriptorPool(context.device(), pool.setPoolSizes(size));
  vk::DescriptorSetAllocateInfo allocate{*pool_};
  set_ = std::move(vk::raii::DescriptorSets(context.device(), allocate.setSetLayouts(*set_layout_)).front());
}

vk::Extent2D StereoCompose::eyeExtent(StereoMode mode, vk::Extent2D whole) noexcept {
  return mode == StereoMode::kSideBySide ? vk::Extent2D{std::max(1U, whole.width / 2), whole.height} : whole;
}

void StereoCompose::begin(Submissions& submissions, vk::Extent2D eye, Layers layers) {
  if (images_[0].extent() != eye || layers_ != layers) {
    // The frame in flight reads the old ones.
    submissions.finish();
    layers_ = layers;
    views_ = {nullptr, nullptr};
    images_ = {};
    constexpr auto kUsage =
        Usage::eColorAttachment | Usage::eSampled | Usage::eTransferDst | Usage::eTransferSrc;
    const bool one = layers == Layers::kOneImage;
    for (std::size_t i = 0; i < (one ? 1 : 2); ++i)
      images_[i] =
          GpuImage(context_, colour_, eye, one ? 2 : 1, one ? GpuImage::Kind::kArray : GpuImage::Kind::kPlane,
                   kUsage, vk::ImageAspectFlagBits::eColor);
    std::array<vk::DescriptorImageInfo, 2> infos;
    std::array<vk::WriteDescriptorSet, 2> writes;
    for (std::uint32_t i = 0; i < 2; ++i) {
      vk::ImageViewCreateInfo view;
      view.setImage(images_[one ? 0 : i].image())
          .setViewType(vk::ImageViewType::e2D)
          .setFormat(colour_)
          .setSubresourceRange({vk::ImageAspectFlagBits::eColor, 0, 1, one ? i : 0, 1});
      views_[i] = vk::raii::ImageView(context_.device(), view);
      infos[i] = vk::DescriptorImageInfo{nullptr, *views_[i], ImageLayout::eShaderReadOnlyOptimal};
      writes[i] =
          vk::WriteDescriptorSet{*set_,
                                 static_cast<std::uint32_t>(i == 0 ? gpu::kBindLeftEye : gpu::kBindRightEye),
                                 0,
                                 1,
                                 vk::DescriptorType::eSampledImage,
                                 &infos[i]};
    }
    context_.device().updateDescriptorSets(writes, {});
  }
  vk::MemoryBarrier2 read;
  read.setSrcStageMask(Stage::eFragmentShader | Stage::eCopy)
      .setSrcAccessMask(Access::eShaderRead | Access::eTransferRead)
      .setDstStageMask(Stage::eCopy | Stage::eColorAttachmentOutput)
      .setDstAccessMask(Access::eTransferWrite | Access::eColorAttachmentWrite);
  vk::DependencyInfo dependency;
  submissions.commands().pipelineBarrier2(dependency.setMemoryBarriers(read));
}

LiveTarget StereoCompose::target(Eye eye) const {
  const GpuImage& image = images_[layers_ == Layers::kOneImage ? 0 : static_cast<std::size_t>(eye)];
  LiveTarget t;
  t.image = image.image();
  t.view = image.view();
  t.extent = image.extent();
  t.leaves_as = ImageLayout::eTransferSrcOptimal;
  return t;
}

void StereoCompose::record(const vk::raii::CommandBuffer& commands, StereoMode mode,
                           const LiveTarget& target) {
  for (const GpuImage& image : images_)
    if (image.extent().width > 0)
      change(commands, image, ImageLayout::eTransferSrcOptimal, ImageLayout::eShaderReadOnlyOptimal,
             Stage::eCopy, Access::eTransferRead, Stage::eFragmentShader, Access::eShaderRead);
  // The acquired image is waited for at this stage: the change of layout comes after it.
  change(commands, target.image, ImageLayout::eUndefined, ImageLayout::eColorAttachmentOptimal,
         Stage::eColorAttachmentOutput | Stage::eCopy, {}, Stage::eColorAttachmentOutput,
         Access::eColorAttachmentRead | Access::eColorAttachmentWrite);
  vk::RenderingAttachmentInfo colour;
  colour.setImageView(target.view)
      .setImageLayout(ImageLayout::eColorAttachmentOptimal)
      .setLoadOp(vk::AttachmentLoadOp::eDontCare)
      .setStoreOp(vk::AttachmentStoreOp::eStore);
  vk::RenderingInfo rendering;
  rendering.setRenderArea({{0, 0}, target.extent}).setLayerCount(1).setColorAttachments(colour);
  commands.beginRendering(rendering);
  coverAll(commands, target.extent);
  commands.bindPipeline(vk::PipelineBindPoint::eGraphics, pipeline(mode));
  commands.bindDescriptorSets(vk::PipelineBindPoint::eGraphics, *layout_, 0, *set_, {});
  commands.draw(3, 1, 0, 0);
  if (target.over) target.over(*commands);
  commands.endRendering();
  const bool copied = target.leaves_as == ImageLayout::eTransferSrcOptimal;
  change(commands, target.image, ImageLayout::eColorAttachmentOptimal, target.leaves_as,
         Stage::eColorAttachmentOutput, Access::eColorAttachmentWrite,
         copied ? Stage::eCopy : Stage::eBottomOfPipe,
         copied ? vk::AccessFlags2(Access::eTransferRead) : vk::AccessFlags2{});
}

void StereoCompose::copyToLayers(const vk::raii::CommandBuffer& commands, const LiveTarget& target) const {
  // The acquired image is free at this stage: the change of layout comes after it.
  change(commands, target.image, ImageLayout::eUndefined, ImageLayout::eTransferDstOptimal, Stage::eCopy, {},
         Stage::eCopy, Access::eTransferWrite);
  for (std::uint32_t eye = 0; eye < 2; ++eye) {
    vk::ImageCopy copy;
    copy.setSrcSubresource({vk::ImageAspectFlagBits::eColor, 0, 0, 1})
        .setDstSubresource({vk::ImageAspectFlagBits::eColor, 0, eye, 1})
        .setExtent({target.extent.width, target.extent.height, 1});
    commands.copyImage(images_[eye].image(), ImageLayout::eTransferSrcOptimal, target.image,
                       ImageLayout::eTransferDstOptimal, copy);
  }
  change(commands, target.image, ImageLayout::eTransferDstOptimal, target.leaves_as, Stage::eCopy,
         Access::eTransferWrite, Stage::eBottomOfPipe, {});
}

vk::Pipeline StereoCompose::pipeline(StereoMode mode) {
  const auto found = pipelines_.find(mode);
  if (found != pipelines_.end()) return *found->second;
  const vk::Bool32 anaglyph = mode == StereoMode::kAnaglyph;
  const vk::SpecializationMapEntry entry{gpu::kSpecAnaglyph, 0, sizeof(anaglyph)};
  const vk::SpecializationInfo constants{1, &entry, sizeof(anaglyph), &anaglyph};
  return *pipelines_
              .emplace(mode, makePipeline(context_, {.vertex = stereo_vert_spirv,
                                                     .fragment = stereo_frag_spirv,
                                                     .colour = colour_,
                                                     .layout = *layout_,
                                                     .constants = &constants}))
              .first->second;
}

}  // namespace fettle::render
