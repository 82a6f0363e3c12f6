#pragma once

#include <memory>

#include "render/live/resize.h"
#include "render/vulkan/pipelines.h"

namespace fettle::render {

/// What pictures of a device are drawn with: pictures that share it need what one of them has drawn with to be made, and
/// loaded by the driver, once.
///
/// Threading: as Pipelines.
class LivePrograms {
 public:
  LivePrograms(const Context& context, vk::Format colour, Pipelines::Views views)
      : context_(context), colour_(colour), pipelines_(context, colour, views) {}

  [[nodiscard]] Pipelines& pipelines() noexcept { return pipelines_; }
  /// Made on first use; not for a thread beside the drawing one.
  [[nodiscard]] const ResizeProgram& enlarge() {
    return made(enlarge_, ResizeProgram::Kind::kEnlarge, kEnlarged);
  }
  [[nodiscard]] const ResizeProgram& reduce() { return made(reduce_, ResizeProgram::Kind::kReduce, colour_); }
  /// Of what is enlarged: code values.
  static constexpr vk::Format kEnlarged = vk::Format::eB8G8R8A8Unorm;

 private:
  const ResizeProgram& made(std::unique_ptr<ResizeProgram>& program, ResizeProgram::Kind kind,
                            vk::Format format) {
    if (!program) program = std::make_unique<ResizeProgram>(context_, kind, format);
    return *program;
  }

  const Context& context_;
  const vk::Format colour_;
  Pipelines pipelines_;
  std::unique_ptr<ResizeProgram> enlarge_, reduce_;
};

}  // namespace fettle::render
