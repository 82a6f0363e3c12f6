#pragma once

#include "render/vulkan/memory.h"

namespace fettle::render {

/// Records the copy of a finished colour image (in layout eTransferSrcOptimal) to a buffer of 4 bytes per
/// pixel that the host reads once the commands are completed.
void copyToHost(const vk::raii::CommandBuffer& commands, const GpuImage& from, const Buffer& to);

}  // namespace fettle::render
