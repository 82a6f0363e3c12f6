#include "render/live/frame_layers.h"

#include <array>

#include "render/live/panel_pass.h"
#include "render/plan/colour_map.h"
#include "render/vulkan/barrier.h"

namespace fettle::render {
namespace {

// The same bytes, read as code values and not as amounts of light.
vk::Format codesOf(vk::Format colour) {
  switch (colour) {
    case vk::Format::eR8G8B8A8Srgb:
      return vk::Format::eR8G8B8A8Unorm;
    case vk::Format::eB8G8R8A8Srgb:
      return vk::Format::eB8G8R8A8Unorm;
    default:
      return colour;
  }
}

// Values of LivePrograms::kEnlarged with which an image of the format has this colour [linear light].
vk::ClearColorValue codesOf(const glm::vec3& light, vk::Format colour) {
  const auto code = [](float channel) { return static_cast<float>(srgbFromLinear(channel)); };
  const bool red_first = codesOf(colour) == vk::Format::eR8G8B8A8Unorm;
  const float red = code(light.r), green = code(light.g), blue = code(light.b);
  return red_first ? std::array{blue, green, red, 1.0F} : std::array{red, green, blue, 1.0F};
}

// Every `step`-th pixel, rounded up: one pixel of the result is `step` of the whole in each direction.
vk::Extent2D everyNth(vk::Extent2D extent, std::uint32_t step) {
  return {(extent.width + step - 1) / step, (extent.height + step - 1) / step};
}
// That many of these.
vk::Extent2D times(std::uint32_t count, vk::Extent2D extent) {
  return {count * extent.width, count * extent.height};
}

}  // namespace

GpuImage FrameLayers::baseOf(vk::Extent2D size) const {
  using Usage = vk::ImageUsageFlagBits;
  // Copied as code values.
  return GpuImage(context_, codesOf(colour_), size, count_,
                  count_ == 1 ? GpuImage::Kind::kPlane : GpuImage::Kind::kArray,
                  Usage::eColorAttachment | Usage::eTransferSrc | Usage::eSampled, kColour, colour_);
}

void FrameLayers::make(Surface& surface, vk::Extent2D picture, vk::Extent2D size) const {
  using Usage = vk::ImageUsageFlagBits;
  surface.picture = picture;
  surface.depth = GpuImage(context_, kDepthFormat, &surface == &whole_ ? picture : size, count_,
                           count_ == 1 ? GpuImage::Kind::kPlane : GpuImage::Kind::kArray,
                           Usage::eDepthStencilAttachment | Usage::eSampled, kDepth);
  surface.base = baseOf(size);
}

void FrameLayers::makeFine(vk::Extent2D picture) {
  fine_.scale = 2.0F;
  make(fine_, picture, times(4, everyNth(picture, 2)));
}

void FrameLayers::makeSmall(Surface& surface, vk::Extent2D picture, Resize::Times times,
                            std::unique_ptr<Resize>& enlarge) {
  const std::uint32_t step = times == Resize::Times::kTwo ? 2 : 4;
  surface.scale = 1.0F / static_cast<float>(step);
  make(surface, picture, everyNth(picture, step));
  if (!enlarge) enlarge = std::make_unique<Resize>(context_, programs_.enlarge(), times);
  enlarge->set(surface.base, whole_.base, count_);
}

void FrameLayers::prepare(Submissions& submissions, vk::Extent2D picture, Sharpness sharpness) {
  const bool half = sharpness == Sharpness::kHalf, quarter = sharpness == Sharpness::kQuarter,
             fine = sharpness == Sharpness::kFine;
  if (whole_.picture == picture && (!half || half_.picture == picture) &&
      (!quarter || quarter_.picture == picture) && (!fine || (fine_.picture == picture && reduce_)))
    return;
  // The frame in flight draws with the old ones.
  submissions.finish();
  if (whole_.picture != picture) {
    // Room for what is enlarged from every fourth pixel.
    make(whole_, picture, times(4, everyNth(picture, 4)));
    // What is resized into it is not that of before, however large: a size may come back.
    half_.picture = quarter_.picture = vk::Extent2D{};
    reduce_.reset();
  }
  if (half) makeSmall(half_, picture, Resize::Times::kTwo, enlarge_);
  if (quarter) makeSmall(quarter_, picture, Resize::Times::kFour, enlarge_more_);
  if (fine) {
    if (fine_.picture != picture) makeFine(picture);
    if (!reduce_) reduce_ = std::make_unique<Resize>(context_, programs_.reduce(), Resize::Times::kTwo);
    reduce_->set(fine_.base, whole_.base, count_);
  }
}

void FrameLayers::prepareRest(Submissions& submissions, vk::Extent2D picture) {
  if (rest_picture_ == picture && fine_.picture == picture) return;
  // The frame in flight draws with the old ones.
  submissions.finish();
  if (fine_.picture != picture) {
    makeFine(picture);
    if (reduce_) reduce_->set(fine_.base, whole_.base, count_);
  }
  rest_ = baseOf(times(2, everyNth(picture, 2)));
  rest_picture_ = picture;
  if (!reduce_to_rest_)
    reduce_to_rest_ = std::make_unique<Resize>(context_, programs_.reduce(), Resize::Times::kTwo);
  reduce_to_rest_->set(fine_.base, rest_, count_);
}

const FrameLayers::Surface& FrameLayers::of(Sharpness sharpness) const noexcept {
  switch (sharpness) {
    case Sharpness::kHalf:
      return half_;
    case Sharpness::kQuarter:
      return quarter_;
    case Sharpness::kFine:
      return fine_;
    case Sharpness::kFull:
    case Sharpness::kRest:
      break;
  }
  return whole_;
}

void FrameLayers::beforeResize(const vk::raii::CommandBuffer& commands, const Surface& from,
                               const GpuImage& to) {
  Barriers before;
  before.add(from.base.image(), kColour, kColourWritten,
             {ImageLayout::eShaderReadOnlyOptimal, Stage::eFragmentShader, Access::eShaderRead});
  before.add(to.image(), kColour, {ImageLayout::eUndefined, Stage::eCopy, Access::eTransferRead},
             kColourUsed);
  before.record(commands);
}

void FrameLayers::recordResized(const vk::raii::CommandBuffer& commands, const Surface& from,
                                std::span<const LivePanel> panels, const glm::vec3& ground) const {
  beforeResize(commands, from, whole_.base);
  if (&from == &fine_) {
    reduce_->record(commands);
    return;
  }
  std::vector<vk::Rect2D> parts;
  for (const LivePanel& panel : panels)
    if (!empty(panel.visible)) parts.push_back(rectOf(panel.visible));
  (&from == &half_ ? enlarge_ : enlarge_more_)->record(commands, parts, codesOf(ground, colour_));
}

void FrameLayers::recordReducedToRest(const vk::raii::CommandBuffer& commands) const {
  beforeResize(commands, fine_, rest_);
  reduce_to_rest_->record(commands);
}

}  // namespace fettle::render
