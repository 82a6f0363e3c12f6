#pragma once

// The one place that says how this room uses Vulkan's C++ face.
#define VULKAN_HPP_NO_SPACESHIP_OPERATOR
#include <vulkan/vulkan_raii.hpp>
